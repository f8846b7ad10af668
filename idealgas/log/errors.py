"""Errors of logs; each has a message of one line."""

import re
from pathlib import Path

from idealgas.errors import UserError


class LogError(UserError):
    """A log cannot be read or does not contain the requested data."""


class DamageError(LogError):
    """A log contains damaged bytes or invalid values, so results computed from it could be wrong."""

    def __init__(self, path: Path, what: str) -> None:
        super().__init__(f"{path}: damaged: {what}")


def reason(error: Exception) -> str:
    """Return the reason for a failed read on one line; HDF5 gives the reason in parentheses at the end of a message."""
    if isinstance(error, UnicodeDecodeError):
        return "not UTF-8 text"
    system = isinstance(error, OSError) and error.strerror
    text = str(system or (error.args[0] if error.args else error)).splitlines()[0]
    if "incorrect metadata checksum" in text:
        return "checksum of an HDF5 block does not match (half written in a power failure, or changed)"
    inner = re.search(r"\((.*)\)$", text)
    return inner[1] if inner and isinstance(error, OSError | RuntimeError | KeyError) else text
