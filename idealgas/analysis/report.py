"""A log as one page: what it is, every analysis that applies to it, and a player; nothing else is needed to read it."""

import base64
import io
import json
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from html import escape
from importlib import resources
from pathlib import Path
from string import Template

from matplotlib.figure import Figure

from idealgas.analysis.info import info
from idealgas.analysis.player import MOST_DISCS, Player, player
from idealgas.analysis.sections import SECTIONS, Section, Table
from idealgas.errors import UserError
from idealgas.log import Log

PLAYER = """
<section id="player" tabindex="-1" aria-label="Player">
<h2>$heading</h2>
<canvas id="discs" role="img" aria-label="The discs in their box, coloured by speed"$hidden></canvas>
<div id="controls">
<button id="play" type="button">Play</button>
<input id="scrub" type="range" min="0" max="10000" step="1" value="0" aria-label="Time">
<output id="clock"></output>
<label>speed <select id="rate">
<option value="0.125">⅛</option><option value="0.25">¼</option><option value="0.5">½</option>
<option value="1" selected>1</option><option value="2">2</option><option value="4">4</option>
<option value="8">8</option>
</select></label>
</div>
<canvas id="speeds" role="img" aria-label="Histogram of the speeds with Maxwell and Boltzmann's law"></canvas>
<p class="note">$shown</p>
<p class="note keys">Keys: space plays and pauses; ← → step by a frame, with shift by a second; ↑ ↓ change the speed;
Home and End go to the start and the end.</p>
</section>
"""


def write_report(
    log: Log,
    output: str | os.PathLike[str],
    *,
    start: float | None = None,
    on_step: Callable[[int, int], None] = lambda done, total: None,
) -> Path:
    """Write the page; start: of what the player shows, time. on_step(done, total).

    UserError for another ending than .html, a start that the log does not cover, and (exit code 1) if it cannot be
    written.
    """
    path = Path(output)
    if path.suffix.lower() not in (".html", ".htm"):
        raise UserError(f"{output}: unknown kind of report (allowed: .html)")
    if not path.parent.is_dir():
        raise UserError(f"{output}: no folder {path.parent}")
    steps = len(SECTIONS) + 1
    played = player(log, start)
    on_step(1, steps)
    sections, left_out = [], []
    for k, (title, analyse) in enumerate(SECTIONS):
        try:
            sections.append((title, analyse(log)))
        except UserError as error:
            left_out.append((title, str(error).removeprefix(f"{log.path}: ")))
        on_step(k + 2, steps)
    try:
        path.write_text(_page(log, played, sections, left_out), encoding="utf-8")
    except OSError as error:
        failure = UserError(f"{path}: cannot be written: {error.strerror}")
        failure.exit_code = 1
        raise failure from error
    return path


def _page(
    log: Log,
    played: Player | None,
    sections: Sequence[tuple[str, Section]],
    left_out: Sequence[tuple[str, str]],
) -> str:
    found = info(log)
    gas, run, file = found["gas"], found["run"], found["file"]
    parts = [("The run", _run(log, found)), *((title, _section(section)) for title, section in sections)]
    if left_out:
        rows = "".join(f"<li>{escape(title)}: {escape(why)}</li>" for title, why in left_out)
        parts.append(("What does not apply", f"<ul>{rows}</ul>"))
    title = log.scene.scene.title or Path(log.path).name
    phi = gas["packing_fraction"]
    subtitle = (
        f"{gas['number']:,} discs, packing fraction {phi:.4g}, {log.scene.run.method.replace('_', '-')}, "
        f"{run['end_time']:.6g} units of time, {run['event_rows'] or 0:,} event rows"
    )
    contents = "".join(f'<li><a href="#s{k}">{escape(name)}</a></li>' for k, (name, _) in enumerate(parts))
    return Template(_text("report.html")).substitute(
        title=escape(title),
        subtitle=escape(subtitle),
        style=_text("report.css"),
        script=_text("player.js"),
        contents=f"<ul>{contents}</ul>",
        player=_player(log, played),
        sections="\n".join(
            f'<section id="s{k}"><h2>{escape(name)}</h2>{body}</section>' for k, (name, body) in enumerate(parts)
        ),
        data="" if played is None else _data(played),
        footer=escape(f"Made by idealgas {file['idealgas']} from {Path(log.path).name}: {file['command']}"),
    )


def _text(name: str) -> str:
    return resources.files("idealgas.analysis").joinpath(name).read_text(encoding="utf-8")


def _player(log: Log, played: Player | None) -> str:
    """The player's part of the page, and which part of the log it has."""
    if played is None:
        why = "no events are on record" if not log.has_events else f"more than {MOST_DISCS:,} discs are too many"
        return f'<section><h2>The discs</h2><p class="note">No player: {why}.</p></section>'
    if played.end < log.end_time or played.start > log.start_time:
        shown = f"The player has t = {played.start:.6g} to {played.end:.6g} of a run up to {log.end_time:.6g}"
    else:
        shown = "The player has the whole run"
    shown += (
        ", every event of it: positions are exact at any time." if log.has_positions else "; no positions are known."
    )
    hidden, heading = ("", "The discs") if log.has_positions else (" hidden", "The speeds")
    return Template(PLAYER).substitute(hidden=hidden, heading=heading, shown=shown)


def _data(played: Player) -> str:
    head = json.dumps(played.head, allow_nan=False).replace("</", "<\\/")
    arrays = (f'<script type="text/plain" id="data-{name}">{packed}</script>' for name, packed in played.arrays.items())
    return "\n".join([f'<script type="application/json" id="data-head">{head}</script>', *arrays])


def _run(log: Log, found: dict) -> str:
    """Scene, discs and how the run ended."""
    species = [
        (s["name"], f"{s['number']:,}", f"{s['radius']:.6g}", f"{s['mass']:.6g}") for s in found["gas"]["species"]
    ]
    summary = [(name.replace("_", " "), _shown(value)) for name, value in log.summary.items()]
    state = [("state", found["file"]["state"]), ("created", found["file"]["created"]), *summary]
    return (
        _table(Table("Discs", ("species", "N", "radius", "mass"), species))
        + _table(Table("Run", ("", ""), state))
        + f"<details><summary>Scene</summary><pre>{escape(log.scene_text)}</pre></details>"
    )


def _shown(value: object) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "–"}[value]
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}" if isinstance(value, float) else str(value)


def _section(section: Section) -> str:
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in section.notes)
    picture = "" if section.picture is None else _picture(section.picture, section.caption)
    return notes + picture + "".join(map(_table, section.tables))


def _picture(figure: Figure, caption: str) -> str:
    file = io.BytesIO()
    figure.savefig(file, format="svg", metadata={"Date": None})
    source = base64.b64encode(file.getvalue()).decode()
    text = escape(caption)
    return (
        f'<figure><img alt="{text}" src="data:image/svg+xml;base64,{source}"><figcaption>{text}</figcaption></figure>'
    )


def _table(table: Table) -> str:
    def row(cells: Iterable[str], tag: str) -> Iterator[str]:
        yield "<tr>"
        for cell in cells:
            yield f"<{tag}>{escape(cell)}</{tag}>"
        yield "</tr>"

    head = "".join(row(table.heads, "th")) if any(table.heads) else ""
    body = "".join("".join(row(cells, "td")) for cells in table.rows)
    return f'<div class="wide"><table><caption>{escape(table.title)}</caption>{head}{body}</table></div>'
