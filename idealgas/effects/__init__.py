"""The effects that a scene may add to smooth elastic discs in a reflecting box.

An effect NAME is two files: its law in `idealgas/physics/NAME.py`, and everything else in `NAME.py` here. The one list
of them is `NAMES`: tables of a scene, checks, arguments of the engines, energy account, benchmark and tests follow from
it.
"""

from importlib import import_module
from typing import Any

from idealgas.effects.effect import EffectSpec

NAMES = (
    "gravity",
    "periodic",
    "wall",
    "arc",
    "permeable",
    "absorbing",
    "rotation",
    "restitution",
    "thermal",
    "vibration",
    "shear",
    "piston",
    "thermostat",
    "steering",
)
"""The files of the effects."""

EFFECTS: tuple[EffectSpec[Any], ...] = tuple(import_module(f"{__name__}.{name}").EFFECT for name in NAMES)
"""All effects; no code of those that a scene does not have is compiled."""

EFFECT_NAMES = tuple(effect.name for effect in EFFECTS)
"""Names of the effects in output and messages."""
