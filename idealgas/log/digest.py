"""Digests of a log, which depend only on its events and final state.

Compression, the time of writing and the number of threads do not matter.
"""

import hashlib

import numpy as np

from idealgas.log.reader import Log


def column_digests(log: Log) -> dict[str, str]:
    """Return the SHA-256 of each event column by name, computed from the little-endian bytes of its values."""
    hashes = {name: hashlib.sha256() for name in log.columns}
    for block in log.chunks(log.columns):
        for name in hashes:
            hashes[name].update(_little_endian(getattr(block, name)))
    return {name: column.hexdigest() for name, column in hashes.items()}


def digest(log: Log) -> str:
    """Return the digest of a log.

    It is the SHA-256 of the list of the digests of all event columns and all arrays of the final state, in order of
    their names.

    Raises:
        LogError: if the log has no events and was not closed.
    """
    state = log.state_at(log.end_time)._asdict()
    arrays = {f"end_{name}": np.asarray(values) for name, values in state.items() if values is not None}
    parts = column_digests(log) | {name: hashlib.sha256(_little_endian(a)).hexdigest() for name, a in arrays.items()}
    return hashlib.sha256("".join(f"{name} {parts[name]}\n" for name in sorted(parts)).encode()).hexdigest()


def _little_endian(values: np.ndarray) -> bytes:
    return values.astype(values.dtype.newbyteorder("<")).tobytes()
