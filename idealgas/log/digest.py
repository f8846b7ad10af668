"""Digests of logs, which depend only on the events and the final state.

They do not depend on compression, the time of writing or the number of threads.
"""

import hashlib

import numpy as np

from idealgas.log.reader import Log


def column_digests(log: Log) -> dict[str, str]:
    """Return the SHA-256 of each event column, by name, computed from the little-endian bytes of the values."""
    hashes = {name: hashlib.sha256() for name in log.columns}
    for block in log.chunks(log.columns):
        for name in hashes:
            hashes[name].update(_little_endian(getattr(block, name)))
    return {name: column.hexdigest() for name, column in hashes.items()}


def digest(log: Log) -> str:
    """Return the digest of a log.

    It is the SHA-256 of a list of digests, one for each event column and each array of the final state, sorted by name.

    Raises:
        LogError: if the log has no events and was not closed.
    """
    state = log.state_at(log.end_time)._asdict()
    arrays = {f"end_{name}": np.asarray(values) for name, values in state.items() if values is not None}
    parts = column_digests(log) | {name: hashlib.sha256(_little_endian(a)).hexdigest() for name, a in arrays.items()}
    return hashlib.sha256("".join(f"{name} {parts[name]}\n" for name in sorted(parts)).encode()).hexdigest()


def _little_endian(values: np.ndarray) -> bytes:
    return values.astype(values.dtype.newbyteorder("<")).tobytes()
