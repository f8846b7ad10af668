"""Scenes: the TOML model, its loader and its resolved dump."""

from idealgas.scene.dump import dump_scene
from idealgas.scene.effects import Gravity, Piston, Restitution, Rotation, ThermalSide, Wall
from idealgas.scene.errors import SceneError
from idealgas.scene.loader import load_scene, parse_scene
from idealgas.scene.model import EFFECTS, Box, Disc, Header, Log, Run, Scene, Species

__all__ = [
    "EFFECTS",
    "Box",
    "Disc",
    "Gravity",
    "Header",
    "Log",
    "Piston",
    "Restitution",
    "Rotation",
    "Run",
    "Scene",
    "SceneError",
    "Species",
    "ThermalSide",
    "Wall",
    "dump_scene",
    "load_scene",
    "parse_scene",
]
