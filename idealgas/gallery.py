"""Gallery of the example scenes: a picture of each scene at time 0, and an HTML page with all of them."""

import base64
import io
import os
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from string import Template

from idealgas.errors import UserError, unknown
from idealgas.examples import SCENE, TEMPLATE, load_example, names, path_of
from idealgas.files import check_output, written
from idealgas.presentation.tables import escape
from idealgas.report.page import description_html, text_of

SCENES = tuple(name for name in names() if name != TEMPLATE)
"""Names of the scenes in the gallery."""

ABOUT = "The example scenes in their initial states, with discs coloured by speed or, in mixtures, by species."

PAGE = Template("""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="generator" content="idealgas">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>Gallery of idealgas</title>
<style>
$style
main { grid-template: none; grid-template-columns: repeat(auto-fit, minmax(min(100%, 28rem), 1fr)); }
main { align-items: start; }
main img { display: block; max-width: 100%; max-height: 27rem; margin: 0 auto 0.75rem; }
main p { max-width: 42rem; }
</style>
</head>
<body>
<header>
<h1>Gallery of idealgas</h1>
<p>$about</p>
<nav aria-label="Scenes"><ul>$contents</ul></nav>
</header>
<main>
$scenes
</main>
</body>
</html>
""")


def described(name: str) -> tuple[str, str]:
    """Return the title of an example scene and its description as HTML."""
    about = tomllib.loads(path_of(name + SCENE).read_text(encoding="utf-8"))["scene"]
    return about["title"], description_html(about.get("description", ""))


def commands(name: str) -> tuple[str, ...]:
    """Return the commands that copy an example scene, run it, and write its report."""
    return (
        f"idealgas examples {name}",
        f"idealgas run {name}.toml -o {name}.h5",
        f"idealgas report {name}.h5 -o {name}.html",
    )


def draw(name: str) -> bytes | None:
    """Return a PNG picture of the discs in an example scene at time 0; None for a gas without positions."""
    import numpy as np
    from PIL import Image

    from idealgas.initial.build import make_gas
    from idealgas.log import LogState
    from idealgas.movie.painter import Painter
    from idealgas.movie.piston_track import pistons_at_start

    scene = load_example(name)
    if scene.run.method == "monte_carlo":
        return None
    gas = make_gas(scene)
    rms_speed = float(np.sqrt((gas.velocity**2).sum(axis=1).mean()))
    painter = Painter(
        scene,
        gas,
        pistons_at_start(scene),
        rms_speed,
        colouring="species" if len(gas.species_names) > 1 else "speed",
        panel="none",
    )
    frame = painter.paint(LogState(0.0, gas.position, gas.velocity))
    picture = io.BytesIO()
    Image.fromarray(frame[..., :3]).save(picture, format="png")
    return picture.getvalue()


def write_gallery(
    output: str | os.PathLike[str],
    scenes: Sequence[str] = SCENES,
    *,
    force: bool = False,
    on_scene: Callable[[int, str], None] = lambda done, name: None,
) -> Path:
    """Write a self-contained page with pictures and descriptions of example scenes.

    Args:
        output: path of the page, with extension .html or .htm.
        scenes: names of the scenes.
        force: whether to replace an existing page.
        on_scene: function that is called before each scene with the number of finished scenes and the name of the
            scene.

    Returns:
        Path of the page.

    Raises:
        UserError: if the path has another extension or a name is unknown.
        OutputError: if the page cannot be written.
    """
    path, kind = Path(output), Path(output).suffix.lower()
    if kind not in (".html", ".htm"):
        raise UserError(f"{output}: unknown kind of page (allowed: .html)")
    for name in scenes:
        if name not in SCENES:
            raise unknown("example", name, list(SCENES))
    check_output(path, kind, force)
    parts = []
    for k, name in enumerate(scenes):
        on_scene(k, name)
        parts.append(_scene(name, draw(name)))
    contents = "".join(f'<li><a href="#{name}">{escape(name)}</a></li>' for name in scenes)
    page = PAGE.substitute(style=text_of("report.css"), about=ABOUT, contents=contents, scenes="\n".join(parts))
    with written(path, kind, force) as part:
        part.write_text(page, encoding="utf-8", newline="\n")
    return path


def _scene(name: str, picture: bytes | None) -> str:
    """Return the HTML of a scene."""
    title, description = described(name)
    image = ""
    if picture is not None:
        data = base64.b64encode(picture).decode()
        image = f'<img src="data:image/png;base64,{data}" alt="{escape(title)}, at the start">'
    text = escape("\n".join(commands(name)))
    return f'<section id="{name}"><h2>{escape(title)}</h2>{image}{description}<pre tabindex="0">{text}</pre></section>'
