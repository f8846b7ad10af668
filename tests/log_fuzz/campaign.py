"""Crafted and damaged logs, each with some commands, and the verdict on every outcome."""

import contextlib
import gc
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from log_fuzz.commands import NAME, Form
from log_fuzz.crafted import Crafted, craft
from log_fuzz.damages import Damaged
from log_fuzz.judge import Reference, Verdict, judge, judge_damage, reference
from log_fuzz.sound import LIVE, held, states, unpacked
from log_fuzz.workers import Task, outcomes, run_command

Choice = Callable[[int], Sequence[Form]]
"""The commands for a case."""
Found = Iterator[tuple[int, tuple[str, str], Form, Verdict]]
"""Number of the case, its sound log and what was done to it, the command, and the verdict."""


def references(data: bytes, forms: Sequence[Form], live: bool = False) -> dict[Form, Reference]:
    """Every command on a sound log, in this process, which has then imported and compiled all that they need."""
    found = {}
    with tempfile.TemporaryDirectory(prefix="log-fuzz-") as folder, contextlib.chdir(folder):
        log = Path(NAME)
        log.write_bytes(data)
        with held(log) if live else contextlib.nullcontext():
            for form in forms:
                found[form] = reference(form, frozenset({NAME}))
                log.write_bytes(data)
    return found


def crafted_outcomes(cases: range, choice: Choice, names: Sequence[str]) -> Found:
    """Crafted logs of these numbers, each with the commands that are chosen for it."""
    sound = {name: unpacked(name) for name in names}
    chosen = {case: choice(case) for case in cases}
    known = {name: [references(sound[name], forms)] for name, forms in _wanted(chosen, names).items()}
    _freeze()
    made: Crafted
    for number, made, form, outcome in outcomes(_tasks(chosen, names, known, partial(craft, sound=sound, names=names))):
        verdict = judge(form, outcome, made.effects, known[made.sound][0][form])
        yield number, (made.sound, _words(made)), form, verdict


def damaged_outcomes(cases: range, choice: Choice, names: Sequence[str], harm: Callable[..., Damaged]) -> Found:
    """Damaged logs of these numbers, each with the commands that are chosen for it; harm: `damage`, or `spoil`."""
    whole = {name: states(name) for name in names}
    chosen = {case: choice(case) for case in cases}
    wanted = _wanted(chosen, names)
    known = {name: [references(data, wanted[name], name == LIVE) for data in logs] for name, logs in whole.items()}
    _freeze()
    first = {name: logs[0] for name, logs in whole.items()}
    made: Damaged
    for number, made, form, outcome in outcomes(_tasks(chosen, names, known, partial(harm, sound=first, names=names))):
        verdict = judge_damage(form, outcome, [each[form].outcome for each in known[made.sound]])
        yield number, (made.sound, made.what), form, verdict


def _wanted(chosen: Mapping[int, Sequence[Form]], names: Sequence[str]) -> dict[str, list[Form]]:
    """The commands that are needed for each sound log."""
    wanted: dict[str, dict[Form, None]] = {name: {} for name in names}
    for case, forms in chosen.items():
        wanted[names[case % len(names)]].update(dict.fromkeys(forms))
    return {name: list(forms) for name, forms in wanted.items()}


def _tasks(
    chosen: Mapping[int, Sequence[Form]],
    names: Sequence[str],
    known: Mapping[str, Sequence[Mapping[Form, Reference]]],
    make: Callable[..., Any],
) -> Iterator[Task]:
    """The task of each case, with what its commands take on whole states of the sound log."""
    for case, forms in chosen.items():
        sounds = known[names[case % len(names)]]
        yield Task(case, partial(make, case), forms, {f: max(each[f].seconds for each in sounds) for f in forms})


def _freeze() -> None:
    """Keep what is there where it is, so that forked processes share it."""
    gc.collect()
    gc.freeze()


def real_outcomes(cases: range, choice: Choice, names: Sequence[str]) -> Found:
    """Crafted logs, each with one command in a process of its own."""
    sound = {name: unpacked(name) for name in names}
    for case in cases:
        name, (form,) = names[case % len(names)], choice(case)
        known = references(sound[name], [form])[form]
        with tempfile.TemporaryDirectory(prefix="log-fuzz-") as folder:
            log = Path(folder) / NAME
            made = craft(case, log, sound, names)
            outcome = run_command(form, Path(folder))
        yield case, (made.sound, _words(made)), form, judge(form, outcome, made.effects, known)


def _words(made: Crafted) -> str:
    return "; ".join(f"{effect.expect.value}: {effect.what}" for effect in made.effects)
