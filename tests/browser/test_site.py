"""The site of docs/ in a browser, opened as files: nothing is cut off on narrow screens, both schemes are readable, the search finds terms."""

import re

import pytest
from conftest import DOCS
from markdown_it import MarkdownIt

PAGES = sorted(path.relative_to(DOCS) for path in DOCS.rglob("*.md"))
# The home page, one with wide tables, one with code and pictures
SAMPLES = ["README.md", "reference/settings/surface.md", "reference/pictures.md"]
WIDTHS = [390, 1280]
SCHEMES = ["light", "dark"]
# WCAG 2, level AA
READABLE = 4.5

# Texts with too little contrast to what is behind them: [text, ratio]
FAINT_TEXTS = """(least) => {
    const channels = (colour) => { const [r, g, b, a = 1] = colour.match(/[\\d.]+/g).map(Number); return [r, g, b, a]; };
    const over = (top, below) => [0, 1, 2].map((k) => top[3] * top[k] + (1 - top[3]) * below[k]).concat(1);
    const backdrop = (element) => {
        if (!element) return [255, 255, 255, 1];
        const own = channels(getComputedStyle(element).backgroundColor);
        return own[3] === 1 ? own : over(own, backdrop(element.parentElement));
    };
    const luminance = (colour) => {
        const [r, g, b] = colour.map((c) => c / 255).map((c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node; (node = walker.nextNode()); ) {
        const element = node.parentElement;
        if (!node.textContent.trim() || !element.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
        if (element.closest("script, style, .headerlink")) continue;
        const behind = backdrop(element);
        const pair = [luminance(over(channels(getComputedStyle(element).color), behind)), luminance(behind)].sort((a, b) => b - a);
        const ratio = (pair[0] + 0.05) / (pair[1] + 0.05);
        if (ratio < least) found.push([node.textContent.trim().slice(0, 40), element.className, ratio]);
    }
    return found;
}"""


def built(site, page):
    """File of a page."""
    path = site / page
    return path.with_name("index.html") if path.name == "README.md" else path.with_suffix(".html")


@pytest.fixture
def visit(open_file, site):
    """Function that opens a page of the site."""
    return lambda page, **options: open_file(built(site, page), parts=True, **options)


def size(width):
    return {"width": width, "height": 900}


@pytest.mark.parametrize("width", WIDTHS)
def test_no_page_scrolls_sideways(visit, site, width):
    page = visit("README.md", viewport=size(width))
    for name in PAGES:
        page.goto(built(site, name).as_uri())
        assert page.evaluate("document.scrollingElement.scrollWidth") == width, name
        # What is wider than the page lies in a box that scrolls by itself
        lost = page.evaluate(
            """() => [...document.querySelectorAll("article *")].filter((element) => {
                const { left, right } = element.getBoundingClientRect();
                if (right - left < 2 || (left >= 0 && right <= innerWidth)) return false;
                for (let box = element; box; box = box.parentElement) {
                    if (["auto", "scroll"].includes(getComputedStyle(box).overflowX)) return false;
                }
                return true;
            }).map((element) => element.outerHTML.slice(0, 100))"""
        )
        assert not lost, name


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", SAMPLES)
def test_texts_are_readable(visit, name, width, scheme):
    page = visit(name, viewport=size(width), color_scheme=scheme)
    assert page.locator("body").get_attribute("data-md-color-scheme") == {"light": "default", "dark": "slate"}[scheme]
    assert not page.evaluate(FAINT_TEXTS, READABLE)
    for picture in page.locator("article img").all():
        picture.scroll_into_view_if_needed()
        assert picture.evaluate("(image) => image.decode().then(() => image.naturalWidth)") > 100


def test_the_switch_changes_and_keeps_the_scheme(visit, site):
    page = visit("README.md", color_scheme="dark")
    seen = []
    for _ in range(3):
        page.locator("label.md-header__button[for^=__palette]:visible").click()
        page.wait_for_timeout(100)
        seen.append(page.locator("body").get_attribute("data-md-color-scheme"))
    assert seen == ["default", "slate", "slate"]
    page.locator("label.md-header__button[for^=__palette]:visible").click()
    page.goto(built(site, SAMPLES[1]).as_uri())
    assert page.locator("body").get_attribute("data-md-color-scheme") == "default"


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize(("term", "expected"), [("haze", "gloss"), ("GGX", "reference/")])
def test_the_search_finds(visit, site, term, expected, width):
    page = visit("README.md", viewport=size(width))
    page.locator("label.md-header__button[for=__search]:visible, .md-search__input:visible").first.click()
    page.locator(".md-search__input").press_sequentially(term)
    found = page.locator(".md-search-result__link")
    found.first.wait_for()
    links = [link.get_attribute("href") for link in found.all()]
    assert any(expected in link for link in links[:5]), links
    found.first.click()
    page.wait_for_url("**/*.html*")
    assert term.lower() in page.locator("article").inner_text().lower()


def test_the_menu_of_a_phone_leads_to_every_part(visit):
    page = visit("README.md", viewport=size(WIDTHS[0]))
    page.locator("label.md-header__button[for=__drawer]").click()
    for part in ["Recipes", "Reference", "How it works"]:
        assert page.locator(".md-nav--primary").get_by_text(part, exact=True).first.is_visible()


@pytest.mark.parametrize("name", PAGES, ids=str)
def test_pages_read_as_on_a_code_host(site, name):
    """GitHub and the site agree on what a list, a table and a block of code is."""
    html = built(site, name).read_text()
    article = html[html.index("<article") : html.index("</article>")]
    tokens = MarkdownIt("commonmark").enable("table").parse((DOCS / name).read_text())
    for kind, tag in [("list_item_open", "li"), ("tr_open", "tr"), ("td_open", "td"), ("fence", "pre"), ("heading_open", "h[1-6]")]:
        assert len(re.findall(f"<{tag}[ >]", article)) == sum(token.type == kind for token in tokens), kind
