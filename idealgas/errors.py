"""Errors that a user can correct: printed as plain lines, never as a traceback."""


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
