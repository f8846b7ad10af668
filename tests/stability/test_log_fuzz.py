"""Crafted and damaged logs: every reading command ends in order, and has no number from what breaks a stated rule.

`python tests/fuzz_logs.py` runs parts of it by hand.
"""

import pytest
from log_fuzz.campaign import crafted_outcomes, damaged_outcomes
from log_fuzz.commands import forms, reading_commands
from log_fuzz.judge import FAILURES, Table
from log_fuzz.sound import ALL

CRAFTED, DAMAGED = 5_000, 10_000

EVERY_FORM = [form for name in reading_commands() for form in forms(name)]


def tried(outcomes) -> list[str]:
    """What went wrong, a line each; prints the table of all."""
    table, wrong = Table(), []
    for number, (log, done), form, verdict in outcomes:
        table.add(number, form, verdict)
        if verdict.name in FAILURES:
            wrong.append(f"case {number} ({log}; {done}): {' '.join(form)}: {verdict.name}: {verdict.why}")
    print(table)
    return wrong


@pytest.mark.long
def test_crafted_logs():
    assert tried(crafted_outcomes(range(CRAFTED), lambda case: EVERY_FORM, ALL)) == []


@pytest.mark.long
def test_damaged_logs():
    assert tried(damaged_outcomes(range(DAMAGED), lambda case: EVERY_FORM, ALL)) == []
