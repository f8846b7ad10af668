"""The logs that every crafted and every damaged one begins with: the old ones in `cases/logs`, with all effects."""

import lzma
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "cases" / "logs"
PACKED = ".h5.xz"
ALL = tuple(sorted(path.name.removesuffix(PACKED) for path in FOLDER.glob(f"*{PACKED}")))
SOME = ("plain", "killed", "effects", "monte-carlo", "no-events", "rough", "gate")
"""Those of which the quicker tests are made: each method, with events and without, and every column."""


def unpacked(name: str) -> bytes:
    """The bytes of a sound log."""
    return lzma.decompress((FOLDER / f"{name}{PACKED}").read_bytes())
