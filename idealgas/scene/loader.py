"""From TOML text to a checked `Scene`; everything that is wrong with a text is reported at once."""

import re
import tomllib
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from idealgas.scene.checks import Fault, Key, faults
from idealgas.scene.errors import SceneError, as_faults
from idealgas.scene.model import Box, Disc, Run, Scene, Species
from idealgas.scene.origin import Origin
from idealgas.scene.overrides import OverrideError, apply


def load_scene(path: str | PathLike[str], overrides: Sequence[str] = ()) -> Scene:
    """Read a scene; an override is `table.key=value`. SceneError if it cannot be read or simulated."""
    try:
        raw = Path(path).read_bytes()
        text = raw.decode()
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise SceneError([f"{path}:{line}: not UTF-8 text (got byte 0x{raw[error.start]:02x})"]) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([f"{path}: cannot be read ({reason})"]) from None
    return parse_scene(text, str(path), overrides)


def parse_scene(text: str, name: str = "<scene>", overrides: Sequence[str] = ()) -> Scene:
    """The same from text; `name` stands for the file in messages."""
    text = text.replace("\r\n", "\n")
    document = _document(text, name)
    overridden: dict[Key, str] = {}
    errors = []
    for override in overrides:
        try:
            overridden[apply(override, document)] = override
        except OverrideError as error:
            errors.append(f"--set {override}: {error}")
    origin = Origin(text, name, overridden)
    try:
        scene = Scene.model_validate(document).from_origin(origin)
    except ValidationError as error:
        errors += origin.report(_all_faults(error, document))
    if errors:
        raise SceneError(errors)
    return scene


def _document(text: str, name: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise SceneError([f"{name}: not TOML: nested too deeply"]) from None
    except ValueError as error:
        what, line = str(error), text.count("\n") + 1
        if match := re.fullmatch(r"(.*) \(at line (\d+), column \d+\)", what, re.DOTALL):
            what, line = match[1], int(match[2])
        raise SceneError([f"{name}:{line}: not TOML: {what}"]) from None


def _all_faults(error: ValidationError, document: dict[str, Any]) -> list[Fault]:
    """Faults inside tables and, over those tables that have none, between tables."""
    findings = error.errors(include_url=False)
    if findings[0]["type"] == "faults":
        return findings[0]["ctx"]["faults"]
    return [
        *as_faults(findings),
        *faults(
            _sound(Box, document.get("box")),
            _sound_items(Species, document.get("species", [])),
            _sound_items(Disc, document.get("disc", [])),
            _sound(Run, document.get("run")),
        ),
    ]


def _sound(table: type, value: Any) -> Any:
    try:
        return TypeAdapter(table).validate_python(value)
    except ValidationError:
        return None


def _sound_items(table: type, value: Any) -> list[Any]:
    return [_sound(table, item) for item in value] if isinstance(value, list) else [None]
