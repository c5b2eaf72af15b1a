"""Pages of results in a browser: what they show equals the files, and every control of them does something."""

import base64
import json
import re
import shutil

import numpy as np
import pytest
from conftest import PAGES, asperity, data, rows

WITH_LOBES = ["verify", "trace", "gonio", "comparison"]


# Pixels that two drawings of the same lobe may differ in: software renderers fill edges in any order.
NOISE = 800


def canvas(page):
    """Number of pixels of the lobe that have changed since the last call, and of its colours; without the texts over it."""
    return page.evaluate(
        """() => {
            const lobe = document.querySelector("#lobe");
            const copy = new OffscreenCanvas(lobe.width, lobe.height).getContext("2d");
            copy.drawImage(lobe, 0, 0);
            const { data } = copy.getImageData(0, 0, lobe.width, lobe.height);
            const before = window.lastLobe || new Uint8ClampedArray(data.length);
            window.lastLobe = data;
            let changed = 0;
            for (let i = 0; i < data.length; i += 4) {
                if ([0, 1, 2].some((k) => Math.abs(data[i + k] - before[i + k]) > 30)) changed++;
            }
            return [changed, new Set(new Uint32Array(data.buffer)).size];
        }"""
    )


def assert_changes(page, action, what):
    canvas(page)
    action()
    changed, colours = canvas(page)
    assert changed > NOISE, what
    assert colours > 100, what


def shown_figures(page):
    return [figure.locator("figcaption").text_content() for figure in page.locator(".figures figure:visible").all()]


def assert_rounded(text, mean, error):
    """A text is a mean with its standard error, both to two digits of the error."""
    match = re.fullmatch(r"(-?[\d.]+) ± ([\d.]+)", text)
    assert match, text
    step = 10.0 ** -len(match[2].partition(".")[2])
    assert len(match[1].partition(".")[2]) == len(match[2].partition(".")[2]), text
    assert abs(float(match[1]) - mean) <= 0.501 * step, (text, mean)
    assert abs(float(match[2]) - error) <= 0.501 * step, (text, error)
    assert 0.995 * 10 * step <= error < 100 * step or step == 1e-12 or step == 1, (text, error)


# All pages


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", PAGES)
def test_pages_open_without_complaint(show, results, name, scheme):
    page = show(name, color_scheme=scheme)
    assert (results / f"{name}.html").stat().st_size < 500_000
    assert page.locator(".story p").count() >= 1
    assert page.locator("html").get_attribute("data-theme") == scheme
    for details in page.locator("details:not([open]) > summary").all():
        if details.is_visible():
            details.click()
    assert not re.search(r"\b(NaN|undefined|Infinity|null)\b", page.locator("body").inner_text())
    for caption in page.locator("figcaption").all_text_contents():
        assert len(caption.partition("Source:")[0]) > 20, caption
    for link in page.locator("nav a").all():
        assert page.locator(link.get_attribute("href")).is_visible()


@pytest.mark.parametrize("name", PAGES)
def test_pages_fit_a_telephone(show, name):
    page = show(name, viewport={"width": 390, "height": 844})
    page.locator("details").evaluate_all("all => all.forEach((one) => { one.open = true; })")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


@pytest.mark.parametrize("name", PAGES)
def test_pages_print(show, name):
    pdf = show(name).pdf(format="A4", print_background=True)
    assert pdf.startswith(b"%PDF") and re.search(rb"/Type\s*/Page\b", pdf)


@pytest.mark.parametrize("name", PAGES)
def test_what_tab_reaches_has_a_name_and_shows_its_focus(show, name):
    page = show(name)
    session = page.context.new_cdp_session(page)
    seen = 0
    faults = []
    while seen < 400:
        page.keyboard.press("Tab")
        focus = page.evaluate(
            """() => {
                const element = document.activeElement;
                if (element === document.body || element.dataset.seen) return null;
                element.dataset.seen = true;
                const { outlineStyle, outlineWidth } = getComputedStyle(element);
                const box = element.getBoundingClientRect();
                const isSeen = box.width > 0 && box.height > 0 && box.bottom > 0 && box.top < innerHeight;
                return { text: element.outerHTML.slice(0, 160), isSeen, hasOutline: outlineStyle !== "none" && parseFloat(outlineWidth) >= 1 };
            }"""
        )
        if focus is None:
            break
        seen += 1
        element = session.send("Runtime.evaluate", {"expression": "document.activeElement"})["result"]
        tree = session.send("Accessibility.getPartialAXTree", {"objectId": element["objectId"], "fetchRelatives": False})
        has_name = bool(tree["nodes"][0].get("name", {}).get("value"))
        if not (has_name and focus["hasOutline"] and focus["isSeen"]):
            faults.append((has_name, focus))
    assert not faults
    assert 3 < seen < 400


@pytest.mark.parametrize("name", WITH_LOBES)
def test_the_theme_button_changes_paper_and_lobe(show, name):
    page = show(name)
    paper = lambda: page.locator("body").evaluate("(body) => getComputedStyle(body).backgroundColor")
    light = paper()
    assert page.locator("#theme").inner_text() == "Dark"
    assert_changes(page, page.locator("#theme").click, "dark theme")
    assert paper() != light
    assert page.locator("#theme").inner_text() == "Light"
    page.locator("#theme").click()
    assert paper() == light


# Without scripts or WebGL


@pytest.mark.parametrize("name", WITH_LOBES)
def test_without_webgl_figures_stand_in(show, name):
    page = show(name, script="HTMLCanvasElement.prototype.getContext = () => null;")
    assert page.locator("#fallback").is_visible()
    assert not page.locator(".stage").is_visible() and not page.locator("#scale").is_visible()
    if name == "gonio":
        first = shown_figures(page)
        page.locator("#angle").press("ArrowRight")
        assert first and shown_figures(page) != first


@pytest.mark.parametrize("name", PAGES)
def test_without_scripts_texts_tables_and_figures_are_there(show, results, name):
    page = show(name, java_script_enabled=False)
    assert page.locator(".story p").first.is_visible()
    assert not page.locator("#lobes").is_visible() and not page.locator("#theme").is_visible()
    if name == "comparison":
        assert page.locator("#comparison table").first.is_visible()
        page.locator("details.part > summary").first.click()
    if name in WITH_LOBES:
        assert page.locator(".energy").first.is_visible()
    if name != "comparison":
        assert page.locator("figure svg").first.is_visible()
    tables = page.locator("details.table").all()
    assert tables
    for table in tables if name != "comparison" else []:
        text = (results / name / table.get_attribute("data-name")).read_text()
        assert table.locator("pre.csv").text_content() == text
        table.locator("summary").click()
        assert table.locator("pre.csv").is_visible()


# Lobes


@pytest.mark.parametrize("name", WITH_LOBES)
def test_lobes_are_drawn_and_turn(show, name):
    page = show(name)
    lobe = page.locator("#lobe")
    assert lobe.is_visible()
    _, colours = canvas(page)
    assert colours > 100
    lobe.scroll_into_view_if_needed()
    box = lobe.bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)

    def drag(x, y):
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0] + x, middle[1] + y, steps=3)
        page.mouse.up()

    assert_changes(page, lambda: drag(60, 0), "drag sideways")
    assert_changes(page, lambda: drag(0, 40), "drag down")
    lobe.focus()
    for key in ["Home", "ArrowLeft", "ArrowUp", "+", "-", "ArrowRight", "ArrowDown"]:
        assert_changes(page, lambda: lobe.press(key), key)
    lobe.press("Home")
    canvas(page)
    drag(30, 30)
    lobe.press("Home")
    assert canvas(page)[0] < NOISE
    seen = lobe.screenshot()
    page.mouse.move(*middle)
    page.mouse.wheel(0, -200)
    page.wait_for_timeout(200)
    assert canvas(page)[0] > NOISE
    assert lobe.screenshot() != seen


@pytest.mark.parametrize("name", WITH_LOBES)
def test_every_control_changes_the_lobe(show, name):
    page = show(name)
    for control in ["scaling", "side", "part", "radius", "setting"]:
        select = page.locator(f"#{control}")
        if control == "setting" and not select.count():
            assert name in ("verify", "trace")
            continue
        values = [option.get_attribute("value") for option in select.locator("option").all()]
        assert len(values) > 1
        for value in values[1:]:
            assert_changes(page, lambda: select.select_option(value), (control, value))
        select.select_option(values[0])
    wires = page.locator("#controls input[type=checkbox]")
    assert (wires.count() > 0) == (name != "gonio")
    # Those of the same surface in another folder may coincide with the lobe
    for i in range(1 if name == "comparison" else 0, wires.count()):
        assert_changes(page, wires.nth(i).check, f"wire {i}")
        assert_changes(page, wires.nth(i).uncheck, f"wire {i}")


@pytest.mark.parametrize("name", ["gonio", "comparison"])
def test_the_slider_chooses_figures_rows_and_lobe(show, name):
    page = show(name)
    for details in page.locator("details.part > summary").all():
        details.click()
    cases = data(page)["cases"]
    slider = page.locator("#angle")
    for number in [1, 2, 1, 0]:
        before = shown_figures(page)
        assert_changes(page, lambda: slider.press("ArrowRight" if number > int(slider.input_value()) else "ArrowLeft"), number)
        assert int(slider.input_value()) == number
        page.wait_for_function("![...document.querySelectorAll('.figures figure:not([hidden]) [data-packed]')].length")
        assert page.locator("tr.chosen").get_attribute("data-row") == str(number)
        assert slider.get_attribute("aria-valuetext") == cases[number]["label"]
        assert f"{cases[number]['theta']:g}°" in page.locator("#controls").inner_text()
        assert shown_figures(page) != before
        thetas = page.locator(".figures figure[data-theta]:visible").evaluate_all("all => all.map((one) => Number(one.dataset.theta))")
        assert thetas and set(thetas) == {cases[number]["theta"]}
        for figure in page.locator(".figures figure:visible").all():
            assert figure.locator("svg").is_visible()


@pytest.mark.parametrize("name", ["verify", "gonio"])
def test_settings_list_all_cases(show, name):
    page = show(name)
    cases = data(page)["cases"]
    table = page.locator(".energy tbody th").all_text_contents()
    assert [case["label"] for case in cases] == table
    if name == "gonio":
        settings = page.locator("#setting option").all_text_contents()
        assert settings == ["s = 2, n = 1.5", "s = 4, n = 1.5"]
        page.locator("#setting").select_option(label=settings[1])
        page.locator("#angle").press("End")
        assert page.locator("tr.chosen th").inner_text() == "s = 4, n = 1.5, θᵢ = 60°"


def bins(results, name, number):
    """Rows of bins of a case by side, rounded polar angle and azimuth, and those of its models."""
    folder = results / ("gonio" if name == "comparison" else name)
    if name in ("verify", "trace"):
        return by_bin(rows(folder / "histogram.csv")), by_bin(rows(folder / "comparison.csv"))
    directions = json.loads((folder / "summary.json").read_text())["directions"]
    return by_bin(rows(folder / f"directions/{directions[number]['direction']}.csv")), None


def by_bin(found):
    key = lambda row: (row["side"], round(float(row["theta_min_deg"]), 5), round(float(row["phi_min_deg"]), 5))
    return {key(row): row for row in found}


def decoded(array):
    codes = np.frombuffer(base64.b64decode(array["codes"]), "<u2")
    return np.where(codes == 65535, 0.0, array["max"] * 2.0 ** (-codes.astype(float) / 2048))


@pytest.mark.parametrize("name", ["verify", "trace", "gonio"])
def test_lobes_equal_the_files(show, results, name):
    found = data(show(name))
    assert [lobes["case"] for lobes in found["lobes"]] == list(range(len(found["cases"])))
    for lobes in found["lobes"]:
        rays, models = bins(results, name, lobes["case"])
        assert sum((len(side["theta"]) - 1) * (len(side["phi"]) - 1) for side in lobes["sides"]) == len(rays)
        assert [side["side"] for side in lobes["sides"]] == ["reflected", "transmitted"]
        for side in lobes["sides"]:
            keys = [(side["side"], round(theta, 5), round(phi, 5)) for theta in side["theta"][:-1] for phi in side["phi"][:-1]]
            solid_angle = np.array([float(rays[key]["solid_angle_sr"]) for key in keys])

            def check(array, table, column):
                expected = np.array([float(table[key][column]) for key in keys]) / solid_angle
                assert np.isclose(array["max"], expected.max(), rtol=1e-12)
                values = decoded(array)
                # What is darker by nine decades is zero
                is_kept = expected > array["max"] * 2.0 ** (-65534 / 2048)
                assert np.allclose(values[is_kept], expected[is_kept], rtol=2e-4, atol=0), array["name"]
                assert not values[~is_kept].any()

            assert [array["name"] for array in side["rays"]][:2] == ["all", "se"]
            for array in side["rays"]:
                check(array, rays, {"all": "flux", "se": "flux_se"}.get(array["name"], f"flux_{array['name']}"))
            for array in side["models"]:
                words, _, part = array["name"].partition(", ")
                check(array, models, ("flux_" if part else "flux_total_") + words.replace("-", "_"))
            assert bool(side["models"]) == (models is not None)


@pytest.mark.parametrize("name", ["verify", "trace", "gonio"])
def test_a_point_reads_as_its_bin(show, results, name):
    page = show(name)
    lobe = page.locator("#lobe")
    lobe.scroll_into_view_if_needed()
    box = lobe.bounding_box()
    rays, _ = bins(results, name, 0)
    middle = lambda row, axis: (float(row[f"{axis}_min_deg"]) + float(row[f"{axis}_max_deg"])) / 2
    found = set()
    for side in ["reflected", "transmitted"]:
        page.locator("#side").select_option(side)
        for x in np.linspace(0.3, 0.7, 9):
            for y in np.linspace(0.2, 0.8, 9):
                page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
                text = page.locator("#readout").text_content()
                found.add(text)
                # Seen from 22 degrees above the surface, which goes through the middle
                if text and float(re.search(r"θₒ = ([\d.]+)", text)[1]) < 60:
                    assert y < 0.53 if side == "reflected" else y > 0.47, text
        page.mouse.move(box["x"] + 3, box["y"] + 3)
        assert page.locator("#readout").text_content() == ""
    found.discard("")
    assert len(found) > 20
    for text in found:
        side, theta, phi, value = re.fullmatch(r"(\w+), θₒ = ([\d.]+)°, φₒ = ([\d.]+)°: (.+) 1/sr", text).groups()
        theta = float(theta)
        near = [
            row
            for row in rays.values()
            if row["side"] == side and abs(middle(row, "theta") - theta) < 0.006 and abs(middle(row, "phi") - float(phi)) < 0.006
        ]
        assert len(near) == 1, text
        mean, error = (float(near[0][key]) / float(near[0]["solid_angle_sr"]) for key in ("flux", "flux_se"))
        shown, _, shown_error = value.partition(" ± ")
        step = 10.0 ** -len(shown.partition(".")[2]) if shown_error else 6e-3 * mean
        assert abs(float(shown) - mean) < 0.501 * step + 2e-4 * mean, (text, mean)
        if shown_error:
            assert abs(float(shown_error) - error) < 0.501 * step + 2e-4 * error, (text, error)
        else:
            assert error < 1e-12, text
    sides = {text.split(",")[0] for text in found}
    assert sides == {"reflected", "transmitted"}


@pytest.mark.parametrize("name", ["verify", "gonio"])
def test_surfaces_run_from_the_pole_to_the_horizon(show, name):
    page = show(name)
    for side in data(page)["lobes"][0]["sides"]:
        pole, *rings = page.evaluate("(side) => lobeRows(side, lobeValues(side.rays[0]))", side)
        theta = [ring[0]["theta"] for ring in rings]
        end = 0 if side["side"] == "reflected" else 180
        assert {vertex["theta"] for vertex in pole} == {end}
        distance = np.abs(np.array(theta) - end)
        assert (np.diff(distance) > 0).all() and distance[-1] < 90
        nearest = decoded(side["rays"][0]).reshape(len(theta), -1)[0 if end == 0 else -1]
        assert np.allclose([vertex["value"] for vertex in pole], nearest.mean())


# Numbers


@pytest.mark.parametrize("name", ["verify", "trace", "gonio"])
def test_energies_equal_the_summary(show, results, name):
    page = show(name)
    summary = json.loads((results / name / "summary.json").read_text())
    if name == "gonio":
        found = [one["results"] for one in summary["directions"]]
        cases = [{**one["flux"]["all"], **{key: one[key] for key in ("absorbed", "truncated", "lost")}} for one in found]
    else:
        cases = [summary["energy"]]
    names = page.locator(".energy thead th").all_text_contents()[2:]
    assert names == ["reflected", "transmitted", "absorbed", "truncated", "lost"]
    lines = page.locator(".energy tbody tr").all()
    assert len(lines) == len(cases)
    rounded = 0
    for line, case in zip(lines, cases):
        for text, key in zip(line.locator("td").all_text_contents()[1:], names):
            estimate = case[key]
            if estimate["se"] and estimate["se"] > 1e-12:
                assert_rounded(text, estimate["mean"], estimate["se"])
                rounded += 1
            else:
                assert float(text.split()[0]) == pytest.approx(estimate["mean"], rel=1e-3)
    assert rounded >= 2 * len(cases)


@pytest.mark.parametrize("name", [name for name in PAGES if name != "comparison"])
def test_tables_equal_their_files(show, results, name):
    page = show(name)
    checked = 0
    for details in page.locator("details.table").all():
        details.locator("summary").click()
        table = details.locator("table.numbers")
        table.wait_for()
        expected = rows(results / name / details.get_attribute("data-name"))
        columns = list(expected[0])
        shown = [column for column in columns if not (column.endswith("_se") and column[:-3] in columns)]
        assert table.locator("thead th").all_text_contents() == shown
        cells = table.evaluate("(table) => [...table.tBodies[0].rows].map((row) => [...row.cells].map((cell) => [cell.title, cell.textContent]))")
        assert len(cells) == len(expected)
        for line, row in zip(cells, expected):
            assert len(line) == len(shown)
            for (title, text), column in zip(line, shown):
                assert title == row[column]
                error = row.get(f"{column}_se") or "0"
                try:
                    value = float(title)
                except ValueError:
                    assert text == title
                    continue
                if float(error) > 1e-12:
                    assert_rounded(text, value, float(error))
                else:
                    assert float(text) == pytest.approx(value, rel=5.001e-3, abs=0)
                checked += 1
    assert checked > 20


def pasted(page):
    """Text of the clipboard, as a user pastes it."""
    page.evaluate("document.body.append(Object.assign(document.createElement('textarea'), { id: 'pasted' }))")
    page.locator("#pasted").focus()
    page.keyboard.press("Control+V")
    text = page.locator("#pasted").input_value()
    page.evaluate("document.querySelector('#pasted').remove()")
    return text


@pytest.mark.parametrize("has_clipboard", [True, False])
@pytest.mark.parametrize("name", ["gonio", "albedo"])
def test_buttons_copy_and_save_the_file(show, results, name, has_clipboard):
    script = None if has_clipboard else "Object.defineProperty(navigator, 'clipboard', { value: undefined });"
    page = show(name, script=script, permissions=["clipboard-read", "clipboard-write"] if has_clipboard else [])
    details = page.locator("details.table").first
    details.locator("summary").click()
    file = results / name / details.get_attribute("data-name")
    details.locator("[data-do=copy]").click()
    details.get_by_role("button", name="Copied").wait_for()
    assert pasted(page) == file.read_text()
    with page.expect_download() as download:
        details.locator("[data-do=save]").click()
    assert download.value.suggested_filename == file.name
    assert download.value.path().read_bytes() == file.read_bytes()
    page.locator(".command [data-do=copy]").click()
    page.locator(".command").get_by_role("button", name="Copied").wait_for()
    assert pasted(page) == page.locator(".command pre").text_content()


def test_cells_of_maps_say_what_they_are(show, results):
    page = show("map")
    areas = page.locator("svg [tabindex]")
    values = {f"{float(row['total_variation']):.3g}" for row in rows(results / "map/map.csv")}
    assert areas.count() >= 32
    tip = page.locator(".tip")
    for area in areas.all()[:20:3]:
        name = area.get_attribute("aria-label")
        area.scroll_into_view_if_needed()
        page.mouse.move(1, 1)
        area.hover()
        assert tip.inner_text() == name
        page.mouse.move(1, 1)
        assert not tip.is_visible()
        area.focus()
        assert tip.is_visible() and tip.inner_text() == name
        area.blur()
        assert not tip.is_visible()
        value = re.search(r"total variation (.+?), ", name)[1]
        if "×" not in value:
            assert value in values, name


def test_comparisons_show_both_folders(show, results):
    page = show("comparison")
    tables = [json.loads((results / name / "summary.json").read_text()) for name in ("gonio", "other")]
    first = page.locator("#comparison tbody tr").first.locator("td").all_text_contents()
    fluxes = [table["directions"][0]["results"]["flux"]["all"]["reflected"] for table in tables]
    assert first[0] == "reflected"
    for text, flux in zip(first[1:3], fluxes):
        assert_rounded(text, flux["mean"], flux["se"])
    error = np.hypot(fluxes[0]["se"], fluxes[1]["se"])
    difference = fluxes[1]["mean"] - fluxes[0]["mean"]
    assert_rounded(first[3], difference, error)
    assert float(first[4]) == pytest.approx(difference / error, abs=0.0501)
    settings = page.locator("#comparison h3 + .scroll tbody tr").all_text_contents()
    assert settings == ["run.seed12"]
    # Wires are those of the same direction in the other folder
    page.locator("#angle").press("End")
    wires = [label.inner_text() for label in page.locator("#controls label:has([type=checkbox])").all()]
    assert wires == ["other: s = 2, n = 1.5, θᵢ = 60°"]


# Hostile files

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(1)><!--"


@pytest.mark.parametrize("name", ["verify", "gonio", "map"])
def test_hostile_texts_are_shown_as_text(show, results, name):
    folder = results / f"hostile_{name}"
    shutil.copytree(results / name, folder)
    word = {"verify": "smith", "gonio": "reflected", "map": "smith"}[name]
    # Names of models and sides, also where they are columns of tables, and all labels
    for path in [*folder.rglob("*.csv"), folder / "summary.json", folder / "report.txt"]:
        text = path.read_text()
        if name == "gonio" and path.name == "summary.json":
            text = text.replace("s = 2, ", f"s = {HOSTILE}, ")
        elif name == "gonio" and path.name == "gonio.csv":
            text = text.replace("dielectric", HOSTILE)
        else:
            text = text.replace(word, HOSTILE)
        path.write_text(text.replace("s = 3, ", f"s = {HOSTILE}, "))
    summary = json.loads((folder / "summary.json").read_text())
    summary["warnings"] = [f"warned {HOSTILE}"]
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "report.txt").write_text(f"reported {HOSTILE}\n")
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["arguments"].append(HOSTILE)
    manifest["commit"] = HOSTILE
    (folder / "manifest.json").write_text(json.dumps(manifest))
    asperity(results, f"report hostile_{name} -o hostile_{name}.html")
    page = show(f"hostile_{name}")
    for summary in page.locator("details > summary").all():
        summary.click()
    for box in page.locator("#controls input[type=checkbox]").all():
        box.check()
    for select in page.locator("#controls select").all():
        for i in range(select.locator("option").count()):
            select.select_option(index=i)
    for copy in page.locator("[data-do=copy]:visible").all():
        copy.click()
    page.wait_for_timeout(100)
    assert page.locator("img").count() == 0
    assert page.locator("script").count() == (1 if name == "map" else 2)
    text = page.locator("body").inner_text()
    for begin in ["Warned ", "reported ", "commit "]:
        assert begin + HOSTILE in text
    assert HOSTILE in page.locator(".command pre").text_content()
    assert any(HOSTILE in text for text in page.locator("table.numbers :is(td, th)").all_text_contents())
    if name != "map":
        assert HOSTILE in page.locator("#controls").inner_text()
    if name == "verify":
        assert HOSTILE in page.locator("h1").inner_text()
