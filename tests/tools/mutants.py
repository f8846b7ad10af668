"""Small changes of the program, one at a time, and whether its tests notice them.

    .venv/bin/python tests/tools/mutants.py [WORD ...]

`mutants.txt` lists the changes: below the path of a file in brackets, lines of the form `old text ⇒ new text`, where
the old text stands once in the file. Further tests may follow the path in brackets. Words choose the changes whose path
or text has one of them.

Each change is made in a copy of the repository, and the tests of its module run there until one fails: the files
called `test_MODULE.py`, or the folder of this name. With `--wide` those in the folder of `tests/unit` that mirrors the
package follow. Tests marked `interpreted` run first, without compiling, then all; of laws, effects and engine only the
former, unless `--compiled` is given. A change is caught if a test fails that passes without it.
"""

import argparse
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
TABLE = Path(__file__).with_suffix(".txt")
ARROW = " ⇒ "
COMPILED = ("physics", "effects", "engine")
"""Packages whose code is compiled: an edit makes numba compile all of it again."""

NO_TESTS, PASSED = 5, 0
"""Exit codes of pytest."""

HANGS = 5.0
"""Times as long as without the change after which tests are taken to hang."""


class Mutant(NamedTuple):
    """One change of one file, by its path in the repository; tests: further files of tests."""

    path: str
    old: str
    new: str
    tests: tuple[str, ...] = ()


def read_table(text: str) -> Iterator[Mutant]:
    """Changes of a table; see above."""
    path, tests = "", ()
    for line in text.splitlines():
        if match := re.fullmatch(r"\[(\S+)((?: \S+)*)\]", line):
            path, tests = match[1], tuple(match[2].split())
        elif line.strip() and not line.startswith("# "):
            old, arrow, new = line.partition(ARROW.rstrip())
            if not arrow:
                raise SystemExit(f"{TABLE.name}: no arrow in {line!r}")
            yield Mutant(path, old.removesuffix(" "), new.removeprefix(" "), tests)


def applies(mutant: Mutant) -> bool:
    """Whether the old text of a change stands in its file, once."""
    path = ROOT / mutant.path
    return path.exists() and path.read_text(encoding="utf-8").count(mutant.old) == 1


def stages(mutant: Mutant, root: Path, wide: bool) -> Iterator[list[str]]:
    """Files and folders of tests in a repository, to run one after the other; wide: with those of the package."""
    package, *parts = Path(mutant.path).with_suffix("").parts
    name, *above = [part for part in reversed(parts) if part != "__init__"] or [package]
    unit = Path("tests/cli" if package == "cli" else "tests/unit").joinpath(*reversed(above))
    near = [*mutant.tests, f"{unit}/test_{name}.py", f"{unit}/{name}"]
    near += [str(path.relative_to(root)) for path in sorted(root.glob(f"tests/*/**/test_{name}.py"))]
    actual = [path for path in dict.fromkeys(near) if (root / path).exists()]
    if actual:
        yield actual
    while not (root / unit).exists():
        unit = unit.parent
    if wide and unit.name not in ("unit", "cli") and str(unit) not in actual:
        yield [str(unit)]


class Bench:
    """A copy of the repository in which tests run."""

    def __init__(self, folder: Path, compiled: bool, wide: bool) -> None:
        """Copy the repository to a folder. compiled: whether laws are compiled. wide: see `stages`."""
        self.folder, self.compiled, self.wide = folder, compiled, wide
        self._seconds: dict[tuple[str, ...], float] = {}
        """Duration of tests without a change, seconds; nan if they fail."""
        leave = shutil.ignore_patterns(".git", ".venv", "__pycache__", ".*_cache", "node_modules")
        shutil.copytree(ROOT, folder, ignore=leave, dirs_exist_ok=True)
        for name, target in (("idealgas_cli", "cli"), ("idealgas_scenes", "configs")):
            if not (folder / name).exists():
                (folder / name).symlink_to(target)

    def run(self, arguments: list[str], interpreted: bool, limit: float | None = None) -> tuple[int, str]:
        """Exit code of pytest, and the test that fails; a test that takes longer than the limit fails."""
        environment = os.environ | {"PYTHONPATH": str(self.folder)}
        marker = ["-m", "interpreted and not long and not slow"] if interpreted else []
        environment |= {"NUMBA_DISABLE_JIT": "1"} if interpreted else {}
        command = [sys.executable, "-m", "pytest", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", *marker]
        try:
            done = subprocess.run(
                [*command, *arguments], cwd=self.folder, env=environment, capture_output=True, text=True, timeout=limit
            )
        except subprocess.TimeoutExpired:
            return 1, "hangs"
        failed = re.findall(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
        return done.returncode, failed[0].removeprefix("tests/") if failed else done.stdout[-300:] + done.stderr[-300:]

    def caught_by(self, mutant: Mutant) -> str:
        """The test that fails with a change; empty if none does."""
        path = self.folder / mutant.path
        source, times = path.read_text(encoding="utf-8"), (path.stat().st_atime, path.stat().st_mtime)
        compiles = self.compiled or Path(mutant.path).parts[1] not in COMPILED
        modes = (True, False) if compiles else (True,)
        for files, in_python in product(stages(mutant, self.folder, self.wide), modes):
            key = (*files, str(in_python))
            if key not in self._seconds:
                started = time.monotonic()
                code, failed = self.run(files, in_python)
                self._seconds[key] = time.monotonic() - started if code in (PASSED, NO_TESTS) else math.nan
                if math.isnan(self._seconds[key]):
                    print(f"BROKEN without a change: {failed}", flush=True)
            if math.isnan(self._seconds[key]):
                continue
            try:
                path.write_text(source.replace(mutant.old, mutant.new), encoding="utf-8")
                code, failed = self.run(files, in_python, HANGS * self._seconds[key] + 30)
            finally:
                path.write_text(source, encoding="utf-8")
                os.utime(path, times)  # by which numba knows it
            if code not in (PASSED, NO_TESTS):
                return failed
        return ""


def main() -> None:
    """Run the tests with each change, and print which are caught."""
    parser = argparse.ArgumentParser(description="Change the program, one line at a time, and run its tests.")
    parser.add_argument("words", nargs="*", help="parts of paths or texts of the changes to make; all if absent")
    parser.add_argument("--compiled", action="store_true", help="compile what is changed: 10 seconds and more each")
    parser.add_argument("--wide", action="store_true", help="run the tests of the whole package where others pass")
    parser.add_argument("--table", type=Path, default=TABLE, help=f"of changes; {TABLE.name} if absent")
    parser.add_argument("--folder", type=Path, help="for the copy of the repository; a temporary one if absent")
    options = parser.parse_args()
    mutants = list(read_table(options.table.read_text(encoding="utf-8")))
    chosen = [m for m in mutants if not options.words or any(w in " ".join((m.path, m.old)) for w in options.words)]
    outdated, survivors = [m for m in chosen if not applies(m)], []
    for mutant in outdated:
        print(f"OUTDATED {mutant.path}: {mutant.old}")
    with tempfile.TemporaryDirectory(prefix="idealgas-mutants-") as temporary:
        bench = Bench(options.folder or Path(temporary), options.compiled, options.wide)
        for mutant in filter(applies, chosen):
            failed = bench.caught_by(mutant)
            survivors += [] if failed else [mutant]
            print(f"{'caught' if failed else 'SURVIVED'} {mutant.path}: {mutant.old}{ARROW}{mutant.new}", end="")
            print(f"  [{failed}]" if failed else "", flush=True)
    made = len(chosen) - len(outdated)
    print(f"{made} changes, {made - len(survivors)} caught, {len(survivors)} survived, {len(outdated)} outdated")
    sys.exit(bool(survivors or outdated))


if __name__ == "__main__":
    main()
