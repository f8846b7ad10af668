"""The player of the page of `idealgas report`: discs, walls and curves at one time, in headless Chromium."""

import base64
import io

import numpy as np
import pytest
from helpers.report_pages import SCENES, assert_positions, picture, seek
from PIL import Image
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select, WebDriverWait

from idealgas.log import open_log
from idealgas.movie.piston_track import piston_tracks
from idealgas.tallies.bond_order import bond_order

pytestmark = pytest.mark.slow


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
        (track,) = piston_tracks(log, 0.0, log.end_time)
        for time in np.linspace(0, log.end_time, 41):
            seek(browser, time)
            assert browser.execute_script("return player.gas.placeOf(player.gas.pistons[0])") == pytest.approx(
                track.at(time), abs=1e-4
            )


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


def test_a_run_of_any_length_is_played_in_20_seconds(opened, pages):
    browser = opened("periodic")
    with open_log(pages("periodic")[0]) as log:
        assert browser.execute_script("return player.rate * player.gas.head.speed") == pytest.approx(log.end_time / 20)
    chosen = Select(browser.find_element(By.ID, "rate")).first_selected_option
    assert (chosen.text, float(chosen.get_attribute("value"))) == (
        "all in 20 s",
        pytest.approx(browser.execute_script("return player.rate")),
    )


def test_scrubbing(opened, pages):
    browser = opened("periodic")
    slider = browser.find_element(By.ID, "scrub")
    width = slider.size["width"]
    ActionChains(browser).move_to_element(slider).click().perform()
    with open_log(pages("periodic")[0]) as log:
        time = browser.execute_script("return player.time")
        assert time == pytest.approx(log.end_time / 2, rel=0.02)
        assert_positions(browser, log, time)
        chain = ActionChains(browser).move_to_element(slider).click_and_hold()
        chain.move_by_offset(int(width / 4), 0).release().perform()
        time = browser.execute_script("return player.time")
        assert time == pytest.approx(0.75 * log.end_time, rel=0.03)
        assert_positions(browser, log, time)


def test_keys(opened, pages):
    browser = opened("plain")
    player, rate = browser.find_element(By.ID, "player"), Select(browser.find_element(By.ID, "rate"))
    rate.select_by_value("1")
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
    rates = [float(option.get_attribute("value")) for option in rate.options]
    assert rates == sorted(rates)
    press(Keys.ARROW_UP)
    assert float(rate.first_selected_option.get_attribute("value")) == rates[rates.index(1) + 1]
    for _ in range(9):
        press(Keys.ARROW_DOWN)
    assert float(rate.first_selected_option.get_attribute("value")) == rates[0]
    press(Keys.SPACE)
    assert browser.execute_script("return player.playing") is True
    press(Keys.SPACE)
    assert browser.execute_script("return player.playing") is False


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
    ActionChains(browser).move_to_element(curve).click().perform()
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
    ActionChains(browser).move_to_element(browser.find_element(By.ID, "discs")).click().perform()
    chosen = int(browser.find_element(By.ID, "chosen").get_attribute("value"))
    away = browser.execute_script("return Array.from(player.gas.x, (x, i) => Math.hypot(x - 10, player.gas.y[i] - 5))")
    assert away[chosen] == pytest.approx(min(away), abs=0.1)


def test_colours_of_the_discs(opened, pages):
    """Order as the discs have it at the instants that the page knows: none below a third, else one of 16 angles."""
    browser = opened("dense")
    colours, shown = Select(browser.find_element(By.ID, "colour")), set()
    with open_log(pages("dense")[0]) as log:
        state = log.state_at(log.end_time)
        order = bond_order(state.position, log.box, log.periodic).value
        seek(browser, log.end_time)
    for name in ("speed", "order"):
        colours.select_by_value(name)
        shown.add(picture(browser))
        assert browser.find_element(By.ID, "discs").get_attribute("aria-label").endswith(f"coloured by {name}")
    assert len(shown) == 2
    shades = np.array(browser.execute_script("return Array.from(player.gas.orders())"))
    assert np.array_equal(shades == 0, np.abs(order) < 1 / 3)
    turn = (shades - 1) % 16 / 16 - np.angle(order) / (2 * np.pi)
    assert np.abs(turn - np.round(turn))[shades > 0].max() <= 1 / 32 + 1e-9
    assert np.array_equal(shades > 16, np.abs(order) >= 2 / 3)


@pytest.mark.parametrize(("name", "offered"), [("dense", ["speed", "order"]), ("two species", ["speed", "species"])])
def test_colours_that_tell_nothing_are_not_offered(opened, name, offered):
    options = opened(name).find_elements(By.CSS_SELECTOR, "#colour option")
    assert [option.get_attribute("value") for option in options] == offered
