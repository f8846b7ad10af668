"""What is wrong with a log, said in one line."""

from idealgas.errors import UserError


class LogError(UserError):
    """A log cannot be read, or does not have what is asked for."""
