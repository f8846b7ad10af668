"""A stretch of a log's time, as asked for."""

from idealgas.errors import UserError
from idealgas.log import Log


def span(log: Log, start: float | None, end: float | None) -> tuple[float, float]:
    """Start and end, by default those of the log. UserError if the log does not cover them or nothing is between."""
    first = log.start_time if start is None else start
    last = log.end_time if end is None else end
    if not log.start_time <= first < last <= log.end_time:
        covered = f"the log covers t = {log.start_time:g} to {log.end_time:g}"
        raise UserError(f"{log.path}: no window from t = {first:g} to {last:g}: {covered}")
    return first, last
