"""Scenes: their tables, checks and loader."""

from idealgas.effects.gravity import Gravity
from idealgas.effects.piston import Piston
from idealgas.effects.restitution import Restitution
from idealgas.effects.rotation import Rotation
from idealgas.effects.steering import Steering
from idealgas.effects.thermal import ThermalSide
from idealgas.effects.thermostat import Thermostat
from idealgas.effects.vibration import VibratingSide
from idealgas.effects.wall import Wall
from idealgas.scene.defaults import RestingDisc
from idealgas.scene.loader import load_scene, parse_scene
from idealgas.scene.scene import Scene
from idealgas.scene.tables import Box, Disc, Header, Log, Run, Species
from idealgas.toml.issues import SceneError

__all__ = [
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
    "Steering",
    "ThermalSide",
    "Thermostat",
    "VibratingSide",
    "Wall",
    "load_scene",
    "parse_scene",
]
