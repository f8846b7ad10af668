"""Gallery of the example scenes: a picture of each at the end of its run, and one HTML page with all of them."""

import base64
import os
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from string import Template
from tempfile import TemporaryDirectory

from idealgas.analysis.core.tables import escape
from idealgas.errors import UserError, unknown
from idealgas.examples import SCENE, TEMPLATE, load_example, names, path_of
from idealgas.files import check_output, written
from idealgas.report.page import description_html, text_of

SCENES = tuple(name for name in names() if name != TEMPLATE)
"""Names of the scenes in the gallery."""

ABOUT = "The example scenes, with the discs at the end of the run, coloured by speed or, in mixtures, by species."

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
    """Title of an example scene, and its description as HTML."""
    about = tomllib.loads(path_of(name + SCENE).read_text(encoding="utf-8"))["scene"]
    return about["title"], description_html(about.get("description", ""))


def commands(name: str) -> tuple[str, ...]:
    """Commands that copy an example scene, run it, and show all about it."""
    return (
        f"idealgas examples {name}",
        f"idealgas run {name}.toml -o {name}.h5",
        f"idealgas report {name}.h5 -o {name}.html",
    )


def draw(name: str, path: Path) -> None:
    """Run an example scene and draw its discs at the end, as .png; without positions, the distribution of their speeds.

    Raises:
        OutputError: if the picture cannot be written.
    """
    from idealgas.analysis.core.style import save
    from idealgas.analysis.registry import analyse
    from idealgas.log import open_log
    from idealgas.movie.film import paint_frame
    from idealgas.movie.painter import Colouring
    from idealgas.run.simulate import simulate

    with TemporaryDirectory(prefix="idealgas-gallery-") as folder:
        log_path = Path(folder, "run.h5")
        simulate(load_example(name), log_path)
        with open_log(log_path) as log:
            if log.has_positions and log.has_events:
                colouring: Colouring = "species" if len(log.discs.species_names) > 1 else "speed"
                paint_frame(log, path, log.end_time, colouring=colouring, panel="none", force=True)
            else:
                save(analyse(log, "histogram").plot(), path, force=True)


def write_gallery(
    output: str | os.PathLike[str],
    scenes: Sequence[str] = SCENES,
    *,
    force: bool = False,
    on_scene: Callable[[int, str], None] = lambda done, name: None,
) -> Path:
    """Run example scenes and write one page with their pictures and descriptions, which needs no other files.

    Args:
        output: path of the page, with the ending .html or .htm.
        scenes: their names.
        force: whether to replace an existing page.
        on_scene: called before each scene with the number of finished ones and its name.

    Raises:
        UserError: for another ending or an unknown name.
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
    with TemporaryDirectory(prefix="idealgas-gallery-") as folder:
        for k, name in enumerate(scenes):
            on_scene(k, name)
            picture = Path(folder, f"{name}.png")
            draw(name, picture)
            parts.append(_scene(name, picture.read_bytes()))
    contents = "".join(f'<li><a href="#{name}">{escape(name)}</a></li>' for name in scenes)
    page = PAGE.substitute(style=text_of("report.css"), about=ABOUT, contents=contents, scenes="\n".join(parts))
    with written(path, kind, force) as part:
        part.write_text(page, encoding="utf-8", newline="\n")
    return path


def _scene(name: str, picture: bytes) -> str:
    """HTML of one scene."""
    title, description = described(name)
    data = base64.b64encode(picture).decode()
    return (
        f'<section id="{name}"><h2>{escape(title)}</h2>'
        f'<img src="data:image/png;base64,{data}" alt="{escape(title)}, at the end of the run">'
        f'{description}<pre tabindex="0">{escape(chr(10).join(commands(name)))}</pre></section>'
    )
