"""Errors that a user can correct, printed on one line without a traceback, and text that is safe to print."""

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters except tabs and line ends, characters that change the direction of text, and lone surrogates."""


class UserError(Exception):
    """An error in the input or the environment; `exit_code` is the exit code of the command."""

    exit_code = 2


class OutputError(UserError):
    """A file must not or cannot be created (exit code 2), or cannot be written (exit code 1)."""

    def __init__(self, message: str, exit_code: int = 2) -> None:
        super().__init__(message)
        self.exit_code = exit_code


class NotApplicableError(UserError):
    """An analysis does not apply to this gas."""


def plain(text: str) -> str:
    """Return text with control characters replaced by escapes, as in TOML and JSON, so that it is safe to print."""
    return _CONTROL.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def install(extra: str) -> str:
    """Return the command that installs a group of optional packages from pyproject.toml."""
    return f'.venv/bin/pip install -e ".[{extra}]" in the top folder'


def did_you_mean(got: str, allowed: Iterable[str]) -> str:
    """Return a suggestion for a message, `, did you mean "heavy"?`; it is empty if no allowed name is similar."""
    close = get_close_matches(got, list(allowed), n=1)
    return f', did you mean "{close[0]}"?' if close else ""


def unknown(kind: str, got: str, allowed: Sequence[str]) -> UserError:
    """Return a UserError for an unknown name, which suggests the most similar allowed name.

    Args:
        kind: what is named, for example "quantity".
        got: the unknown name.
        allowed: all allowed names.
    """
    return UserError(f"unknown {kind}{did_you_mean(got, allowed)} (got {got}; allowed {', '.join(allowed)})")
