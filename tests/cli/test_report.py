"""The page of `idealgas report`, in headless Chromium as people see it: apt-get install chromium chromium-driver."""

import base64
import io
import re

import numpy as np
import pytest
from click.testing import CliRunner
from idealgas_cli.main import main
from PIL import Image
from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select, WebDriverWait
from support import ROOT, program

from idealgas.analysis import registry
from idealgas.analysis.movie.piston_track import piston_track
from idealgas.analysis.report import player as player_module
from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

pytestmark = pytest.mark.slow

PLAIN = """
scene.title = "Some <discs> & no more"
scene.seed = 2
box.size = [20, 10]
species = [{name = "gas", count = 60, radius = 0.3, speed = 1.0}]
run.collisions_per_disc = 150  # more rows than the player goes through to seek a time
"""

SCENES = {
    "plain": PLAIN,
    "periodic": PLAIN + "".join(f'box.{side} = "periodic"\n' for side in ("left", "right", "bottom", "top")),
    "gravity": PLAIN + "gravity.acceleration = [0.1, -0.4]\n",
    "rotation": PLAIN + "rotation.wall_roughness = 1.0\n",
    "walls": PLAIN
    + """
        [[wall]]
        from = [10, 0]
        to = [10, 4]
        [[wall]]
        from = [10, 4]
        to = [10, 10]
        opens_at = 3
        closes_at = 5
    """,
    "piston": PLAIN + 'piston = {side = "right", position = 15.0, mass = 20.0, pressure = 1.5}\n',
    "two species": PLAIN.replace("}]", '}, {name = "heavy", count = 5, radius = 0.5, mass = 9, speed = 0.1}]'),
    "without positions": PLAIN + 'run.method = "monte_carlo"\nrun.v_ref = 12.0\n',
}
FULL = ("plain", "two species")
QUICK = ("temperature", "evolution", "profile")


def idealgas(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """make(name): paths of the log and the page of one of the SCENES; only FULL ones have all the sections."""
    folder = tmp_path_factory.mktemp("report")

    def make(name):
        log, page = folder / f"{name}.h5", folder / f"{name}.html"
        if not log.exists():
            simulate(parse_scene(SCENES[name]), log)
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(registry, "NAMES", registry.NAMES if name in FULL else QUICK)
                made = idealgas("report", log, "-o", page)
            assert (made.exit_code, made.output) == (0, f"{page}: written\n"), made.output
        return log, page

    return make


@pytest.fixture(scope="module")
def browser():
    programs = [program("chromium"), program("chromedriver")]
    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1200,1000"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(programs[1]))
    yield driver
    driver.quit()


@pytest.fixture
def opened(browser, pages):
    """open(name): the browser with the page of a scene; nothing may be complained about until the end of the test."""

    def open_page(name):
        browser.get(pages(name)[1].as_uri())
        return browser

    yield open_page
    assert browser.get_log("browser") == []
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})


@pytest.fixture
def sized(opened, browser):
    """sized(name, width, scheme): the page of a scene on a screen of this width, light or dark."""

    def open_sized(name, width, scheme="light"):
        metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
        return opened(name)

    yield open_sized
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def rules_of_axe():
    """The program axe-core; skips the test where npm has not installed it."""
    path = ROOT / "tests" / "dev" / "node_modules" / "axe-core" / "axe.min.js"
    if not path.exists():
        pytest.skip("no axe-core: npm install --prefix tests/dev")
    return path.read_text(encoding="utf-8")


def seek(browser, time):
    browser.execute_script("player.seek(arguments[0])", time)


def assert_positions(browser, log, time, accuracy=2e-5):
    """The page's positions are the log's, within the 24 bits that it has; across joined sides the near image."""
    shown, exact = np.array(browser.execute_script("return player.positions()")), log.state_at(time).position
    assert ((shown >= 0) & (shown <= log.box)).all()
    difference = shown - exact
    for axis in np.flatnonzero(log.periodic):
        difference[:, axis] -= np.round(difference[:, axis] / log.box[axis]) * log.box[axis]
    assert np.abs(difference).max() < accuracy


def picture(browser, canvas="discs"):
    return browser.execute_script(f"return document.getElementById('{canvas}').toDataURL()")


@pytest.mark.parametrize("name", [name for name in SCENES if name != "without positions"])
def test_positions_are_those_of_the_log(opened, pages, name):
    browser = opened(name)
    with open_log(pages(name)[0]) as log:
        (beyond_mark,) = log.chunks(("time",), 4100, 4101)  # few rows after a state that the player goes back to
        shares = (0.0, 0.31, 0.9, beyond_mark.time.item() / log.end_time, 1.0, 0.02, 0.6)
        for share in shares:
            time = share * log.end_time
            seek(browser, time)
            assert_positions(browser, log, time)
        shown = browser.execute_script("return [Array.from(player.gas.vx), Array.from(player.gas.vy)]")
        assert np.allclose(np.array(shown).T, log.state_at(time).velocity, rtol=0, atol=1e-5)


def test_the_piston_is_where_discs_hit_it(opened, pages):
    browser = opened("piston")
    with open_log(pages("piston")[0]) as log:
        track = piston_track(log, 0.0, log.end_time)
        for time in np.linspace(0, log.end_time, 41):
            seek(browser, time)
            assert browser.execute_script("return player.gas.pistonPlace()") == pytest.approx(track.at(time), abs=1e-4)


def test_a_gate_is_drawn_while_it_is_there(opened):
    browser = opened("walls")
    inside = "return player.gas.x.some((x, i) => Math.hypot(x - 10, player.gas.y[i] - arguments[0]) < 0.4)"
    for time, there in ((2.9, True), (3.1, False), (4.9, False), (5.1, True)):
        seek(browser, time)
        shown = Image.open(io.BytesIO(base64.b64decode(picture(browser).partition(",")[2]))).convert("L")
        heights = [y for y in (2, 5, 6, 7, 8, 9) if not browser.execute_script(inside, y)]
        dark = {y: shown.getpixel((shown.width // 2, int(shown.height * (1 - y / 10)))) < 60 for y in heights}
        assert {dark[y] for y in heights if y > 4} == {there}
        assert dark.get(2, True)


def test_playing_moves_the_discs_and_the_histogram(opened, pages):
    browser = opened("plain")
    before = picture(browser), picture(browser, "speeds")
    button = browser.find_element(By.ID, "play")
    button.click()
    assert button.text == "Pause"
    WebDriverWait(browser, 30).until(lambda b: b.execute_script("return player.time") > 2)
    button.click()
    assert button.text == "Play"
    time = browser.execute_script("return player.time")
    assert before[0] != picture(browser)
    assert before[1] != picture(browser, "speeds")
    assert browser.execute_script("return player.time") == time
    assert float(browser.find_element(By.ID, "clock").text.removeprefix("t = ")) == pytest.approx(time, rel=1e-5)
    with open_log(pages("plain")[0]) as log:
        assert_positions(browser, log, time)


def test_playing_ends_at_the_end_and_starts_anew(opened, pages):
    browser = opened("plain")
    with open_log(pages("plain")[0]) as log:
        end = log.end_time
    seek(browser, end - 0.1)
    button = browser.find_element(By.ID, "play")
    button.click()
    WebDriverWait(browser, 30).until(lambda _: button.text == "Play")
    assert browser.execute_script("return player.time") == end
    button.click()
    WebDriverWait(browser, 30).until(lambda b: 0 < b.execute_script("return player.time") < end / 2)


def test_scrubbing(opened, pages):
    browser = opened("periodic")
    slider = browser.find_element(By.ID, "scrub")
    width = slider.size["width"]
    webdriver.ActionChains(browser).move_to_element(slider).click().perform()
    with open_log(pages("periodic")[0]) as log:
        time = browser.execute_script("return player.time")
        assert time == pytest.approx(log.end_time / 2, rel=0.02)
        assert_positions(browser, log, time)
        chain = webdriver.ActionChains(browser).move_to_element(slider).click_and_hold()
        chain.move_by_offset(int(width / 4), 0).release().perform()
        time = browser.execute_script("return player.time")
        assert time == pytest.approx(0.75 * log.end_time, rel=0.03)
        assert_positions(browser, log, time)


def test_keys(opened, pages):
    browser = opened("plain")
    player = browser.find_element(By.ID, "player")
    second = browser.execute_script("return player.gas.head.speed")

    def press(*keys):
        player.send_keys(*keys)
        return browser.execute_script("return player.time")

    with open_log(pages("plain")[0]) as log:
        assert press(Keys.END) == log.end_time
    assert press(Keys.HOME) == 0
    assert press(Keys.ARROW_RIGHT) == pytest.approx(second / 25)
    assert press(Keys.SHIFT, Keys.ARROW_RIGHT) == pytest.approx(second * 26 / 25)
    assert press(Keys.ARROW_LEFT) == pytest.approx(second)
    rate = Select(browser.find_element(By.ID, "rate"))
    press(Keys.ARROW_UP)
    assert rate.first_selected_option.get_attribute("value") == "2"
    for _ in range(9):
        press(Keys.ARROW_DOWN)
    assert rate.first_selected_option.get_attribute("value") == "0.125"
    press(Keys.SPACE)
    assert browser.execute_script("return player.playing") is True
    press(Keys.SPACE)
    assert browser.execute_script("return player.playing") is False


def test_everything_is_reached_with_the_tab_key(opened):
    browser = opened("plain")
    browser.find_element(By.TAG_NAME, "body").click()
    reached = set()
    for _ in range(40):
        webdriver.ActionChains(browser).send_keys(Keys.TAB).perform()
        reached.add(browser.execute_script("return document.activeElement.id || document.activeElement.tagName"))
    assert {"player", "play", "scrub", "rate", "chosen", "A", "SUMMARY"} <= reached


def test_dark_mode(opened):
    browser = opened("plain")
    brightness = """
        const parts = getComputedStyle(document.body)[arguments[0]].match(/[0-9.]+/g).slice(0, 3).map(Number);
        return parts.reduce((a, b) => a + b) / 765
    """
    seen = {}
    for scheme in ("light", "dark"):
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
        if scheme == "dark":
            WebDriverWait(browser, 30).until(lambda _: picture(browser) != seen["light"][2])
        paper, ink = (browser.execute_script(brightness, name) for name in ("backgroundColor", "color"))
        seen[scheme] = paper, ink, picture(browser)
    assert seen["light"][0] > 0.9 > 0.2 > seen["light"][1]
    assert seen["dark"][0] < 0.2 < 0.8 < seen["dark"][1]


def test_printing(opened):
    browser = opened("plain")
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    assert not browser.find_element(By.TAG_NAME, "nav").is_displayed()
    assert not browser.find_element(By.ID, "controls").is_displayed()
    assert browser.find_element(By.ID, "discs").is_displayed()
    width, height, shown_width, shown_height = browser.execute_script("""
        const canvas = document.getElementById("discs");
        return [canvas.width, canvas.height, canvas.clientWidth, canvas.clientHeight]
    """)
    assert shown_width / shown_height == pytest.approx(width / height, rel=0.02)


@pytest.mark.parametrize("width", [360, 800, 1600])
@pytest.mark.parametrize("name", ["two species", "piston"])
def test_nothing_is_cut_off_or_wider_than_its_column(sized, name, width):
    browser = sized(name, width)
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width
    cut = "return Array.from(document.querySelectorAll('.wide, pre'), e => e.scrollWidth - e.clientWidth)"
    assert max(browser.execute_script(cut)) <= 0
    beyond = """
        const found = [];
        for (const svg of document.querySelectorAll("figure svg")) {
            const frame = svg.getBoundingClientRect(), column = svg.parentElement.getBoundingClientRect();
            if (Math.abs(frame.width - column.width) > 1) found.push("narrow");
            for (const text of svg.querySelectorAll("text")) {
                const box = text.getBoundingClientRect();
                if (box.left < frame.left - 1 || box.right > frame.right + 1) found.push(text.textContent);
            }
        }
        return found
    """
    assert browser.execute_script(beyond) == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [360, 1600])
def test_everyone_can_read_it(sized, width, scheme):
    """Nothing serious by the rules of axe-core, contrast of at least 4.5:1 among them."""
    browser = sized("piston", width, scheme)
    browser.execute_script(rules_of_axe())
    found = browser.execute_async_script("""
        const done = arguments[0];
        axe.run({ resultTypes: ["violations"] }).then(({ violations }) => done(violations
            .filter(rule => ["serious", "critical"].includes(rule.impact))
            .map(rule => [rule.id, rule.nodes.length, rule.nodes[0].html])))
    """)
    assert found == []


def test_pictures_have_the_colours_of_the_page(sized):
    ink = "return getComputedStyle(document.querySelector('figure svg text')).fill"
    assert sized("plain", 800, "light").execute_script(ink) == "rgb(26, 26, 26)"
    assert sized("plain", 800, "dark").execute_script(ink) == "rgb(230, 230, 230)"


def test_the_discs_stay_beside_the_curves_on_a_wide_screen(sized):
    browser = sized("plain", 1600)
    browser.execute_script("document.getElementById('s4').scrollIntoView()")
    canvas, section = (browser.find_element(By.ID, name).rect for name in ("discs", "s4"))
    assert canvas["x"] + canvas["width"] < section["x"]
    assert 0 <= browser.execute_script("return document.getElementById('discs').getBoundingClientRect().top") < 200


def test_every_curve_in_time_has_the_players_time(opened, pages):
    browser = opened("piston")
    with open_log(pages("piston")[0]) as log:
        end = log.end_time
    seek(browser, end / 4)
    places = "return Array.from(document.querySelectorAll('.cursor'), line => +line.getAttribute('x1'))"
    before = browser.execute_script(places)
    assert len(before) >= 4  # temperature by two routes, pressure, piston
    seek(browser, end / 2)
    assert all(a > b for a, b in zip(browser.execute_script(places), before, strict=True))
    curve = browser.find_element(By.CSS_SELECTOR, "svg.clickable")
    low, high = browser.execute_script("return JSON.parse(arguments[0].dataset.axes).x", curve)
    left, right = browser.execute_script("return JSON.parse(arguments[0].dataset.axes).place", curve)[:2]
    webdriver.ActionChains(browser).move_to_element(curve).click().perform()
    width = browser.execute_script("return arguments[0].viewBox.baseVal.width", curve)
    expected = low + (high - low) * (width / 2 - left) / (right - left)
    assert browser.execute_script("return player.time") == pytest.approx(expected, rel=0.02)


def test_the_profile_has_the_discs_of_this_instant(opened, pages):
    browser = opened("gravity")
    seek(browser, 5.0)
    first = browser.execute_script("return document.querySelector('.now').getAttribute('d')")
    seek(browser, 20.0)
    assert browser.execute_script("return document.querySelector('.now').getAttribute('d')") != first


def test_the_flight_of_a_disc(opened, pages):
    browser = opened("gravity")
    seek(browser, 5.0)
    browser.find_element(By.ID, "chosen").send_keys("7")
    said = browser.find_element(By.ID, "flight").text
    with open_log(pages("gravity")[0]) as log:
        (rows,) = log.chunks(("time", "disc"), 0, log.row_at(5.0, "right"))
        since = rows.time[rows.disc == 7][-1]
        speed = np.hypot(*log.state_at(5.0).velocity[7])
    assert said == f"disc 7: speed {speed:#.4g}, in free flight since t = {since:#.6g}"
    webdriver.ActionChains(browser).move_to_element(browser.find_element(By.ID, "discs")).click().perform()
    chosen = int(browser.find_element(By.ID, "chosen").get_attribute("value"))
    away = browser.execute_script("return Array.from(player.gas.x, (x, i) => Math.hypot(x - 10, player.gas.y[i] - 5))")
    assert away[chosen] == pytest.approx(min(away), abs=0.1)


def test_the_first_words(pages):
    text = pages("piston")[1].read_text(encoding="utf-8")
    assert "60 discs with piston, packing fraction 0.113, followed for" in text  # of the 15 by 10 below the piston


def test_a_gas_without_positions_shows_its_speeds(opened, pages):
    browser = opened("without positions")
    assert not browser.find_element(By.ID, "discs").is_displayed()
    assert "No discs to show: monte_carlo does not know where they are" in browser.find_element(By.ID, "s0").text
    before = picture(browser, "speeds")
    seek(browser, 5.0)
    assert picture(browser, "speeds") != before
    shown = np.array(browser.execute_script("return [Array.from(player.gas.vx), Array.from(player.gas.vy)]")).T
    with open_log(pages("without positions")[0]) as log:
        assert np.allclose(shown, log.state_at(5.0).velocity, rtol=0, atol=1e-5)


def test_pictures_are_there_and_every_one_has_words(opened):
    browser = opened("plain")
    found = browser.execute_script("""
        const pictures = document.querySelectorAll("figure svg");
        return Array.from(pictures, svg => [svg.getBoundingClientRect().width, svg.getAttribute("aria-label")])
    """)
    assert len(found) >= 8
    assert all(width > 200 and words for width, words in found)
    assert browser.title == "Some <discs> & no more"


@pytest.mark.parametrize("name", FULL)
def test_the_page_needs_nothing_else(pages, name):
    text = pages(name)[1].read_text(encoding="utf-8")
    assert not re.search(r"https?://|@import|url\((?!#)", text)
    assert {found[0] for found in re.findall(r'(?:src|href)="([^"]+)', text)} == {"#"}
    assert "default-src 'none'" in text


def test_a_long_log_is_played_in_part(pages, tmp_path, monkeypatch):
    monkeypatch.setattr(player_module, "MOST_ROWS", 500)
    log, page = pages("plain")[0], tmp_path / "part.html"
    assert idealgas("report", log, "-o", page, "--from", 3).exit_code == 0
    with open_log(log) as opened:
        shown = player_module.player(opened, 3.0)
        assert shown.start == 3
        assert opened.row_at(shown.end, "right") - opened.row_at(3.0, "right") == pytest.approx(500, abs=1)
        words = f"The player has t = 3 to {shown.end:.6g} of a run up to {opened.end_time:.6g}."
    assert words in page.read_text(encoding="utf-8")


def test_the_same_page_of_the_same_log(pages, tmp_path):
    again = tmp_path / "again.html"
    assert idealgas("report", pages("plain")[0], "-o", again).exit_code == 0
    assert again.read_bytes() == pages("plain")[1].read_bytes()


def test_a_log_without_events_has_no_player(tmp_path):
    simulate(parse_scene(PLAIN + "log.events = false\n"), tmp_path / "run.h5")
    assert idealgas("report", tmp_path / "run.h5", "-o", tmp_path / "run.html").exit_code == 0
    text = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert "No player: no events are on record." in text
    assert 'id="data-head"' not in text


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("-o", "page.pdf"), 2, "page.pdf: unknown kind of report (allowed: .html)"),
        (("-o", "no/page.html"), 2, "no/page.html: no folder no"),
        (("-o", "page.html", "--from", "1e9"), 2, "no window from t = 1000000000"),
        (("-o", "folder.html"), 2, "folder.html: is a folder"),
    ],
)
def test_bad_input_is_one_line(pages, arguments, code, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.html").mkdir()
    result = idealgas("report", pages("plain")[0], *arguments)
    assert (result.exit_code, result.stdout) == (code, "")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["folder.html"]
