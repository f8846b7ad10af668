"""Scenes whose report pages are tested, and what tests do with such a page in a browser."""

import numpy as np

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
    "piston": PLAIN
    + 'scene.description = "A gas that\\n<presses> on a piston.\\n\\nIts end."\n'
    + 'piston = [{side = "right", position = 15.0, mass = 20.0, pressure = 1.5}]\n',
    "two species": PLAIN.replace("}]", '}, {name = "heavy", count = 5, radius = 0.5, mass = 9, speed = 0.1}]'),
    "dense": PLAIN.replace("[20, 10]", "[8, 4]"),
    "without positions": PLAIN + 'run.method = "monte_carlo"\nrun.v_ref = 12.0\n',
}
FULL = ("plain", "two species")
QUICK = ("temperature", "evolution", "profile")


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
