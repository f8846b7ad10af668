"""Scenes: their tables, checks and loader."""

from idealgas.effects.gravity import GravityTable
from idealgas.effects.piston import PistonTable
from idealgas.effects.restitution import RestitutionTable
from idealgas.effects.rotation import RotationTable
from idealgas.effects.steering import SteeringTable
from idealgas.effects.thermal import ThermalSide
from idealgas.effects.thermostat import ThermostatTable
from idealgas.effects.vibration import VibratingSide
from idealgas.effects.wall import WallTable
from idealgas.scene.defaults import RestingDisc
from idealgas.scene.loader import load_scene, parse_scene
from idealgas.scene.scene import Scene
from idealgas.scene.tables import Box, Disc, Header, LogTable, Run, Species
from idealgas.toml.issues import SceneError

__all__ = [
    "Box",
    "Disc",
    "GravityTable",
    "Header",
    "LogTable",
    "PistonTable",
    "RestingDisc",
    "RestitutionTable",
    "RotationTable",
    "Run",
    "Scene",
    "SceneError",
    "Species",
    "SteeringTable",
    "ThermalSide",
    "ThermostatTable",
    "VibratingSide",
    "WallTable",
    "load_scene",
    "parse_scene",
]
