"""The event log: a crash-safe HDF5 file from which the exact state of the gas at any time can be computed."""

from idealgas.columns import Column
from idealgas.log.errors import DamageError, LogError
from idealgas.log.flights import Flights
from idealgas.log.reader import Log, open_log, takes_path
from idealgas.log.recovery import recover
from idealgas.log.replay import Checkpoint, LogState
from idealgas.log.schema import LogLayout, Wall, box_walls
from idealgas.log.writer import LogWriter

__all__ = [
    "Checkpoint",
    "Column",
    "DamageError",
    "Flights",
    "Log",
    "LogError",
    "LogLayout",
    "LogState",
    "LogWriter",
    "Wall",
    "box_walls",
    "open_log",
    "recover",
    "takes_path",
]
