"""What commands refuse, in one line: with exit code 2, and 1 where the machine fails; and nothing is written."""

import re
import shlex

import pytest
from helpers.commands import PLOTTED, listing
from helpers.support import ROOT, error_of

CONFIGS = ROOT / "configs"
BENCH = "bench --number 10,40 --phi 0.1 --collisions 20 --repeats 1"
CORNER = CONFIGS / "corner.toml"
LONG = 300 * "a"
USAGE = [
    ("temperature missing.h5 -q", "missing.h5: …"),
    ("info scene.toml", "scene.toml: not a log of idealgas, but a text (`idealgas check` reads scenes)"),
    ("check run.h5", "run.h5: not TOML text, but an HDF5 file (`idealgas info` reads logs)"),
    ("check scene.toml --set species.count=5.5", "…wrong type (got 5.5; allowed a whole number)"),
    ("presure", 'unknown command, did you mean "pressure"? (got presure; allowed …'),
    ("version", 'unknown command, did you mean "--version"? (got version; allowed new, …'),
    ("help rum", "…did you mean…"),
    ("examples pistn", 'unknown example, did you mean "piston"?…'),
    ("run", "idealgas run: missing argument 'SCENE.toml'…"),
    (f"run {CORNER}", "idealgas run: missing option '-o' / '--output'…"),
    (f"run {CORNER} -o", "idealgas: option '-o' requires an argument…"),
    (f"run {CORNER} --fast -o x", "idealgas run: no such option '--fast'…"),
    (f"run {CORNER} x -o y", "idealgas run: got unexpected extra argument (x)…"),
]
MISSING_FOLDERS = [
    "check none/scene.toml", "run none/scene.toml -o run.h5", "run scene.toml -o none/run.h5", "info none/run.h5",
    "pressure none/run.h5", "pressure run.h5 --plot none/p.png", "report run.h5 -o none/page.html",
    "animate run.h5 -o none/film.gif", "export run.h5 --format csv --events -o none/events.csv",
    "recover run.h5 -o none/closed.h5", "sweep none/sweep.toml -o out", "resume none/run.h5",
    "accuracy none/scene.toml",
]  # fmt: skip
RUNS = [
    ("-o missing/run.h5", "missing/run.h5: no folder missing"),
    ("-o folder.gif", "folder.gif: is a folder"),
    ("-o file/run.h5", "file/run.h5: no folder file"),
    ("-o new.h5 --set run.until=-1", "--set run.until=-1: run.until: out of range (got -1; allowed > 0)"),
    ("-o new.h5 --stream --json", "--stream cannot be combined with --json or --watch"),
    ("-o new.h5 --stream --set log.events=false", f"{CORNER}: --stream requires events (got log.events = false)"),
]
ACCURACY = [
    (f"{CONFIGS}/baffle.toml", "nothing to compare: time steps do not support wall segments…"),
    (f"{CONFIGS}/bounce.toml", "nothing to compare: a single disc never collides with another…"),
    (f"{CONFIGS}/novak-bortz.toml", "run.method: nothing to compare…"),
    ("scene.toml -q", "-q: requires -o or --json, otherwise the result would be lost"),
]
ANALYSES = [
    ("--from 1e6", "…empty time window…"),
    ("--from 5 --to 5", "…empty time window…"),
    ("--plot picture.xyz", "…unknown figure format…"),
]
LOGS = [
    ("events run.h5 --disc 60", "run.h5: no such disc (got 60; allowed 0 to 59)"),
    ("events eventless.h5", "…has no events…"),
    ("watch eventless.h5", "…has no events (made with log.events = false)…"),
    ("pressure run.h5 run.h5", "…"),
    ("heat-capacity run.h5 run.h5", "…"),
    ("relaxation run.h5 --plot-errors errors.png", "relaxation: no error bar was estimated from blocks of time"),
    (
        "relaxation falling.h5",
        "…relaxation requires constant kinetic energy; use `idealgas evolution` for a gas with gravity…",
    ),
    ("relaxation run.h5 --to 1e-9", "…no two discs collide between t = 0 and 1e-09…"),
    ("relaxation run.h5 --every 1e-9", "…instants are too many for a table (allowed <= 10000)…"),
    ("report run.h5 -o page.pdf", "…page.pdf: unknown kind of report (allowed: .html)…"),
    ("report run.h5 -o page.html --from 1e9", "…empty time window t = 1000000000…"),
    ("report run.h5 -o folder.html", "…folder.html: is a folder…"),
    ("resume run.h5 --events 100", "…already at … events; 100 is earlier…"),
    ("resume run.h5 --collisions-per-disc 0.1", "… collisions per disc; 0.1 is earlier…"),
    ("resume run.h5 --until 0.001", "… units of time; 0.001 is earlier…"),
    ("resume run.h5 --until -1", "…run.until: out of range…"),
    ("resume run.h5 --events 1.5", "…'1.5' is not a valid integer…"),
]
PARTS = "…parts must be 1 or more, and apply only to events or flights in parquet…"
EXPORTS = [
    ("--frames 3", "--format: missing (allowed csv, parquet, gsd, extxyz, h5md3d)…"),
    ("--frames 3 -o gas.xyz", "--format: missing (allowed csv, parquet, gsd, extxyz, h5md3d)…"),
    ("--format gsd --frames 3 -o -", "…gsd cannot be written to a pipe (allowed csv, extxyz)…"),
    ("--format extxyz --frames no", "…invalid choice of frames…"),
    ("--format gsd --events", "…gsd files cannot contain events…"),
    ("--format csv", "…one of --events, --flights and --frames is required…"),
    ("--format csv --events --frames 3", "…one of --events, --flights and --frames is required…"),
    ("--format csv --events --parts 3", PARTS),
    ("--frames 3 --parts 3", PARTS),
    ("--events --parts 3 -o .", "….: already exists…"),
    ("--events --parts 3 -o -", "…--parts: a folder cannot be written to standard output (allowed -o FOLDER)…"),
]
FILMS = [
    ("homogeneous.h5", "…homogeneous.h5: has no positions to show (monte_carlo)…"),
    ("eventless.h5", "…eventless.h5: has no events (made with log.events = false)…"),
    ("piston.h5 --from 5 --to 5", "…piston.h5: empty time window t = 5 to 5: the log covers t = 0 to 30…"),
    ("piston.h5 --to 31", "…piston.h5: empty time window t = 0 to 31: the log covers t = 0 to 30…"),
    ("run.h5 --speed 1e-9 --to 30", "…frames are too many (allowed <= 1,000,000)…"),
    ("run.h5 -o film.avi", "…film.avi: unknown kind of film (allowed: .mp4, .gif)…"),
    ("piston.h5 --colour order", "…colouring by order requires a box with fixed sides (got a scene with piston)…"),
    ("run.h5 --frame 4", "…film.gif: unknown figure format (allowed .png)…"),
    ("piston.h5 --frame 31 -o a.png", "…piston.h5: no state at t = 31: the log covers t = 0 to 30…"),
    ("run.h5 -o folder.gif", "…folder.gif: is a folder…"),
    ("run.h5 --trail 60", "…trail: no disc 60 (allowed 0 to 59)…"),
    ("run.h5 --size 960", "…invalid value for '--size'…"),
    ("run.h5 --size 100x100", "…invalid value for '--size'…"),
    ("run.h5 --size 9000x300", "…invalid value for '--size'…"),
    ("run.h5 --fps 0", "…invalid value for '--fps'…"),
    ("run.h5 --speed 0", "…invalid value for '--speed'…"),
    ("run.h5 --speed -1", "…invalid value for '--speed'…"),
]
BENCHES = [
    ("--plot bench.txt", "…bench.txt: unknown figure format…"),
    ("--plot bench.png --effects", "…--plot cannot be combined with --effects…"),
    ("--threads 0", "…the number of threads must be 1 to 256…"),
    ("--number many", "…not numbers separated by commas…"),
]
REFUSED = [
    *USAGE,
    *((command, "…none…") for command in MISSING_FOLDERS),
    *((f"run {CORNER} {options}", message) for options, message in RUNS),
    *((f"accuracy {arguments}", message) for arguments, message in ACCURACY),
    *((f"{name} run.h5 {options}", message) for name in PLOTTED for options, message in ANALYSES),
    *LOGS,
    *((f"export run.h5 {options}", message) for options, message in EXPORTS),
    *((f"animate -o film.gif {arguments}", message) for arguments, message in FILMS),
    *((f"{BENCH} {options}", message) for options, message in BENCHES),
]
"""Commands in the folder of small logs, and the lines they are refused with, where … stands for any words."""

FAILED = [
    (f"accuracy {CONFIGS}/quickstart.toml -o file/out", "file/out: cannot be written: …"),
    (f"run {CORNER} -o {LONG}", f"{LONG}: cannot be written: File name too long…"),
]


@pytest.mark.parametrize(
    ("command", "message", "code"),
    [(*row, code) for rows, code in ((REFUSED, 2), (FAILED, 1)) for row in rows],
    ids=lambda value: value if isinstance(value, str) and "…" not in value and LONG not in value else "",
)
def test_a_command_that_cannot_be_is_one_line(command, message, code, folder):
    before = listing(folder)
    line = error_of(*shlex.split(command), folder=folder, code=code)
    assert re.fullmatch(".*".join(map(re.escape, message.split("…"))), line.removesuffix("\n")), line
    assert listing(folder) == before
