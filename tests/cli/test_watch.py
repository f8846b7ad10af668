"""`idealgas watch` and `run --watch`: the page of a log that is being written, in headless Chromium."""

import socket
import threading
import time
import urllib.error
import urllib.request
from contextlib import contextmanager

import psutil
import pytest
from helpers.needs import posix
from helpers.report_pages import assert_positions, picture
from helpers.support import ended, error_of, started
from selenium.webdriver.support.ui import WebDriverWait

from idealgas.log import open_log
from idealgas.report import live
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

SCENE = """
scene.description = "A gas that is watched."
scene.seed = 3
box.size = [20, 10]
species = [{name = "gas", count = 60, radius = 0.3, speed = 1.0}]
"""
ENDLESS = SCENE + "run.events = 100_000_000\n"


WRONG = (
    "part?after=x&newest=0",
    "part?after=nan&newest=0",
    "part?after=inf&newest=1",
    "part?after=0",
    "curves?points=1.5",
)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    path = tmp_path_factory.mktemp("watch") / "gas.h5"
    simulate(parse_scene(SCENE + "run.events = 150_000\n"), path)  # several parts of the motion
    return path


@contextmanager
def opened(browser, address):
    """A tab of its own with a page, whose requests are logged; nothing may be complained about."""
    first = browser.current_window_handle
    browser.switch_to.new_window("tab")
    browser.get(address)
    WebDriverWait(browser, 60).until(lambda b: b.execute_script("return player.playing"))
    yield browser
    requests = browser.execute_script("return performance.getEntriesByType('resource').map(entry => entry.name)")
    assert requests
    assert all(request.startswith((address, "data:")) for request in requests)
    assert browser.get_log("browser") == []
    browser.close()
    browser.switch_to.window(first)


def points(browser):
    """Number of round markers in the curves: parts of a path without a length."""
    paths = "Array.from(document.querySelectorAll('#sections svg path'), path => path.getAttribute('d'))"
    return browser.execute_script(f"return {paths}.join('').split('h0').length - 1")


@pytest.mark.slow
def test_a_run_is_watched(browser, tmp_path):
    (tmp_path / "gas.toml").write_text(ENDLESS)
    with started("run", "gas.toml", "-o", "gas.h5", "--watch", cwd=tmp_path) as (child, address):
        with opened(browser, address):
            assert "A gas that is watched." in browser.page_source
            before = picture(browser), picture(browser, "speeds")
            time = browser.execute_script("return player.time")
            WebDriverWait(browser, 60).until(lambda b: points(b) > 10)
            few = points(browser)
            WebDriverWait(browser, 60).until(
                lambda b: points(b) > few and b.execute_script("return player.time") > time
            )
            assert before[0] != picture(browser)
            assert before[1] != picture(browser, "speeds")
            assert "running: " in browser.find_element("id", "state").text
            browser.execute_script("player.pause()")
            with open_log(tmp_path / "gas.h5") as log:
                assert log.live
                assert_positions(browser, log, browser.execute_script("return player.time"))
        assert child.poll() is None  # a closed tab ends nothing
        code, messages = ended(child)
    assert (code, "interrupted; `idealgas resume gas.h5` continues it" in messages) == (130, True)
    assert "Traceback" not in messages
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(address, timeout=5)


@pytest.mark.slow
def test_a_finished_log_is_shown_part_after_part(browser, finished):
    with started("watch", finished, "--no-browser") as (child, address), open_log(finished) as log:
        with opened(browser, address):
            assert browser.execute_script("return player.gas.head.start") == 0
            end = browser.execute_script("return player.gas.head.end")
            assert end < log.end_time / 2
            browser.execute_script("player.seek(player.gas.head.end)")
            WebDriverWait(browser, 60).until(lambda b: b.execute_script("return player.gas.head.start") == end)
            browser.execute_script("player.jump(arguments[0])", 0.9 * log.end_time)
            WebDriverWait(browser, 60).until(lambda b: b.execute_script("return player.time") == 0.9 * log.end_time)
            assert_positions(browser, log, 0.9 * log.end_time)
            assert browser.find_element("id", "state").text.startswith("complete: ")
            browser.execute_script("player.seek(player.gas.head.end); player.play()")
            WebDriverWait(browser, 60).until(lambda b: b.execute_script("return !player.playing"))
            WebDriverWait(browser, 60).until(lambda b: points(b) > 60)
        assert ended(child) == (0, "")


def test_only_this_machine_and_this_name(finished):
    with started("watch", finished) as (child, address):
        other = urllib.request.Request(address, headers={"Host": "example.org"})
        for request, code in ((other, 403), (address + "none", 404), *((address + query, 400) for query in WRONG)):
            with pytest.raises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen(request)
            with refused.value as answer:
                assert answer.code == code
        with urllib.request.urlopen(address) as page:
            assert "default-src 'none'" in page.headers["Content-Security-Policy"]
        port = int(address.rstrip("/").rpartition(":")[2])
        with socket.create_connection(("127.0.0.1", port)) as browser, browser.makefile("rb") as answer:
            browser.sendall(b"GET http://[::1/ HTTP/1.0\r\n\r\n")  # an address that Python's urlsplit refuses
            assert answer.readline() == b"HTTP/1.0 400 Bad Request\r\n"
        line = error_of("watch", finished, "--port", port)
        assert line == f"port {port}: Address already in use\n"
        with socket.socket() as outside, pytest.raises(ConnectionRefusedError):
            outside.connect(("127.0.0.2", port))
        assert ended(child) == (0, "")


@pytest.fixture
def impatient(finished, monkeypatch):
    """Address of a server of a page that ends slow connections after 0.1 s."""
    monkeypatch.setattr(live._Handler, "timeout", 0.1)
    with open_log(finished) as log, live._Server(live.Live(log), 0) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield server.server_address
        finally:
            server.shutdown()
            thread.join()


def test_a_silent_connection_is_closed(impatient):
    half_open = [socket.create_connection(impatient) for _ in range(20)]
    for connection in half_open:
        connection.sendall(b"GET / HT")
    assert [connection.recv(1) for connection in half_open] == [b""] * 20
    for connection in half_open:
        connection.close()


def test_a_connection_that_is_never_silent_is_closed(impatient):
    """Each byte of its request comes soon after the one before, and the request never ends."""

    def drip(connection):
        for _ in range(1000):
            connection.sendall(b"x")
            time.sleep(0.01)

    with socket.create_connection(impatient) as connection, pytest.raises(ConnectionError):
        drip(connection)


@posix
def test_the_page_ends_with_a_killed_run(tmp_path):
    """The page has a process of its own, which reads its standard input until the run at the other end is gone."""
    (tmp_path / "gas.toml").write_text(ENDLESS)
    with started("run", "gas.toml", "-o", "gas.h5", "--watch", cwd=tmp_path) as (child, _):
        (page,) = psutil.Process(child.pid).children()
        assert page.is_running()
        child.kill()
        child.wait()
        page.wait(timeout=60)
    with open_log(tmp_path / "gas.h5") as log:
        assert log.run_state == "not closed (crash?)"
