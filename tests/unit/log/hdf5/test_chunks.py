"""The bytes of chunks against zlib, HDF5 and the definitions."""

import zlib

import h5py
import numpy as np
import pytest
from helpers.log_samples import rows
from hypothesis import given
from hypothesis import strategies as st

from idealgas.log.hdf5 import chunks

SHAPES = [("f8", (1000, 2)), ("f8", (65_536,)), ("u4", (777,)), ("u1", (65_536,)), ("S5", (3,)), ("i4", (1, 1))]


def arrays():
    random = np.random.default_rng(2)
    for dtype, shape in SHAPES:
        yield random.integers(0, 100, shape).astype(dtype)
    yield random.normal(size=(65_536, 2))
    yield np.zeros((65_536, 2))
    yield rows(0, 65_536).position


@given(st.binary(max_size=3000))
def test_fletcher32_is_two_running_sums(data):
    simple = running = 0
    for start in range(0, len(data), 2):
        simple += int.from_bytes(data[start : start + 2].ljust(2, b"\0"), "big")
        running += simple

    def carried(value):
        while value >> 16:
            value = (value & 0xFFFF) + (value >> 16)
        return value

    assert chunks.fletcher32(data) == (carried(running) << 16 | carried(simple)).to_bytes(4, "little")


def test_fletcher32_of_a_chunk_whose_sums_exceed_32_bits():
    assert chunks.fletcher32(b"\xff" * (2**25 + 514)) == b"\xff" * 4


@pytest.mark.parametrize("data", list(arrays()), ids=lambda data: f"{data.dtype}{data.shape}")
def test_chunks_come_back(data):
    encoder = chunks.Encoder()
    stored = encoder.compressed(data).tobytes()
    assert zlib.decompress(stored) == data.reshape(-1).view("u1").reshape(-1, data.itemsize).T.tobytes()
    assert np.array_equal(chunks.decode(stored, chunks.COMPRESSED, data.dtype, data.size), data.reshape(-1))
    assert np.array_equal(
        chunks.decode(encoder.plain(data).tobytes(), chunks.PLAIN, data.dtype, data.size), data.reshape(-1)
    )


@pytest.mark.parametrize("data", list(arrays()), ids=lambda data: f"{data.dtype}{data.shape}")
def test_hdf5_reads_and_checks_both_kinds_of_chunk(tmp_path, data):
    encoder = chunks.Encoder()
    with h5py.File(tmp_path / "chunks.h5", "w") as file:
        made = {"chunks": data.shape, "compression": "gzip", "shuffle": True, "fletcher32": True}
        for name, mask, stored in (
            ("compressed", chunks.COMPRESSED, encoder.compressed(data).tobytes()),
            ("plain", chunks.PLAIN, encoder.plain(data).tobytes()),
        ):
            dataset = file.create_dataset(name, data.shape, data.dtype, **made)
            dataset.id.write_direct_chunk((0,) * data.ndim, stored, mask)
    with h5py.File(tmp_path / "chunks.h5") as file:
        for dataset in file.values():
            assert np.array_equal(dataset[:], data)


def test_numpy_and_compiled_code_encode_alike(monkeypatch):
    for data in arrays():
        encoded = []
        for worth_loading in (-1, 2**60):
            monkeypatch.setattr(chunks, "_WORTH_LOADING", worth_loading)
            encoded.append(chunks.Encoder().compressed(data).tobytes())
        assert encoded[0] == encoded[1]


@pytest.mark.parametrize("mask", [chunks.COMPRESSED, chunks.PLAIN, 0])
def test_what_hdf5_wrote_is_decoded(tmp_path, mask):
    data = rows(0, 500).position
    with h5py.File(tmp_path / "chunks.h5", "w") as file:
        made = {"compression": "gzip", "shuffle": True} if mask != chunks.PLAIN else {}
        dataset = file.create_dataset("x", data=data, chunks=data.shape, fletcher32=mask != chunks.COMPRESSED, **made)
        _, stored = dataset.id.read_direct_chunk((0, 0))
    assert np.array_equal(chunks.decode(stored, mask, data.dtype, data.size), data.reshape(-1))


@pytest.mark.parametrize("kind", ["compressed", "plain"])
def test_a_changed_byte_is_found_or_changes_nothing(kind):
    data = rows(0, 4096).velocity
    stored = getattr(chunks.Encoder(), kind)(data).tobytes()
    mask = chunks.COMPRESSED if kind == "compressed" else chunks.PLAIN
    random = np.random.default_rng(3)
    actual = 0
    for place in random.integers(0, len(stored), 300):
        damaged = bytearray(stored)
        damaged[place] ^= random.integers(1, 256)
        try:
            assert np.array_equal(chunks.decode(bytes(damaged), mask, data.dtype, data.size), data.reshape(-1))
        except ValueError:
            actual += 1
    assert actual > 290
