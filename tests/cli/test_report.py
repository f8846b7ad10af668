"""The page of `idealgas report`, in headless Chromium as people see it: apt-get install chromium chromium-driver."""

import re
from itertools import pairwise

import numpy as np
import pytest
from helpers.needs import AXE
from helpers.report_pages import FULL, PLAIN, picture, seek
from helpers.support import called
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from idealgas.log import open_log
from idealgas.report import player as player_module
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

pytestmark = pytest.mark.slow


def test_everything_is_reached_with_the_tab_key(opened):
    browser = opened("plain")
    browser.find_element(By.CSS_SELECTOR, "nav summary").send_keys(Keys.ENTER)
    reached = set()
    for _ in range(40):
        ActionChains(browser).send_keys(Keys.TAB).perform()
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


@pytest.mark.needs("axe-core")
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [360, 800, 1600])
def test_everyone_can_read_it(sized, width, scheme):
    """Nothing to mend by the rules of axe-core, contrast of at least 4.5:1 among them."""
    browser = sized("piston", width, scheme)
    browser.execute_script(AXE.read_text(encoding="utf-8"))
    result = browser.execute_async_script("""
        const done = arguments[0];
        axe.run({ resultTypes: ["violations"] }).then(({ violations }) => done(violations
            .map(rule => [rule.id, rule.nodes.length, rule.nodes[0].html])))
    """)
    assert result == []


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


def test_a_phone_shows_the_title_a_sentence_and_the_player_first(sized):
    browser = sized("piston", 360)
    shown = ("h1", ".lead", "nav summary", "#discs", "#play", "#s1")
    rectangles = [browser.find_element(By.CSS_SELECTOR, name).rect for name in shown]
    for above, below in pairwise(rectangles):
        assert above["y"] + above["height"] <= below["y"]
    assert rectangles[shown.index("#play")]["y"] + rectangles[shown.index("#play")]["height"] < 740


@pytest.mark.parametrize("width", [360, 1600])
def test_the_contents_are_one_menu(sized, width):
    browser = sized("piston", width)
    links = browser.find_elements(By.CSS_SELECTOR, "nav a")
    assert len(links) == len(browser.find_elements(By.CSS_SELECTOR, "main section")) >= 6
    assert not any(link.is_displayed() for link in links)
    browser.find_element(By.CSS_SELECTOR, "nav summary").click()
    assert all(link.is_displayed() for link in links)
    links[-1].click()
    last = browser.find_element(By.CSS_SELECTOR, links[-1].get_attribute("href").partition("html")[2])
    assert last.is_displayed(), "in the folded part of the page"
    top = browser.execute_script("return arguments[0].getBoundingClientRect().top", last)
    assert -1 < top < 900  # a browser scrolls by whole pixels


def test_the_first_words(pages):
    text = pages("piston")[1].read_text(encoding="utf-8")
    assert '<p class="lead">A gas that &lt;presses&gt; on a piston.</p>' in text
    assert "<h2>What it shows</h2><p>Its end.</p>" in text
    assert "60 discs with piston, packing fraction 0.113, followed for" in text  # of the 15 by 10 below the piston


@pytest.mark.parametrize(
    ("overrides", "first"),
    [
        ((), ["Pressure", "Temperature", "Speeds"]),
        (("gravity.acceleration=[0, -0.2]",), ["Profile"]),
        (("piston=[{side='right', position=15.0, mass=20.0, pressure=1.5}]",), ["Evolution"]),
        (("species.0.region=[0,0,10,10]", "wall=[{from=[10,0], to=[10,10], opens_at=1.0}]"), ["Evolution"]),
        (("restitution.normal=0.95",), ["Cooling", "Evolution"]),
        (tuple(f'box.{side}="periodic"' for side in ("left", "right", "bottom", "top")), ["Transport"]),
    ],
)
def test_what_the_scene_is_about_comes_first(tmp_path, overrides, first):
    simulate(parse_scene(PLAIN, overrides=overrides), tmp_path / "gas.h5")
    assert called("report", tmp_path / "gas.h5", "-o", tmp_path / "gas.html", "-q").returncode == 0
    shown, more = (tmp_path / "gas.html").read_text(encoding="utf-8").split('<details class="more">')
    assert re.findall("<h2>(.*?)</h2>", shown) == ["The discs", "What it shows", *first, "The run"]
    assert "<h2>Temperature</h2>" in more or "Temperature" in first or "<li>Temperature: " in more


def test_a_gas_without_positions_shows_its_speeds(opened, pages):
    browser = opened("without positions")
    assert not browser.find_element(By.ID, "discs").is_displayed()
    assert "No discs to show: monte_carlo has no positions" in browser.find_element(By.ID, "s0").text
    before = picture(browser, "speeds")
    seek(browser, 5.0)
    assert picture(browser, "speeds") != before
    shown = np.array(browser.execute_script("return [Array.from(player.gas.vx), Array.from(player.gas.vy)]")).T
    with open_log(pages("without positions")[0]) as log:
        assert np.allclose(shown, log.state_at(5.0).velocity, rtol=0, atol=1e-5)


def test_pictures_are_there_and_every_one_has_words(opened):
    browser = opened("plain")
    browser.execute_script("document.querySelector('.more').open = true")
    result = browser.execute_script("""
        const pictures = document.querySelectorAll("figure svg");
        return Array.from(pictures, svg => [svg.getBoundingClientRect().width, svg.getAttribute("aria-label")])
    """)
    assert len(result) >= 8
    assert all(width > 200 and words for width, words in result)
    assert browser.title == "Some <discs> & no more"


@pytest.mark.parametrize("name", FULL)
def test_the_page_needs_nothing_else(pages, name):
    text = pages(name)[1].read_text(encoding="utf-8")
    assert not re.search(r"https?://|@import|url\((?!#)", text)
    assert {result[0] for result in re.findall(r'(?:src|href)="([^"]+)', text)} == {"#"}
    assert "default-src 'none'" in text


def test_a_long_log_is_played_in_part(pages, tmp_path, monkeypatch):
    monkeypatch.setattr(player_module, "MOST_ROWS", 500)
    log, page = pages("plain")[0], tmp_path / "part.html"
    assert called("report", log, "-o", page, "--from", 3).returncode == 0
    with open_log(log) as opened:
        shown = player_module.player(opened, 3.0)
        assert shown.start == 3
        assert opened.row_at(shown.end, "right") - opened.row_at(3.0, "right") == pytest.approx(500, abs=1)
        words = f"The player has t = 3 to {shown.end:.6g} of a run up to {opened.end_time:.6g}."
    assert words in page.read_text(encoding="utf-8")


def test_the_same_page_of_the_same_log(pages, tmp_path):
    again = tmp_path / "again.html"
    assert called("report", pages("plain")[0], "-o", again).returncode == 0
    assert again.read_bytes() == pages("plain")[1].read_bytes()


def test_a_log_without_events_has_no_player(tmp_path):
    simulate(parse_scene(PLAIN + "log.events = false\n"), tmp_path / "run.h5")
    assert called("report", tmp_path / "run.h5", "-o", tmp_path / "run.html").returncode == 0
    text = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert "No player: no events are recorded." in text
    assert 'id="data-head"' not in text
