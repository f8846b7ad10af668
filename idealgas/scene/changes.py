"""Changes that a program makes to a scene during a run: earlier steps of a value are kept, later steps are replaced."""

from typing import Any, NamedTuple

from idealgas.effects import EFFECTS
from idealgas.effects.effect import Later
from idealgas.effects.schedule import SteppedTable, as_times, steps_of
from idealgas.scene.scene import Scene, make_scene
from idealgas.toml.issues import SceneError
from idealgas.toml.overrides import OverrideError, find, value_of
from idealgas.toml.text import TextOrigin

OPEN = "open"
"""Key that opens a wall if its value is true, and closes it if false."""


class SceneChange(NamedTuple):
    """A change to a scene.

    Attributes:
        time: time at which the change takes effect.
        setting: "table.key=value" for a value that may change in steps, "wall.NAME.open=true" or
            "wall.NAME.open=false".
    """

    time: float
    setting: str


def changed_scene(scene: Scene, change: SceneChange) -> Scene:
    """Return the scene after a change. Raises SceneError if the setting or the changed scene is invalid."""
    document = scene.model_dump(mode="json", by_alias=True, exclude_none=True)
    try:
        apply_change(document, change)
    except OverrideError as error:
        raise SceneError([f"{change.setting}: {error}"]) from None
    return make_scene(document, TextOrigin(name=change.setting), discs=scene.explicit_discs)


def apply_change(document: dict[str, Any], change: SceneChange) -> None:
    """Apply a change to a document. Raises OverrideError if the key is missing or cannot change."""
    (*tables, key), table, text = find(change.setting, document)
    if not text:
        raise OverrideError("no value")
    value = value_of(text)
    if key == OPEN and tables[:1] == ["wall"] and isinstance(value, bool):
        past = {name: [t for t in as_times(table.pop(name, None)) if t <= change.time] for name in _GATE}
        past[_GATE[not value]].append(change.time)
        table.update({name: times for name, times in past.items() if times})
    elif key in _STEPPED and key in table:
        steps = steps_of(table[key])
        table[key] = [*(step for step in steps if step[0] < change.time), (change.time, value)]
    else:
        allowed = ", ".join(sorted((*_STEPPED, OPEN)))
        raise OverrideError(f"not a value that can change (allowed {allowed}, if the scene has it)")


def effects_at(scene: Scene, later: Later) -> dict[str, Any]:
    """Return the tables of the effects, by key, for a new scene that continues this scene from a later time."""
    return {effect.key: effect.continued(getattr(scene, effect.key), later) for effect in EFFECTS if effect.key}


_GATE = ("opens_at", "closes_at")
_STEPPED = {key for table in SteppedTable.__subclasses__() for key in table.in_steps}
