"""Scenes: the TOML model, its loader and its resolved dump."""

from idealgas.scene.dump import dump_scene
from idealgas.scene.errors import SceneError
from idealgas.scene.loader import load_scene, parse_scene
from idealgas.scene.model import Box, Disc, Header, Log, Run, Scene, Species

__all__ = [
    "Box",
    "Disc",
    "Header",
    "Log",
    "Run",
    "Scene",
    "SceneError",
    "Species",
    "dump_scene",
    "load_scene",
    "parse_scene",
]
