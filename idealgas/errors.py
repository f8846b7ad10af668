"""Errors that a user can correct: printed as plain lines, never as a traceback."""


class UserError(Exception):
    """An input or the environment is wrong; `exit_code` is the exit code of the command."""

    exit_code = 2


class NotApplicableError(UserError):
    """An analysis does not apply to this gas."""
