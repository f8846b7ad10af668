"""Report of a log as one HTML page without other files: the run, all analyses that apply to it, and a player."""

import base64
import io
import json
import os
from collections.abc import Callable, Sequence
from importlib import resources
from pathlib import Path
from string import Template

from matplotlib import rc_context
from matplotlib.figure import Figure

from idealgas.analysis.core.html import escape, html_table
from idealgas.analysis.core.style import show_names
from idealgas.analysis.core.tables import Number, Table
from idealgas.analysis.info import info
from idealgas.analysis.report.player import MOST_DISCS, Player, player
from idealgas.analysis.report.sections import Section, make_sections
from idealgas.errors import UserError
from idealgas.files import check_output, written
from idealgas.log import Log

SCRIPTS = ("gas.js", "views.js", "player.js")
"""The program of the page, in order."""

PLAYER = """
<section id="s0">
<h2>$heading</h2>
<div id="player" tabindex="0" role="group" aria-label="Player">
<canvas id="discs" role="img" aria-label="The discs in their box, coloured by speed"$hidden></canvas>
<div id="controls">
<button id="play" type="button">Play</button>
<input id="scrub" type="range" min="0" max="10000" step="1" value="0" aria-label="Time">
<output id="clock"></output>
<label>playback <select id="rate">
<option value="0.125">⅛ ×</option><option value="0.25">¼ ×</option><option value="0.5">½ ×</option>
<option value="1" selected>1 ×</option><option value="2">2 ×</option><option value="4">4 ×</option>
<option value="8">8 ×</option>
</select></label>
</div>
<canvas id="speeds" role="img" aria-label="Histogram of the speeds with Maxwell and Boltzmann's law"></canvas>
</div>
<p class="note">$shown</p>
<p class="note keys">Keys, after a click into the player: space plays and pauses; ← → step by a frame, with shift by a
second; ↑ ↓ change the playback; Home and End go to the start and the end.</p>
</section>
"""


SUMMARY = {
    "end_time": "end (time)",
    "events": "events",
    "disc_collisions": "disc collisions",
    "wall_hits": "wall hits",
    "kicks": "kicks by the heat bath",
    "trials": "trials of pairs",
    "rows": "event rows",
    "epochs": "epochs",
    "energy_change": "energy change of the discs (energy)",
    "energy_drift": "energy drift (share of the energy)",
    "deepest_overlap": "deepest overlap (sums of two radii)",
    "farthest_outside": "farthest outside (diameters)",
    "seconds": "wall time (s)",
    "compile_seconds": "making or loading machine code, before that (s)",
}
"""Labels, with units, of the values in the summary of a run that the report shows."""


def write_report(
    log: Log,
    output: str | os.PathLike[str],
    *,
    start: float | None = None,
    force: bool = False,
    on_step: Callable[[int, int], None] = lambda done, total: None,
) -> Path:
    """Write the report page of a log and return its path.

    Args:
        log: the log to show.
        output: path of the page, with the ending .html or .htm.
        start: first time in the player; None for the start of the log.
        force: whether to replace an existing report.
        on_step: called with the number of finished sections and the number of all sections.

    Raises:
        UserError: for another ending, or if the log does not cover `start`.
        OutputError: if the page cannot be written.
    """
    path = Path(output)
    kind = path.suffix.lower()
    if kind not in (".html", ".htm"):
        raise UserError(f"{output}: unknown kind of report (allowed: .html)")
    check_output(path, kind, force)
    played = player(log, start)
    sections = make_sections(log, on_step)
    with written(path, kind, force) as part:
        part.write_text(_page(log, played, sections), encoding="utf-8")
    return path


def _page(log: Log, played: Player | None, sections: Sequence[Section]) -> str:
    found = info(log)
    gas, run, file = found["gas"], found["run"], found["file"]
    applicable = [(section.title, _section(section)) for section in sections if section.left_out is None]
    parts = [("The run", _run(log, found)), *applicable]
    if left_out := [(section.title, section.left_out) for section in sections if section.left_out is not None]:
        rows = "".join(f"<li>{escape(title)}: {escape(why)}</li>" for title, why in left_out)
        parts.append(("What does not apply", f"<ul>{rows}</ul>"))
    title = log.scene.scene.title or Path(log.path).name
    phi = gas["packing_fraction"]
    subtitle = (
        f"{gas['number']:,} discs, packing fraction {phi:.4g}, {log.scene.run.method.replace('_', '-')}, "
        f"{run['end_time']:.6g} units of time, {run['event_rows'] or 0:,} event rows"
    )
    names = ["The discs" if log.has_positions else "The speeds", *(name for name, _ in parts)]
    contents = "".join(f'<li><a href="#s{k}">{escape(name)}</a></li>' for k, name in enumerate(names))
    return Template(_text("report.html")).substitute(
        title=escape(title),
        subtitle=escape(subtitle),
        style=_text("report.css"),
        script="\n".join(map(_text, SCRIPTS)),
        contents=f"<ul>{contents}</ul>",
        player=_player(log, played, names[0]),
        sections="\n".join(
            f'<section id="s{k}"><h2>{escape(name)}</h2>{body}</section>' for k, (name, body) in enumerate(parts, 1)
        ),
        data="" if played is None else _data(played),
        footer=escape(f"Made by idealgas {file['idealgas']} from {Path(log.path).name}: {file['command']}"),
    )


def _text(name: str) -> str:
    return resources.files("idealgas.analysis.report").joinpath(name).read_text(encoding="utf-8")


def _player(log: Log, played: Player | None, heading: str) -> str:
    """HTML of the player, with a note on the time that it shows."""
    if played is None:
        why = "no events are on record" if not log.has_events else f"more than {MOST_DISCS:,} discs are too many"
        return f'<section id="s0"><h2>{heading}</h2><p class="note">No player: {why}.</p></section>'
    if log.has_positions:
        width, height = log.box
        shown = (
            f"A box of {width:g} × {height:g} (length); the strip below the speeds tells the colours of the discs. "
            "Positions are exact at any time: every event is in the page. Very small discs are drawn larger."
        )
    else:
        shown = f"No discs to show: {log.scene.run.method} does not know where they are. Their speeds are exact."
    shown += " The player has "
    if played.end < log.end_time or played.start > log.start_time:
        shown += f"t = {played.start:.6g} to {played.end:.6g} of a run up to {log.end_time:.6g}."
    else:
        shown += "the whole run."
    shown += f" At 1 × a second is {played.head['speed']:.3g} units of time."
    return Template(PLAYER).substitute(hidden="" if log.has_positions else " hidden", heading=heading, shown=shown)


def _data(played: Player) -> str:
    head = json.dumps(played.head, allow_nan=False).replace("<", "\\u003c")
    arrays = (f'<script type="text/plain" id="data-{name}">{packed}</script>' for name, packed in played.arrays.items())
    return "\n".join([f'<script type="application/json" id="data-head">{head}</script>', *arrays])


def _run(log: Log, found: dict) -> str:
    """HTML of the section on the run: discs, state and summary of the run, and the scene."""
    species = [
        (s["name"], Number(s["number"], ","), Number(s["radius"]), Number(s["mass"])) for s in found["gas"]["species"]
    ]
    summary = [(label, _shown(log.summary[name])) for name, label in SUMMARY.items() if name in log.summary]
    if "trial" not in log.columns:
        summary = [row for row in summary if row[0] != SUMMARY["trials"]]
    state = [("state", found["file"]["state"]), ("created", found["file"]["created"]), *summary]
    tables = (
        Table("Discs", ("species", "N", "radius (length)", "mass (mass)"), species),
        Table("Run", ("", ""), state),
    )
    return _tables(tables) + f"<details><summary>Scene</summary><pre>{escape(log.scene_text)}</pre></details>"


def _shown(value: object) -> str:
    if value is None:
        return "–"
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}"


def _section(section: Section) -> str:
    notes = "".join(f'<p class="note">{escape(note)}</p>' for table in section.tables for note in table.notes)
    picture = "" if section.picture is None else _picture(section.picture, section.caption)
    return f'{notes}<div class="beside">{picture}{_tables([table for table in section.tables if table.rows])}</div>'


def _picture(figure: Figure, caption: str) -> str:
    file = io.BytesIO()
    show_names(figure)
    with rc_context({"svg.hashsalt": "idealgas"}):  # the same page of the same log
        figure.savefig(file, format="svg", metadata={"Date": None})
    source = base64.b64encode(file.getvalue()).decode()
    text = escape(caption)
    return (
        f'<figure><img alt="{text}" src="data:image/svg+xml;base64,{source}"><figcaption>{text}</figcaption></figure>'
    )


def _tables(tables: Sequence[Table]) -> str:
    shown = "".join(f'<div class="wide">{html_table(table)}</div>' for table in tables)
    return f'<div class="tables">{shown}</div>'
