"""The example scenes that are installed with the program."""

import json
import re
import tomllib
from importlib import import_module
from pathlib import Path

from idealgas.errors import unknown

from ._terminal import written

SCENE = ".toml"
TEMPLATE = "template"
"""Name of the commented scene that `idealgas new` copies."""

SCHEMA = "scene.schema.json"
"""Name of the JSON Schema of scenes; the first line of a scene refers to it, in the same folder."""


DIGESTS = "digests.json"
"""Name of the table of the scenes' digests, see `idealgas.run.digest`."""


def _folder() -> Path:
    return Path(next(iter(import_module("idealgas_scenes").__path__)))


def path_of(name: str) -> Path:
    """Path of an installed file."""
    return _folder() / name


def paths() -> list[Path]:
    """Files of all scenes, in alphabetical order of their names."""
    return sorted(_folder().glob(f"*{SCENE}"))


def names() -> list[str]:
    """Names of the scenes, in alphabetical order."""
    return [path.stem for path in paths()]


def keys() -> dict[str, str]:
    """Description of every key of a scene, by its name for `--set`."""
    schema = json.loads(path_of(SCHEMA).read_text(encoding="utf-8"))
    found: dict[str, str] = {}
    for table, entry in schema["properties"].items():
        (kind,) = re.findall(r"#/\$defs/(\w+)", json.dumps(entry))
        found |= {f"{table}.{key}": one["description"] for key, one in schema["$defs"][kind]["properties"].items()}
    return found


def shown_by(name: str) -> str:
    """What a scene shows, the first sentence of its description; its title if it has none."""
    scene = tomllib.loads((_folder() / f"{name}{SCENE}").read_text(encoding="utf-8"))["scene"]
    text = " ".join(scene.get("description", scene["title"]).split())
    return re.split(r"(?<=\.) ", text, maxsplit=1)[0]


def copy_scene(name: str, path: Path, force: bool) -> None:
    """Copy a scene and, into the same folder, the schema that its first line refers to.

    Raises:
        UserError: if the scene is unknown or a file cannot be written.
    """
    if name not in names():
        raise unknown("example", name, names())
    from idealgas.files import check_output, replacing

    schema = path.with_name(SCHEMA)
    check_output(path, "scene", force)
    if schema.exists():
        check_output(schema, SCHEMA, force=True)
    for target, source in ((path, name + SCENE), (schema, SCHEMA)):
        with replacing(target) as part:
            part.write_bytes((_folder() / source).read_bytes())
        written(target)
