"""Load scenes from TOML; all errors in a file are reported together."""

from collections.abc import Sequence
from os import PathLike

from idealgas.scene.changes import SceneChange, apply_change
from idealgas.scene.discs import InitialDiscs
from idealgas.scene.scene import Scene, make_scene
from idealgas.toml.issues import Key
from idealgas.toml.overrides import OverrideError, apply
from idealgas.toml.text import TextOrigin, parse_document, read_text


def load_scene(path: str | PathLike[str], overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from a TOML file and check all of it.

    Args:
        path: path of the file.
        overrides: changes to the scene, each written as "table.key=value" with a TOML value, such as "run.until=100" or
            "species.0.count=500". If the value is empty, the key is removed.

    Returns:
        The checked scene.

    Raises:
        SceneError: if the file cannot be read or the scene is invalid; the message has a line for each mistake.
    """
    return parse_scene(read_text(path), str(path), overrides)


def parse_scene(
    text: str,
    name: str = "<scene>",
    overrides: Sequence[str] = (),
    *,
    discs: InitialDiscs | None = None,
    changes: Sequence[SceneChange] = (),
) -> Scene:
    """Make a scene from TOML text and check all of it, as `load_scene` does.

    Args:
        text: TOML text of the scene.
        name: file name to be shown in messages.
        overrides: as in `load_scene`.
        discs: initial discs, if the scene was read from a log.
        changes: changes that a program made to the scene during the run.

    Returns:
        The checked scene.

    Raises:
        SceneError: if the scene is invalid.
    """
    text = text.replace("\r\n", "\n")
    document = parse_document(text, name)
    overridden: dict[Key, str] = {}
    errors = []
    for override in [overrides] if isinstance(overrides, str) else overrides:  # a single string is accepted too
        try:
            overridden[apply(override, document)] = f"--set {override}"
        except OverrideError as error:
            errors.append(f"--set {override}: {error}")
    for change in changes:
        try:
            apply_change(document, change)
        except OverrideError as error:
            errors.append(f"{change.setting}: {error}")
    return make_scene(document, TextOrigin(text, name, overridden), errors, discs=discs)
