"""Access to the files installed with the example scenes."""

import json
import re
import tomllib
from pathlib import Path

from idealgas.errors import unknown
from idealgas.examples import SCENE, first_sentence, names, path_of

from ._terminal import written

NOTEBOOK = ".ipynb"

SCHEMA = "scene.schema.json"
"""File name of the JSON Schema of scenes; the first line of a scene in the same folder refers to it."""


DIGESTS = "digests.json"
"""File name of the table of scene digests; see `idealgas.run.digest`."""


def keys() -> dict[str, str]:
    """Return the descriptions of all scene keys, indexed by the names that `--set` uses."""
    schema = json.loads(path_of(SCHEMA).read_text(encoding="utf-8"))
    descriptions: dict[str, str] = {}
    for table, entry in schema["properties"].items():
        (kind,) = re.findall(r"#/\$defs/(\w+)", json.dumps(entry))
        properties = schema["$defs"][kind]["properties"]
        descriptions |= {f"{table}.{key}": value["description"] for key, value in properties.items()}
    return descriptions


def notebooks() -> dict[str, Path]:
    """Return the paths of the notebooks, by name."""
    return {path.stem: path for path in sorted(path_of("notebooks").glob(f"*{NOTEBOOK}"))}


def shown_by(name: str) -> str:
    """Return a sentence about what an example shows.

    For a scene, return the first sentence of its description, or its title if there is no description; for a notebook,
    return its title.
    """
    if notebook := notebooks().get(name):
        cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        return cells[0]["source"][0].strip("# \n")
    scene = tomllib.loads(path_of(f"{name}{SCENE}").read_text(encoding="utf-8"))["scene"]
    return first_sentence(scene.get("description", scene["title"]))[0]


def copy_example(name: str, output: str | None, force: bool) -> None:
    """Copy a notebook, or a scene together with the JSON Schema that its first line refers to.

    Args:
        name: name of the example, with or without the file ending.
        output: path of the copy; None copies to the current folder under the name of the example.
        force: whether to overwrite an existing file of the same kind.

    Raises:
        UserError: if the example is unknown or a file cannot be written.
    """
    from idealgas.files import check_output, replacing

    name = name.removesuffix(SCENE).removesuffix(NOTEBOOK)
    source = notebooks().get(name, path_of(name + SCENE))
    if name not in (allowed := [*names(), *notebooks()]):
        raise unknown("example", name, allowed)
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
