"""Exact event-driven simulation of a two-dimensional gas of hard discs, with every event on record."""

from typing import TYPE_CHECKING, Any

from idealgas._version import __version__

if TYPE_CHECKING:
    from idealgas.log import open_log

__all__ = ["__version__", "open_log"]


def __getattr__(name: str) -> Any:
    """`open_log`, imported when it is asked for: HDF5 takes its time."""
    if name == "open_log":
        from idealgas.log import open_log

        return open_log
    raise AttributeError(f"module {__name__} has no attribute {name}")
