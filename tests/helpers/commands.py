"""Scenes of the small logs that tests of commands read, and what commands have in common."""

GAS = """
box.size = [20, 20]
species = [{name = "gas", count = 60, radius = 0.3, speed = 1.0}]
"""
SCENE = f"{GAS}run.collisions_per_disc = 100\n"
OTHERS = {
    "homogeneous": 'run.method = "monte_carlo"\n',
    "eventless": "log.events = false\n",
    "piston": 'piston = [{side = "right", position = 15, mass = 20, pressure = 0.1}]\n',
    "falling": "gravity.acceleration = [0, -1]\n",
}
PLOTTED = ("temperature", "pressure", "heat-capacity", "profile", "evolution", "relaxation", "histogram")
"""Commands with pictures that every gas has."""


def listing(folder):
    """Names of what is in a folder, with the times at which they were changed."""
    return {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
