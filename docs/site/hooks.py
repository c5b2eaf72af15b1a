"""Hooks of mkdocs: the order of pages, anchors as GitHub makes them, and files of the repository that pages link to."""

import itertools
import posixpath
import re
from pathlib import Path

from mkdocs.structure.files import File
from mkdocs.structure.nav import Section

ROOT = Path(__file__).parents[2]
HOME = "README.md"
# Folders and pages of the top level, in this order; others come after them
TOP = ["tutorials", "recipes", "reference", "how_it_works", "gallery.md", "atlas.md", "findings.md"]
# Fenced code, or a link with its text
LINK = re.compile(r"^ *```.*?^ *```|\[(?P<text>[^\[\]]*)\]\((?P<target>[^()\s]+)\)", re.MULTILINE | re.DOTALL)
# Lengths of cells, with their markup, and of words of code
LONG_CELL = 70
LONG_WORD = 30
LANGUAGES = {".rs": "rust", ".toml": "toml", ".py": "python", ".sh": "sh"}


# Anchors of the headings of a page so far
anchors = set()


def on_config(config):
    config.mdx_configs["toc"]["slugify"] = anchor
    return config


def on_page_markdown(markdown, page, config, files):
    anchors.clear()


def anchor(heading, separator):
    """Anchor of a heading as on GitHub; equal headings have `name`, `name-1`, `name-2`. The test of links in tests/architecture has the same rule."""
    kept = "".join(c for c in heading.strip().lower() if c.isalnum() or c in "-_ ").replace(" ", separator)
    names = itertools.chain([kept], (f"{kept}-{k}" for k in itertools.count(1)))
    free = next(name for name in names if name not in anchors)
    anchors.add(free)
    return free


def on_files(files, config):
    pages = [file for file in files.documentation_pages() if not file.generated_by]
    for file in pages:
        text = with_sources(file.content_string, posixpath.dirname(f"docs/{file.src_uri}"), file.src_uri, files, config)
        # GitHub wants a backslash before | in code in tables, mkdocs shows it
        file.content_string = re.sub(r"^\|.*", lambda row: re.sub(r"`[^`]*`", lambda code: code[0].replace("\\|", "|"), row[0]), text, flags=re.MULTILINE)
    config.nav = navigation([file.src_uri for file in pages])
    return files


def with_sources(text, folder, uri, files, config):
    """The text of the page `uri`, written in `folder` of the repository, whose links that leave docs/ lead to pages of the site.

    Such pages show a file of the repository: Markdown as it stands, other files as code. The site holds them because Cargo.toml names no
    address of the repository; links into that would take their place.
    """

    def replaced(match):
        target = match["target"]
        if target is None or ":" in target or target.startswith("#"):
            return match[0]
        path, hash_, anchor = target.partition("#")
        path = posixpath.normpath(posixpath.join(folder, path))
        if path.startswith("docs/"):
            to = path.removeprefix("docs/")
        elif (ROOT / path).exists():
            to = source(path, files, config)
        else:
            return match[0]
        return f"[{match['text']}]({posixpath.relpath(to, posixpath.dirname(uri))}{hash_}{anchor})"

    return LINK.sub(replaced, text)


def source(path, files, config):
    """Adds a page that shows a file of the repository, and returns its name. For a folder it is its README, or a list of its files."""
    if (ROOT / path / HOME).is_file():
        path = f"{path}/{HOME}"
    ending = Path(path).suffix
    uri = f"source/{path}" if ending == ".md" else f"source/{path}.md"
    if uri not in files.src_uris:
        page = File.generated(config, uri, content="")
        files.append(page)
        if (ROOT / path).is_dir():
            names = sorted(file.name for file in (ROOT / path).iterdir() if file.suffix in LANGUAGES)
            text = f"# {path}\n\n" + "".join(f"- [{name}]({name})\n" for name in names)
            text = with_sources(text, path, uri, files, config)
        elif ending == ".md":
            text = with_sources((ROOT / path).read_text(), posixpath.dirname(path), uri, files, config)
        else:
            text = (ROOT / path).read_text()
            text = f"# {Path(path).name}\n\n`{path}`\n\n~~~~{LANGUAGES.get(ending, 'text')}\n{text}~~~~\n"
        page.content_string = f"---\nsearch:\n  exclude: true\n---\n{text}"
    return uri


def navigation(pages):
    """Pages in folders. In a folder, those that the home page links to come first, in its order; `x.md` opens a folder `x` beside it."""
    targets = [link["target"] for link in LINK.finditer((ROOT / "docs" / HOME).read_text()) if link["target"]]
    order = {target.partition("#")[0]: place for place, target in reversed(list(enumerate(targets)))}

    def of(folder):
        found = {page.removeprefix(folder).split("/")[0] for page in pages if page.startswith(folder)} - {HOME}
        names = sorted(found, key=lambda name: (TOP + [name]).index(name) if not folder else (order.get(folder + name, len(targets)), name))
        opened = {f"{name}.md" for name in names if f"{name}.md" in names}
        return [item(folder, name) for name in names if name not in opened]

    def item(folder, name):
        if name.endswith(".md"):
            return folder + name
        first = [page for page in (f"{folder}{name}/{HOME}", f"{folder}{name}.md") if page in pages]
        return {title(first[0] if first else name): [*first, *of(f"{folder}{name}/")]}

    return [{"Home": HOME}, *of("")]


def title(name):
    """Heading of a page, or the name of a folder in words."""
    if not name.endswith(".md"):
        return name.replace("_", " ").capitalize()
    heading = next(line for line in (ROOT / "docs" / name).read_text().splitlines() if line.startswith("# "))
    return heading.removeprefix("# ").replace("`", "")


def on_nav(nav, config, files):
    """A page that opens a folder is its index, although it lies beside it."""
    sections = [item for item in nav.items if isinstance(item, Section)]
    while sections:
        section = sections.pop()
        inner = [item for item in section.children if isinstance(item, Section)]
        for opened in inner:
            page = opened.children[0]
            if page.is_page:
                page.file.url  # The address is kept: it is computed from the name once
                page.file.name = "index"
        sections += inner
    return nav


def on_page_content(html, page, config, files):
    """Marks what a narrow screen must not squeeze: flags, which would break at their hyphens, and cells. Pictures lead to themselves."""
    html = re.sub(r"<code>[^<]*</code>", lambda code: re.sub(r"(?<![^\s>])[^\s<>]*-[^\s<>]*", kept_whole, code[0]), html)
    html = re.sub(r'<img [^>]*src="([^"]*)"[^>]*>', r'<a href="\1">\g<0></a>', html)
    return re.sub(r"<td>(.*?)</td>", cell, html)


def kept_whole(word):
    return f"<span>{word[0]}</span>" if len(word[0]) < LONG_WORD else word[0]


def cell(match):
    text = re.sub(r"(?<=\d) ± (?=\d)", "&nbsp;±&nbsp;", match[1])
    return f'<td class="long">{text}</td>' if len(text) > LONG_CELL else f"<td>{text}</td>"
