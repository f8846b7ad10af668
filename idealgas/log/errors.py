"""What is wrong with a log, said in one line."""

import re
from pathlib import Path

from idealgas.errors import UserError


class LogError(UserError):
    """A log cannot be read, or does not have what is asked for."""


class DamageError(LogError):
    """The bytes of a log, or what they say, are not those of a log: no result may be made of it."""

    def __init__(self, path: Path, what: str) -> None:
        super().__init__(f"{path}: damaged: {what}")


def reason(error: Exception) -> str:
    """Why a reading failed, in one line; HDF5 says it in parentheses."""
    if isinstance(error, UnicodeDecodeError):
        return "not UTF-8 text"
    told = isinstance(error, OSError) and error.strerror
    text = str(told or (error.args[0] if error.args else error)).splitlines()[0]
    inner = re.search(r"\((.*)\)$", text)
    return inner[1] if inner and isinstance(error, OSError | RuntimeError | KeyError) else text
