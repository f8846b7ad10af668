"""Crafted logs and damaged ones by hand: which cases, which commands; prints the failures and the table of outcomes.

python tests/fuzz_logs.py --cases 0:500 --commands info,pressure
python tests/fuzz_logs.py --damages 0:500
python tests/fuzz_logs.py --headers 0:500
"""

import argparse
import json
import sys
import time
from functools import partial
from pathlib import Path

from log_fuzz import sound
from log_fuzz.campaign import crafted_outcomes, damaged_outcomes, real_outcomes
from log_fuzz.commands import forms, in_turn, reading_commands
from log_fuzz.damages import damage
from log_fuzz.headers import spoil
from log_fuzz.judge import FAILURES, Table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", metavar="A:B", help="Numbers of crafted logs.")
    parser.add_argument("--damages", metavar="A:B", help="Numbers of damaged logs.")
    parser.add_argument("--headers", metavar="A:B", help="Numbers of logs whose HDF5 structures are changed.")
    parser.add_argument("--real", metavar="A:B", help="Numbers of crafted logs for one real command each.")
    parser.add_argument("--commands", metavar="NAME,...", help="Commands to run; by default all that read a log.")
    parser.add_argument("--each", type=int, metavar="N", help="So many of the commands for each case, in turn.")
    parser.add_argument("--without", metavar="NAME,...", default="", help="Commands to leave out.")
    parser.add_argument("--logs", metavar="NAME,...", help="Sound logs to begin with; by default all.")
    parser.add_argument("--failures", metavar="FILE", type=Path, help="Append failures as lines of JSON.")
    given = parser.parse_args()
    names = given.commands.split(",") if given.commands else reading_commands()
    chosen = [form for name in names if name not in given.without.split(",") for form in forms(name)]
    first, last = map(int, (given.damages or given.headers or given.real or given.cases).split(":"))
    run = real_outcomes if given.real else crafted_outcomes
    if given.damages or given.headers:
        run = partial(damaged_outcomes, harm=damage if given.damages else spoil)
    each = 1 if given.real else given.each
    table, begun = Table(), time.monotonic()
    all_logs = sound.DAMAGED if given.damages or given.headers else sound.CRAFTED
    logs = given.logs.split(",") if given.logs else all_logs
    for number, what, form, verdict in run(range(first, last), partial(in_turn, chosen, each), logs):
        table.add(number, form, verdict)
        if verdict.name in FAILURES:
            line = {"case": number, "log": what[0], "command": " ".join(form), "verdict": verdict.name,
                    "why": verdict.why, "done": what[1]}  # fmt: skip
            if given.failures:
                with given.failures.open("a") as file:
                    file.write(json.dumps(line) + "\n")
            else:
                print(json.dumps(line), flush=True)
        if sum(table.counts.values()) % 2000 == 0:
            print(f"{len(table.logs)} logs, {table.failures} failures, {time.monotonic() - begun:.0f} s",
                  file=sys.stderr, flush=True)  # fmt: skip
    print(table)
    print(f"{time.monotonic() - begun:.0f} s")


if __name__ == "__main__":
    main()
