"""Crafted logs: every command that reads logs ends with exit code 0, or with 2 and one line, and uses no number that
breaks a rule of the format.

Case k is the same log at every run: a sound one with one change or several, drawn with the seed k.
"""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from helpers.log_fuzz import headers, texts, values
from helpers.log_fuzz.commands import NAME, SLOW, Form, forms, reading_commands
from helpers.log_fuzz.editor import SOUND, Editor, Effect, broken, edited
from helpers.log_fuzz.judge import fault
from helpers.log_fuzz.texts import rewrite, texts_in

CASES, CASES_IN_CI = 1000, 200
FAMILIES, SHARES = (values, headers, texts), (0.6, 0.2, 0.2)
SINGLE = 0.65
"""Fraction of the logs that have one change; the others have two to four."""

QUICK = [form for name in reading_commands() for form in forms(name) if name not in SLOW]
REST = [form for name in SLOW for form in forms(name)]


def draw(case: int, editor: Editor) -> list[Effect]:
    """Change a log; the effects of the changes."""
    random = np.random.default_rng([case, 20])
    wanted = 1 if random.random() < SINGLE else int(random.integers(2, 5))
    effects: list[Effect] = []
    while len(effects) < wanted:
        changes = FAMILIES[random.choice(len(FAMILIES), p=SHARES)].CHANGES
        try:
            effect = changes[random.integers(len(changes))](editor, random)
        except (KeyError, ValueError, TypeError, IndexError, AttributeError):
            if not effects:
                raise
            break  # a previous change removed what this one needs
        if effect is not None:
            effects.append(effect)
    return [effect for k, effect in enumerate(effects) if not _undone(effect, effects[:k] + effects[k + 1 :], editor)]


def _undone(effect: Effect, others: Sequence[Effect], editor: Editor) -> bool:
    """Whether a broken rule may hold again: its table has no rows, or its datasets were changed twice."""
    gone = {table for table, rows in editor.rows.items() if not rows}
    twice = any(path in other.what for path in effect.paths for other in others)
    return twice or bool({path.partition("/")[0] for path in effect.paths} & gone)


def chosen(case: int) -> Sequence[Form]:
    """Two commands, and now and then a slow one."""
    two = [QUICK[(2 * case + more) % len(QUICK)] for more in range(2)]
    return [*two, REST[case // 20 % len(REST)]] if case % 20 == 0 else two


def faults(case: int, path, wanted: Sequence[Form]) -> list[str]:
    name = SOUND[case % len(SOUND)]
    with edited(path / NAME, name) as editor:
        effects = draw(case, editor)
    done = "; ".join(effect.what for effect in effects)
    actual = [(form, fault(form, effects)) for form in wanted]
    return [f"case {case} ({name}; {done}): {' '.join(form)}: {problem}" for form, problem in actual if problem]


@pytest.mark.slow
def test_some_crafted_logs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert [line for case in range(CASES_IN_CI) for line in faults(case, tmp_path, chosen(case))] == []


@pytest.mark.long
def test_crafted_logs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert [line for case in range(CASES) for line in faults(case, tmp_path, QUICK)] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", SOUND)
def test_a_log_that_is_stored_again_is_sound(name, tmp_path, monkeypatch):
    """So that all that is wrong with a crafted log is what was changed; and a broken rule is seen where it is read."""
    monkeypatch.chdir(tmp_path)
    with edited(tmp_path / NAME, name) as editor:
        for path in editor.with_rows("fiuS"):
            editor.store(path, editor.values(path))
    assert fault(("info", NAME, "--json"), []) == ""
    assert "exit code 0 with x discs/mass" in fault(("info", NAME, "--json"), [broken("x", "discs/mass")])


def test_every_command_that_reads_a_log_is_tried():
    assert {"info", "follow", "animate", "report", "export", "recover", "resume", "pressure"} <= {*reading_commands()}


# ── crafted logs on which commands once failed ──

Edit = Callable[[Editor], None]


def filled(path: str, value: float) -> Edit:
    return lambda editor: editor.store(path, np.full_like(editor.values(path), value))


def one(path: str, value: float) -> Edit:
    """Another value in the last row."""

    def edit(editor: Editor) -> None:
        values = editor.values(path)
        values[-1] = value
        editor.store(path, values)

    return edit


def times(path: str, factor: float) -> Edit:
    return lambda editor: editor.store(path, editor.values(path) * factor)


def permuted(path: str) -> Edit:
    return lambda editor: editor.store(path, np.random.default_rng(121).permutation(editor.values(path)))


def no_rows(table: str) -> Edit:
    return lambda editor: editor.rows.update({table: 0})


def said(field: str, value: bytes) -> Edit:
    """Another value in the summary."""

    def edit(editor: Editor) -> None:
        values = texts_in(editor, "summary/value")
        values[texts_in(editor, "summary/name").index(field.encode())] = value
        rewrite(editor, "summary/value", values)

    return edit


def no_attribute(name: str) -> Edit:
    return lambda editor: editor.file.attrs.__delitem__(name)


FOUND = {
    "discs outside the box, and no end of neighbours": ("thermal", "order", permuted("events/velocity")),
    "speeds whose squares are 0": ("waves", "sound", filled("discs/velocity", 1e-200)),
    "more boxes than an image counts": ("effects", "profile", times("checkpoints/velocity", 2.0**60)),
    "momenta that are 0": ("effects", "pressure", times("events/velocity", 2.0**-1000)),
    "nothing happens": ("killed", "resume", times("checkpoints/velocity", 2.0**-1000)),
    "a huge energy": ("thermal", "heat-capacity", one("observables/energy/value", 1e300)),
    "no samples of a piston": ("effects", "animate", no_rows("observables")),
    "no date": ("plain", "report", no_attribute("created")),
    "no energies": ("plain", "heat-capacity", lambda editor: editor.drop("observables/energy/value")),
    "no checkpoints": ("thermal", "info", no_rows("checkpoints")),
    "no samples": ("killed", "resume", no_rows("observables")),
    "a huge energy from a wall": ("thermal", "evolution", one("observables/wall_energy/value", -1.7e308)),
    "a huge sum": ("thermal", "resume", one("checkpoints/wall_energy_sum", 2**62)),
    "a run that took no time": ("plain", "follow", said("seconds", b"0.0")),
    "a sum of 2^63": ("thermal", "resume", one("checkpoints/wall_hits", 2**63 - 1)),
    "a sum of -2^63": ("thermal", "resume", one("checkpoints/disc_collisions", -(2**63))),
    **{
        f"{what}, {command}": (log, command, edit)
        for what, log, edit in (
            ("a late end", "plain", said("end_time", b"1e149")),
            ("an end of 200 digits", "plain", said("end_time", b"9" * 200)),
            ("no room", "effects", filled("observables/piston_position/value", 0.0)),
            ("late samples", "effects", one("observables/kinetic_energy/time", 1e150)),
            ("slow discs", "plain", filled("discs/velocity", 1e-100)),
            ("slow discs as soon as they meet", "plain", times("events/velocity", 2.0**-300)),
        )
        for command in ("evolution", "pressure", "transport", "profile", "report", "follow")
    },
    "no time passes": ("thermal", "histogram", filled("observables/kinetic_energy/time", -0.0)),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", FOUND)
def test_found_once(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name, command, edit = FOUND[case]
    with edited(tmp_path / NAME, name) as editor:
        edit(editor)
    assert [line for form in forms(command) if (line := fault(form, []))] == []
