"""Write the report of a log: a self-contained HTML page with the run, all applicable analyses and a player."""

import json
import os
import re
from collections.abc import Callable, Sequence
from importlib import resources
from pathlib import Path
from string import Template

from idealgas.analysis import registry
from idealgas.analysis.info import info
from idealgas.errors import UserError
from idealgas.examples import first_sentence
from idealgas.files import check_output, written
from idealgas.log import Log, takes_path
from idealgas.presentation.tables import Number, Table, escape, html_table
from idealgas.report.picture import html_pictures
from idealgas.report.player import MOST_DISCS, Player, player
from idealgas.report.sections import ReportSection, make_sections

SCRIPTS = ("gas.js", "views.js", "curves.js", "player.js")
"""JavaScript files of the page, in order."""


CODE = re.compile("`([^`]+)`")
"""Pattern of commands and keys in a description, which are enclosed in backticks."""


def text_of(name: str) -> str:
    """Return the text of a file that is included in the page."""
    return resources.files("idealgas.report").joinpath(name).read_text(encoding="utf-8")


PLAYER = Template(text_of("player.html"))

SUMMARY = {
    "end_time": "end (time)",
    "events": "events",
    "disc_collisions": "disc collisions",
    "wall_hits": "wall hits",
    "thermostat_collisions": "thermostat collisions",
    "steered": "velocities changed from outside",
    "escaped": "discs that left the gas",
    "trials": "trials of pairs",
    "rows": "event rows",
    "epochs": "epochs",
    "energy_change": "energy change of the discs (energy)",
    "energy_drift": "energy drift (relative to the energy)",
    "deepest_overlap": "deepest overlap (relative to the sum of the radii)",
    "max_wall_penetration": "largest penetration of a wall (diameters)",
    "seconds": "wall time (s)",
    "compile_seconds": "compiling or loading machine code beforehand (s)",
}
"""Labels, with units, of the values from the summary of a run that the report shows."""


@takes_path
def write_report(
    log: Log,
    output: str | os.PathLike[str],
    *,
    start: float | None = None,
    force: bool = False,
    on_step: Callable[[int, int], None] = lambda done, total: None,
) -> Path:
    """Write the report page of a log.

    Args:
        log: the log to show, or its path.
        output: path of the page, with extension .html or .htm.
        start: first time in the player; None for the start of the log.
        force: whether to replace an existing report.
        on_step: function that is called with the number of finished sections and the total number of sections.

    Returns:
        Path of the page.

    Raises:
        UserError: if the path has another extension, or if the log does not cover `start`.
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
        part.write_text(_page(log, played, sections), encoding="utf-8", newline="\n")
    return path


def _page(log: Log, played: Player | None, sections: Sequence[ReportSection]) -> str:
    facts = info(log)
    file = facts["file"]
    applicable = [section for section in sections if section.left_out is None]
    first = {section.analysis: section for section in reversed(applicable)}  # the first section of each analysis
    main = [first[name] for name in registry.shown(log.scene) if name in first] or applicable
    more = [section for section in applicable if all(section is not shown for shown in main)]
    parts = [(section.title, _section(section, f"p{k}")) for k, section in enumerate((*main, *more))]
    parts.insert(len(main), ("The run", _run(log, facts)))
    if left_out := [(section.title, section.left_out) for section in sections if section.left_out is not None]:
        rows = "".join(f"<li>{escape(title)}: {escape(reason)}</li>" for title, reason in left_out)
        parts.append(("What does not apply", f"<ul>{rows}</ul>"))
    title = log.scene.scene.title or Path(log.path).name
    names = ["The discs" if log.has_positions else "The speeds", "What it shows", *(name for name, _ in parts)]
    contents = "".join(f'<li><a href="#s{k}">{escape(name)}</a></li>' for k, name in enumerate(names))
    sentences = [*(section.words for section in main if section.words), _summary(log, facts)]
    html = [f'<section id="s{k}"><h2>{escape(name)}</h2>{body}</section>' for k, (name, body) in enumerate(parts, 2)]
    folded = len(main) + 1
    lead, description = first_sentence(log.scene.scene.description)
    return Template(text_of("report.html")).substitute(
        title=escape(title),
        lead=escape(lead or sentences.pop(0)),
        style=text_of("report.css"),
        script="\n".join(map(text_of, SCRIPTS)),
        contents=f"<ul>{contents}</ul>",
        player=_player(log, played, names[0]),
        description=description_html(description),
        words="".join(f"<li>{escape(sentence)}</li>" for sentence in sentences),
        sections="\n".join(html[:folded]),
        more="\n".join(html[folded:]),
        data="" if played is None else _data(played),
        footer=escape(f"Made by idealgas {file['idealgas']} from {Path(log.path).name}: {file['command']}"),
    )


def description_html(description: str) -> str:
    """Return the paragraphs in the description of a scene as HTML.

    Indented paragraphs, which are tables and commands, keep their line breaks.
    """
    html = ""
    for text in filter(None, description.strip("\n").split("\n\n")):
        lines = text.splitlines()
        if all(line.startswith("  ") for line in lines):
            html += f'<pre tabindex="0">{chr(10).join(map(escape, lines))}</pre>'
        else:
            words = CODE.sub(r"<code>\1</code>", escape(" ".join(text.split())))
            html += f"<p>{words}</p>"
    return html


def _summary(log: Log, facts: dict) -> str:
    """Return a sentence that describes the gas, including its initial packing fraction, and its run."""
    gas, run, effects = facts["gas"], facts["run"], ", ".join(log.scene.effects)
    kind = f" with {effects}" if effects else ""
    discs = "disc" if gas["number"] == 1 else "discs"
    return (
        f"{gas['number']:,} {discs}{kind}, packing fraction {gas['packing_fraction']:.3g}, followed for "
        f"{run['end_time'] - run['start_time']:.6g} units of time ({log.scene.run.method.replace('_', '-')}, "
        f"{run['event_rows'] or 0:,} event rows)."
    )


def _player(log: Log, played: Player | None, heading: str) -> str:
    """Return the HTML of the player, with a note about the time interval that it shows."""
    if played is None:
        reason = "no events are recorded" if not log.has_events else f"more than {MOST_DISCS:,} discs are too many"
        return f'<section id="s0"><h2>{heading}</h2><p class="note">No player: {reason}.</p></section>'
    if log.has_positions:
        width, height = log.box
        shown = (
            f"The box is {width:g} × {height:g} (length). The strip below the speeds shows the colours of the discs. "
            "The discs are exact at any time, but very small ones are drawn larger."
        )
    else:
        shown = f"No discs to show: {log.scene.run.method} has no positions. Their speeds are exact."
    shown += " The player has "
    if played.end < log.end_time or played.start > log.start_time:
        shown += f"t = {played.start:.6g} to {played.end:.6g} of a run up to {log.end_time:.6g}."
    else:
        shown += "the whole run."
    shown += f" It plays for 20 s; at a playback speed of 1 ×, one second is {played.head['speed']:.3g} units of time."
    return player_html(log, heading, shown)


def player_html(log: Log, heading: str, shown: str) -> str:
    """Return the HTML of the player below a heading, with a note about what it shows."""
    return PLAYER.substitute(hidden="" if log.has_positions else " hidden", heading=heading, shown=shown)


def _data(played: Player) -> str:
    head = json.dumps(played.head, allow_nan=False).replace("<", "\\u003c")
    arrays = (f'<script type="text/plain" id="data-{name}">{packed}</script>' for name, packed in played.arrays.items())
    return "\n".join([f'<script type="application/json" id="data-head">{head}</script>', *arrays])


def _run(log: Log, facts: dict) -> str:
    """Return the HTML of the section about the run: discs, state and summary of the run, and the scene."""
    species = [
        (s["name"], Number(s["number"], ","), Number(s["radius"]), Number(s["mass"])) for s in facts["gas"]["species"]
    ]
    summary = [(label, _shown(log.summary[name])) for name, label in SUMMARY.items() if name in log.summary]
    if "trial" not in log.columns:
        summary = [row for row in summary if row[0] != SUMMARY["trials"]]
    state = [(name, facts["file"][name]) for name in ("state", "created") if name in facts["file"]] + summary
    tables = (
        Table("Discs", ("species", "N", "radius (length)", "mass (mass)"), species),
        Table("Run", ("", ""), state),
    )
    return _tables(tables) + f"<details><summary>Scene</summary><pre>{escape(log.scene_text)}</pre></details>"


def _shown(value: object) -> str:
    if value is None:
        return "–"
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}"


def _section(section: ReportSection, key: str) -> str:
    notes = "".join(f'<p class="note">{escape(note)}</p>' for table in section.tables for note in table.notes)
    picture = "" if section.picture is None else html_pictures(section.picture, section.caption, key)
    headline = f"<p>{escape(section.words)}</p>" if section.words else ""
    return f"{headline}{picture}{notes}{_tables([table for table in section.tables if table.shown])}"


def _tables(tables: Sequence[Table]) -> str:
    shown = "".join(f'<div class="wide">{html_table(table)}</div>' for table in tables)
    return f'<div class="tables">{shown}</div>'
