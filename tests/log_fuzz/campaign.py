"""Crafted and damaged logs, each with some commands, and the verdict on every outcome."""

import contextlib
import gc
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from log_fuzz.commands import NAME
from log_fuzz.crafted import Crafted, craft
from log_fuzz.damages import Damaged, damage, states
from log_fuzz.judge import Reference, Verdict, judge, judge_damage, reference
from log_fuzz.sound import unpacked
from log_fuzz.workers import Form, Outcome, Task, outcomes

Choice = Callable[[int], Sequence[Form]]
"""The commands for a case."""
Found = Iterator[tuple[int, tuple[str, str], Form, Verdict]]
"""Number of the case, its sound log and what was done to it, the command, and the verdict."""


def references(data: bytes, forms: Sequence[Form]) -> dict[Form, Reference]:
    """Every command on a sound log, in this process, which has then imported and compiled all that they need."""
    found = {}
    with tempfile.TemporaryDirectory(prefix="log-fuzz-") as folder, contextlib.chdir(folder):
        for form in forms:
            Path(NAME).write_bytes(data)
            found[form] = reference(form, frozenset({NAME}))
    return found


def crafted_outcomes(cases: range, choice: Choice, names: Sequence[str]) -> Found:
    """Crafted logs of these numbers, each with the commands that are chosen for it."""
    sound = {name: unpacked(name) for name in names}
    chosen = {case: choice(case) for case in cases}
    wanted: dict[str, dict[Form, None]] = {name: {} for name in names}
    for case, forms in chosen.items():
        wanted[names[case % len(names)]].update(dict.fromkeys(forms))
    known = {name: references(sound[name], list(forms)) for name, forms in wanted.items()}
    gc.collect()
    gc.freeze()
    tasks = [Task(case, partial(craft, case, sound=sound, names=names), forms) for case, forms in chosen.items()]
    made: Crafted
    for number, made, form, outcome in outcomes(tasks):
        verdict = judge(form, outcome, made.effects, known[made.sound][form])
        yield number, (made.sound, "; ".join(f"{e.expect.value}: {e.what}" for e in made.effects)), form, verdict


def damaged_outcomes(cases: range, choice: Choice, names: Sequence[str]) -> Found:
    """Damaged logs of these numbers, each with the commands that are chosen for it."""
    whole = {name: states(name) for name in names}
    chosen = {case: choice(case) for case in cases}
    known: dict[tuple[str, Form], list[Outcome]] = {}
    for name, logs in whole.items():
        forms = list(
            dict.fromkeys(form for case, each in chosen.items() if names[case % len(names)] == name for form in each)
        )
        for data in logs:
            for form, found in references(data, forms).items():
                known.setdefault((name, form), []).append(found.outcome)
    gc.collect()
    gc.freeze()
    first = {name: logs[0] for name, logs in whole.items()}
    tasks = [Task(case, partial(damage, case, sound=first, names=names), forms) for case, forms in chosen.items()]
    made: Damaged
    for number, made, form, outcome in outcomes(tasks):
        verdict = judge_damage(form, outcome, known[made.sound, form])
        yield number, (made.sound, made.what), form, verdict
