"""Hooks of mkdocs: the order of pages, anchors as GitHub makes them, and files of the repository that pages link to."""

import itertools
import posixpath
import re
from pathlib import Path

from mkdocs.structure.files import File
from mkdocs.structure.nav import Section

ROOT = Path(__file__).parents[2]
HOME = "README.md"
# Order of folders and pages of the top level
TOP = ["tutorials", "recipes", "reference", "how_it_works", "gallery.md", "atlas.md", "findings.md"]
# Fenced code, or a link with its text
LINK = re.compile(r"^ *```.*?^ *```|\[(?P<text>[^\[\]]*)\]\((?P<target>[^()\s]+)\)", re.MULTILINE | re.DOTALL)
# Characters of cells with sentences, of numbers with errors and units at the most, and of words of code
LONG_CELL = 40
NUMBER = 22
LONG_WORD = 30
LANGUAGES = {".rs": "rust", ".toml": "toml", ".py": "python", ".sh": "sh"}

# Anchors of the headings of a page so far
anchors = set()


def on_config(config):
    config.mdx_configs["toc"]["slugify"] = github_anchor
    return config


def on_page_markdown(markdown, page, config, files):
    anchors.clear()


def github_anchor(heading, separator):
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
    """Pages in folders. `x.md` opens the folder `x` beside it, and `x/README.md` the one that it is in.

    Pages of a folder have the order in which the page that opens it links to them, or else the home page; others come last.
    """
    at_home = order(HOME)

    def of(folder, opener):
        found = {page.removeprefix(folder).split("/")[0] for page in pages if page.startswith(folder)} - {HOME}
        found -= {f"{name}.md" for name in found}
        inside = order(opener)

        def place(name):
            page = opens(folder, name) or f"{folder}{name}"
            return (TOP + [name]).index(name), inside.get(page, len(inside)), at_home.get(page, len(at_home)), name

        return [item(folder, name) for name in sorted(found, key=place)]

    def opens(folder, name):
        return next((page for page in (f"{folder}{name}/{HOME}", f"{folder}{name}.md") if page in pages), None)

    def item(folder, name):
        if name.endswith(".md"):
            return folder + name
        opener = opens(folder, name)
        if opener is None:
            return {name.replace("_", " ").capitalize(): of(f"{folder}{name}/", HOME)}
        return {title(opener): [opener, *of(f"{folder}{name}/", opener)]}

    return [{"Home": HOME}, *of("", HOME)]


def order(page):
    """Places of the pages that a page links to."""
    links = LINK.finditer((ROOT / "docs" / page).read_text())
    targets = [posixpath.normpath(posixpath.join(posixpath.dirname(page), link["target"].partition("#")[0])) for link in links if link["target"]]
    return {target: place for place, target in reversed(list(enumerate(targets)))}


def title(page):
    """Heading of a page."""
    heading = next(line for line in (ROOT / "docs" / page).read_text().splitlines() if line.startswith("# "))
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
    text = re.sub(r"<[^>]*>", "", match[1])
    is_number = len(text) <= NUMBER and re.match(r"[-~<>] ?\d|\d", text)
    kind = "long" if len(text) > LONG_CELL else "number" if is_number else None
    return f'<td class="{kind}">{match[1]}</td>' if kind else match[0]
