"""Small logs that commands read, report pages, and the browser that opens them."""

import pytest
from helpers.commands import GAS, OTHERS, SCENE
from helpers.needs import program
from helpers.report_pages import FULL, QUICK, SCENES
from helpers.support import called, output_of, uncompiled
from selenium import webdriver

from idealgas.analysis import registry
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """A folder with scene.toml, its log run.h5, which `run` has written without a word, and logs of the OTHERS."""
    folder = tmp_path_factory.mktemp("folder")
    (folder / "scene.toml").write_text(SCENE)
    assert output_of("run", "scene.toml", "-o", "run.h5", "--quiet", folder=folder) == ""
    with uncompiled():
        for name, text in OTHERS.items():
            simulate(parse_scene(f"{GAS}run.until = 30\n{text}"), folder / f"{name}.h5")
    (folder / "file").touch()
    for name in ("folder.gif", "folder.html"):
        (folder / name).mkdir()
    return folder


@pytest.fixture(scope="session")
def pages(tmp_path_factory):
    """make(name): paths of the log and the page of one of the SCENES; only FULL ones have all the sections."""
    folder = tmp_path_factory.mktemp("report")

    def make(name):
        log, page = folder / f"{name}.h5", folder / f"{name}.html"
        if not log.exists():
            simulate(parse_scene(SCENES[name]), log)
            with pytest.MonkeyPatch.context() as patch:
                if name not in FULL:
                    patch.setattr(registry, "names", lambda: QUICK)
                made = called("report", log, "-o", page)
            assert (made.returncode, made.stdout, made.stderr) == (0, f"{page}: written\n", "")
        return log, page

    return make


@pytest.fixture(scope="session")
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
