"""Loading of scenes from TOML; all errors of a file are reported together."""

from collections.abc import Sequence
from os import PathLike
from typing import Any

from pydantic import TypeAdapter, ValidationError

from idealgas.scene.checks import issues
from idealgas.scene.scene import Scene
from idealgas.toml.issues import Issue, Key, SceneError, as_issues, table_at
from idealgas.toml.overrides import OverrideError, apply
from idealgas.toml.text import Origin, parse_document, read_text


def load_scene(path: str | PathLike[str], overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from a TOML file and check all of it.

    Args:
        path: path of the file.
        overrides: changes, each as "table.key=value" with a TOML value, such as "run.until=100" or
            "species.0.count=500"; without a value, the key is removed.

    Raises:
        SceneError: with one line per error, if the file cannot be read or the scene is invalid.
    """
    return parse_scene(read_text(path), str(path), overrides)


def parse_scene(text: str, name: str = "<scene>", overrides: Sequence[str] = ()) -> Scene:
    """Make a scene from TOML text and check all of it, as `load_scene` does. name: file name in messages."""
    text = text.replace("\r\n", "\n")
    document = parse_document(text, name)
    overridden: dict[Key, str] = {}
    errors = []
    for override in [overrides] if isinstance(overrides, str) else overrides:  # a single string
        try:
            overridden[apply(override, document)] = f"--set {override}"
        except OverrideError as error:
            errors.append(f"--set {override}: {error}")
    return make_scene(document, Origin(text, name, overridden), errors)


def make_scene(document: dict[str, Any], origin: Origin, errors: Sequence[str] = ()) -> Scene:
    """Scene of a document. Raises SceneError for its errors and the given ones."""
    try:
        scene = Scene.model_validate(document).resolved().from_origin(origin)
    except ValidationError as error:
        errors = [*errors, *origin.report(_all_issues(error, document))]
    if errors:
        raise SceneError(errors)
    return scene


def _all_issues(error: ValidationError, document: dict[str, Any]) -> list[Issue]:
    """Errors in tables and, between the valid ones, of several tables."""
    findings = error.errors(include_url=False)
    if findings[0]["type"] == "issues":
        return findings[0]["ctx"]["issues"]
    parts, invalid = _valid_parts(document)
    return [*as_issues(findings, Scene), *issues(parts, invalid)]


def _valid_parts(document: dict[str, Any]) -> tuple[Scene, set[str]]:
    """Valid tables of a document, None for each invalid one, and the names of the invalid ones."""
    parts: dict[str, Any] = {}
    invalid = set()
    for name, field in Scene.model_fields.items():
        table, value = table_at((name,), Scene), document.get(name)
        if value is not None and field.default == ():
            parts[name] = [_valid(table, item) for item in value] if isinstance(value, list) else [None]
            valid = None not in parts[name]
        elif value is not None or field.is_required():
            parts[name] = _valid(table, value)
            valid = parts[name] is not None
        else:
            valid = True
        if not valid:
            invalid.add(name)
    return Scene.model_construct(**parts), invalid


def _valid(table: type, value: Any) -> Any:
    try:
        return TypeAdapter(table).validate_python(value)
    except ValidationError:
        return None
