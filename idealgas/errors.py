"""Errors that a user can mend: printed as plain lines, never as a traceback."""


class UserError(Exception):
    """Something outside the program is wrong; `exit_code` is what the command ends with."""

    exit_code = 2


class NotApplicableError(UserError):
    """An analysis has no answer for this gas."""
