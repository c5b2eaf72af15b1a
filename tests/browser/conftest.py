"""Results with their pages, the site of docs/, and a browser that opens them. ASPERITY names the program, CHROMIUM the browser."""

import csv
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import Error, sync_playwright

DOCS = Path(__file__).parents[2] / "docs"
EXAMPLES = Path(__file__).parents[2] / "examples"
SMALL = "--tau 8 --size 64"
GONIO = f"gonio {SMALL} --eta 1.5 --theta 0,30,60 --rays 2e4 --realisations 4 --bins 12x24"
# Folders with their commands; the page of each is NAME.html.
COMMANDS = {
    "verify": f"verify {EXAMPLES}/first_look.toml {SMALL} --rays 2e4 --realisations 8 --bins 18x36",
    "gonio": f"{GONIO} --smoothness 2,4",
    "map": f"map {EXAMPLES}/small_map.toml --rays 2e4",
    "trace": "trace h.exr --theta 30 --eta 1.5 --rays 2e4 --models smith,xu-sun --bins 18x36",
    "converge": "converge --tau 4 --size 32 --smoothness 2 --theta 30 --rays 1e3 --surfaces 2 --repeats 3 --reference-rays 1e3 "
    "--reference-surfaces 4",
    "attenuation": "attenuation --sigma 1,2 --tau 8 --spacing 1 --length 64 --insist --realisations 2 --theta 0,30,60",
    "albedo": "albedo --alpha 0.3,0.8 --cosines 2 --eta 1.33,2 --realisations 4 --rays 2e3",
}
PAGES = [*COMMANDS, "inspect", "comparison"]
FLAGS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]


def asperity(folder, line):
    program = Path(os.environ["ASPERITY"]).resolve()
    subprocess.run([program, *line.split(), "--quiet"], cwd=folder, check=True)


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    """Folder of all results and pages."""
    folder = tmp_path_factory.mktemp("results")
    asperity(folder, "generate --tau 4 --smoothness 2 --size 256 --seed 7 -o h.exr")
    for name, line in COMMANDS.items():
        asperity(folder, f"{line} -o {name} --report {name}.html")
    asperity(folder, "inspect h.exr -o inspect")
    asperity(folder, "report inspect -o inspect.html")
    asperity(folder, f"{GONIO} --smoothness 2,4 --seed 2 -o other")
    asperity(folder, "report gonio other -o comparison.html")
    return folder


@pytest.fixture(scope="session")
def site(tmp_path_factory):
    """Folder of the site of docs/."""
    folder = tmp_path_factory.mktemp("site")
    build = [sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", DOCS / "site/mkdocs.yml", "--site-dir", folder]
    subprocess.run(build, check=True)
    return folder


@pytest.fixture(scope="session")
def browser():
    names = ["chromium", "chromium-browser", "google-chrome"]
    program = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, names)), None)
    assert program, "no Chromium: apt-get install chromium, or set CHROMIUM"
    with sync_playwright() as playwright:
        browser = launched(playwright.chromium, program)
        yield browser
        browser.close()


def launched(chromium, program, attempts=3):
    """Browser; Chromium may crash as it starts, before any page is open."""
    try:
        return chromium.launch(executable_path=program, args=FLAGS)
    except Error:
        if attempts == 1:
            raise
        return launched(chromium, program, attempts - 1)


@pytest.fixture
def open_file(browser):
    """Function that opens a file; no page may complain, ask the network for anything or open a dialog until the test ends.

    A page stands alone unless `parts` is true: then it may read other files.
    """
    contexts = []
    found = []

    def complain(what):
        found.append(what)

    def dismissed(dialog):
        complain(f"dialog {dialog.message}")
        dialog.dismiss()

    def open_file(path, script=None, parts=False, **options):
        def requested(request):
            is_expected = request.url.startswith("file://") and (parts or request.is_navigation_request())
            if not is_expected and not request.url.startswith(("data:", "blob:")):
                complain(f"request for {request.url}")

        options = {"viewport": {"width": 1200, "height": 900}, "color_scheme": "light", "reduced_motion": "reduce", **options}
        context = browser.new_context(**options)
        contexts.append(context)
        context.set_default_timeout(30_000)
        context.on("request", requested)
        if script:
            context.add_init_script(script)
        page = context.new_page()
        page.on("console", lambda message: complain(message.text) if message.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complain(str(error)))
        page.on("dialog", dismissed)
        page.goto(path.as_uri())
        return page

    yield open_file
    for context in contexts:
        context.close()
    assert not found


@pytest.fixture
def show(open_file, results):
    """Function that opens a page of results."""
    return lambda name, script=None, **options: open_file(results / f"{name}.html", script, **options)


def data(page):
    """Cases and lobes of a page."""
    return json.loads(page.locator("#data").text_content())
