"""Errors that a user can correct, printed as plain lines, never as a traceback; and text made safe to print."""

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters except tabs and line ends, those that change the direction of text, and lone surrogates."""


class UserError(Exception):
    """An input or the environment is wrong; `exit_code` is the exit code of the command."""

    exit_code = 2


class OutputError(UserError):
    """A file cannot be made (exit code 2), or storing fails (exit code 1)."""

    def __init__(self, message: str, exit_code: int = 2) -> None:
        super().__init__(message)
        self.exit_code = exit_code


class NotApplicableError(UserError):
    """An analysis does not apply to this gas."""


def plain(text: str) -> str:
    """The text with control characters written as escapes, as in TOML and JSON, so that a terminal only shows it."""
    return _CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def install(extra: str) -> str:
    """Return the command that installs a group of optional packages of pyproject.toml."""
    return f'.venv/bin/pip install -e ".[{extra}]" in the top folder'


def did_you_mean(got: str, allowed: Iterable[str]) -> str:
    """Return a suggestion for a message, `, did you mean "heavy"?`, or nothing if no allowed name is similar."""
    close = get_close_matches(got, list(allowed), n=1)
    return f', did you mean "{close[0]}"?' if close else ""


def unknown(what: str, got: str, allowed: Sequence[str]) -> UserError:
    """UserError for an unknown name; it suggests the most similar allowed name.

    Args:
        what: kind of the name.
        got: the unknown name.
        allowed: all known names.
    """
    return UserError(f"unknown {what}{did_you_mean(got, allowed)} (got {got}; allowed {', '.join(allowed)})")
