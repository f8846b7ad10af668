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
