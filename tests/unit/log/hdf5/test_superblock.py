"""The superblock of HDF5 files: checksum, file consistency flags and locks."""

import h5py
import pytest

from idealgas.log.hdf5.superblock import clear_consistency_flags, has_consistency_flags, lookup3


def is_marked(path):
    return has_consistency_flags(path.read_bytes())


def clear(path):
    with path.open("r+b") as file:
        clear_consistency_flags(file.fileno())


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "some.h5"
    with h5py.File(path, "w", libver=("v110", "v110")) as file:
        file["x"] = [1.0]
    return path


def test_checksums_are_those_of_hdf5_and_of_their_author(file):
    block = file.read_bytes()[:48]
    assert lookup3(block[:44]) == int.from_bytes(block[44:], "little")
    assert lookup3(b"Four score and seven years ago") == 0x17770551


def test_a_mark_is_seen_and_cleared(file):
    assert is_marked(file) is False
    block = bytearray(file.read_bytes())
    block[11] = 5
    block[44:48] = lookup3(bytes(block[:44])).to_bytes(4, "little")
    file.write_bytes(block)
    assert is_marked(file) is True
    with pytest.raises(OSError, match="already open for write"):
        h5py.File(file)
    clear(file)
    assert is_marked(file) is False
    with h5py.File(file) as opened:
        assert opened["x"][0] == 1.0


def test_a_damaged_superblock_is_left_alone(file):
    block = bytearray(file.read_bytes())
    block[11], block[30] = 5, block[30] ^ 1
    file.write_bytes(block)
    with pytest.raises(ValueError, match="checksum"):
        clear(file)
    assert file.read_bytes() == block


@pytest.mark.parametrize("content", [b"", b"\x89HDF\r\n\x1a\n", b"x" * 1000], ids=["empty", "short", "other"])
def test_other_files_are_no_hdf5(tmp_path, content):
    (tmp_path / "some.h5").write_bytes(content)
    assert is_marked(tmp_path / "some.h5") is None
