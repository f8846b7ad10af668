"""The files that are installed with the example scenes, for commands."""

import json
import re
import tomllib
from pathlib import Path

from idealgas.errors import unknown
from idealgas.examples import SCENE, first_sentence, names, path_of

from ._terminal import written

NOTEBOOK = ".ipynb"

SCHEMA = "scene.schema.json"
"""Name of the JSON Schema of scenes; the first line of a scene refers to it, in the same folder."""


DIGESTS = "digests.json"
"""Name of the table of the scenes' digests, see `idealgas.run.digest`."""


def keys() -> dict[str, str]:
    """Description of every key of a scene, by its name for `--set`."""
    schema = json.loads(path_of(SCHEMA).read_text(encoding="utf-8"))
    found: dict[str, str] = {}
    for table, entry in schema["properties"].items():
        (kind,) = re.findall(r"#/\$defs/(\w+)", json.dumps(entry))
        found |= {f"{table}.{key}": one["description"] for key, one in schema["$defs"][kind]["properties"].items()}
    return found


def notebooks() -> dict[str, Path]:
    """Files of the notebooks, by name."""
    return {path.stem: path for path in sorted(path_of("notebooks").glob(f"*{NOTEBOOK}"))}


def shown_by(name: str) -> str:
    """What a scene shows, the first sentence of its description; its title if it has none. Of a notebook its title."""
    if notebook := notebooks().get(name):
        cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        return cells[0]["source"][0].strip("# \n")
    scene = tomllib.loads(path_of(f"{name}{SCENE}").read_text(encoding="utf-8"))["scene"]
    return first_sentence(scene.get("description", scene["title"]))[0]


def copy_example(name: str, output: str | None, force: bool) -> None:
    """Copy a notebook, or a scene and, into the same folder, the schema that its first line refers to.

    name: with or without the ending. output: path; None for the name in the current folder.

    Raises:
        UserError: if the example is unknown or a file cannot be written.
    """
    from idealgas.files import check_output, replacing

    name = name.removesuffix(SCENE).removesuffix(NOTEBOOK)
    source = notebooks().get(name, path_of(name + SCENE))
    if name not in (known := [*names(), *notebooks()]):
        raise unknown("example", name, known)
    path = Path(output or source.name)
    copies = {path: source}
    check_output(path, "scene" if source.suffix == SCENE else NOTEBOOK, force)
    if source.suffix == SCENE:
        schema = path.with_name(SCHEMA)
        if schema.exists():
            check_output(schema, SCHEMA, force=True)
        copies[schema] = path_of(SCHEMA)
    for target, original in copies.items():
        with replacing(target) as part:
            part.write_bytes(original.read_bytes())
        written(target)
