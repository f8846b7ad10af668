"""Scenes: the TOML model, its loader and its resolved dump."""

from idealgas.scene.loader import load_scene, parse_scene
from idealgas.scene.model import Scene
from idealgas.scene.tables.box import Box
from idealgas.scene.tables.discs import Disc, Species
from idealgas.scene.tables.document import EFFECTS
from idealgas.scene.tables.gravity import Gravity
from idealgas.scene.tables.piston import Piston
from idealgas.scene.tables.restitution import RestingDisc, Restitution
from idealgas.scene.tables.rotation import Rotation
from idealgas.scene.tables.run import Header, Log, Run
from idealgas.scene.tables.thermal import ThermalSide
from idealgas.scene.tables.thermostat import Thermostat
from idealgas.scene.tables.wall import Wall
from idealgas.toml.messages import SceneError

__all__ = [
    "EFFECTS",
    "Box",
    "Disc",
    "Gravity",
    "Header",
    "Log",
    "Piston",
    "RestingDisc",
    "Restitution",
    "Rotation",
    "Run",
    "Scene",
    "SceneError",
    "Species",
    "ThermalSide",
    "Thermostat",
    "Wall",
    "load_scene",
    "parse_scene",
]
