"""Crafted and damaged logs: every reading command ends in order, and has no number from what breaks a stated rule.

`python tests/fuzz_logs.py` runs parts of it by hand.
"""

from collections.abc import Iterable, Sequence
from functools import partial

import pytest
from log_fuzz import sound
from log_fuzz.campaign import crafted_outcomes, damaged_outcomes, real_outcomes
from log_fuzz.commands import SLOW, Form, forms, in_turn, reading_commands
from log_fuzz.damages import damage
from log_fuzz.headers import spoil
from log_fuzz.judge import FAILURES, Table

CRAFTED, DAMAGED, REAL = 5_000, 10_000, 300
CRAFTED_IN_CI, DAMAGED_IN_CI = 300, 60

FORMS = [form for name in reading_commands() for form in forms(name)]
QUICK = [form for form in FORMS if form[0] not in SLOW]
REST = [form for form in FORMS if form[0] in SLOW]

FOUND = [
    (121, "kicks", "order", "events/velocity in another order"),  # discs outside the box: neighbours without end
    (388, "waves", "sound", "discs/velocity all 1e-200"),
    (806, "effects", "profile", "checkpoints/velocity times 1.15292e+18"),  # more boxes than an image counts
    (1157, "effects", "pressure", "events/velocity times 9.33264e-302"),  # squares are 0
    (2267, "killed", "resume", "checkpoints/velocity times 9.33264e-302"),  # nothing happens in all time
    (2433, "heat-bath", "heat-capacity", "1e+300 in observables/energy/value"),
    (2533, "thermal", "animate", "no rows of observables"),  # of a piston
    (2634, "plain", "report", "/ created gone"),
    (2830, "rough", "heat-capacity", "never had observables/energy/value"),
    (2877, "kicks", "info", "no rows of checkpoints"),  # that were broken before
    (3303, "interrupted", "resume", "no rows of observables"),
    (3761, "thermal", "evolution", "-1.7e+308 in observables/wall_energy/value"),
    (4053, "interrupted", "resume", "checkpoints/wall_energy times 8.45271e+270"),
    (4015, "thermal", "histogram", "observables/kinetic_energy/time all -0.0"),  # free times without time
]
"""Crafted logs that commands once did not bear: number, sound log, command, and a part of what was done."""


def few(case: int) -> Sequence[Form]:
    """Two commands, and now and then a slow one."""
    return [*in_turn(QUICK, 2, case), *(in_turn(REST, 1, case // 20) if case % 20 == 0 else ())]


def tried(outcomes: Iterable) -> list[str]:
    """What went wrong, a line each; prints the table of all."""
    table, wrong = Table(), []
    for number, (log, done), form, verdict in outcomes:
        table.add(number, form, verdict)
        if verdict.name in FAILURES:
            wrong.append(f"case {number} ({log}; {done}): {' '.join(form)}: {verdict.name}: {verdict.why}")
    print(table)
    return wrong


@pytest.mark.slow
def test_some_crafted_logs():
    assert tried(crafted_outcomes(range(CRAFTED_IN_CI), few, sound.SOME)) == []


@pytest.mark.slow
@pytest.mark.parametrize(("case", "log", "command", "done"), FOUND)
def test_what_was_found_once(case, log, command, done):
    """All forms of the command; the log is still made as it was."""
    found = list(crafted_outcomes(range(case, case + 1), lambda case: forms(command), (log,)))
    assert all(done in words for _, (_, words), _, _ in found)
    assert tried(found) == []


@pytest.mark.slow
def test_some_damaged_logs():
    assert tried(damaged_outcomes(range(DAMAGED_IN_CI), few, (*sound.SOME, "chunks"), damage)) == []


@pytest.mark.long
def test_crafted_logs():
    assert tried(crafted_outcomes(range(CRAFTED), lambda case: FORMS, sound.CRAFTED)) == []


@pytest.mark.long
def test_damaged_logs():
    assert tried(damaged_outcomes(range(DAMAGED), partial(in_turn, FORMS, 5), sound.DAMAGED, damage)) == []


@pytest.mark.long
def test_changed_headers():
    assert tried(damaged_outcomes(range(CRAFTED), few, sound.DAMAGED, spoil)) == []


@pytest.mark.long
def test_through_the_real_command():
    assert tried(real_outcomes(range(REAL), partial(in_turn, FORMS, 1), sound.CRAFTED)) == []
