"""Crafted logs with correct checksums: each is refused with one line that names the fault."""

import os
import re
import shutil
import struct
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.crafted import craft, link, opened, put, read_path, refused, seal, swap
from helpers.log_samples import write_log
from helpers.needs import posix
from isal import isal_zlib

from idealgas.log import DamageError, LogError, LogWriter, open_log, recover
from idealgas.log.hdf5.commit import Commit
from idealgas.log.hdf5.superblock import lookup3
from idealgas.log.recovery import open_after

STOP = 300


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return write_log(tmp_path_factory.mktemp("log") / "sound.h5", STOP)


@pytest.fixture
def path(sound, tmp_path):
    return shutil.copyfile(sound, tmp_path / "run.h5")


def test_a_log_that_was_only_sealed_is_read(path):
    read_path(craft(path, lambda file: None))
    read_path(craft(path, put("discs/mass", 3, 2.5)))
    read_path(craft(path, put("events/velocity", (7, 1), 0.25)))


def bomb(name, chunk=0, size=2**26):
    """A chunk that would become far larger than it is declared."""

    def edit(file):
        dataset = file[name].id
        packed = isal_zlib.compress(bytes(size), 1)
        dataset.write_direct_chunk((chunk,) + (0,) * (dataset.rank - 1), packed, 1 | 4)

    return edit


def unknown_filter(file):
    del file["discs/radius"]
    layout = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    layout.set_chunk((25,))
    layout.set_filter(32001, h5py.h5z.FLAG_OPTIONAL)
    space, kind = h5py.h5s.create_simple((25,)), h5py.h5t.IEEE_F64LE
    h5py.h5d.create(file["discs"].id, b"radius", kind, space, layout)


def a_group(file):
    del file["discs/radius"]
    file.create_group("discs/radius")


def a_type(file):
    del file["discs/radius"]
    file["discs/radius"] = np.dtype("f8")


def attribute(of, name, value, **options):
    return lambda file: file[of].attrs.create(name, value, **options)


TEXTS, REFERENCES = h5py.string_dtype(), h5py.ref_dtype
STRUCTURE = {
    "external link": (link("discs/radius", h5py.ExternalLink("o.h5", "/x")), "discs/radius: object 'x' doesn't exist"),
    "soft circle": (link("discs/radius", h5py.SoftLink("/discs/radius")), "discs/radius: "),
    "other filter": (swap("discs/radius", compression="lzf", shuffle=False), "discs/radius: filters 32000, 3"),
    "unknown filter": (unknown_filter, "discs/radius: filters 32001"),
    "no checksum": (swap("discs/radius", fletcher32=False), r"discs/radius: filters 2, 1 \(allowed"),
    "not in chunks": (link("discs/radius", np.ones(25)), "discs/radius: not in chunks"),
    "group": (a_group, "discs/radius: not a dataset"),
    "type": (a_type, "discs/radius: not a dataset"),
    "missing": (lambda file: file.__delitem__("discs/radius"), "discs/radius: missing"),
    "table missing": (lambda file: file.__delitem__("events/partner"), "events/partner: missing"),
    "record missing": (lambda file: file.__delitem__("commit"), "missing"),
    "texts": (link("discs/species_name", np.array(["a", "b"], TEXTS)), "discs/species_name: not in chunks"),
    "references": (
        swap("discs/radius", data=None, shape=(25,), dtype=REFERENCES),
        "discs/radius: unsupported type",
    ),
    "compound": (swap("discs/radius", data=np.zeros(25, "f8,f8")), "discs/radius: unsupported type"),
    "big-endian": (swap("discs/radius", data=np.ones(25, ">f8")), "discs/radius: unsupported type"),
    "bomb": (bomb("discs/radius", size=2**26), "discs/radius: a compressed chunk: does not end at 200 bytes"),
    "bomb among events": (bomb("events/velocity"), "events/velocity from row 0: a compressed chunk: does not end"),
    "attribute of text": (attribute("box", "boundary", ["none"] * 2, dtype=TEXTS), "box: attribute boundary: invalid"),
    "attribute missing": (lambda file: file["box"].attrs.__delitem__("boundary"), "box: .*boundary"),
    "format 0": (attribute("/", "format_version", 0), "has format 0; this version of idealgas reads format 1"),
    "format 1 and 1": (attribute("/", "format_version", [1, 1]), "attribute format_version: not a single text"),
    "seeds": (attribute("/", "seed", np.array([b"1", b"2"])), "seed: not a single text"),
    "seed nan": (attribute("/", "seed", np.nan), "seed: not a single text or integer"),
    "not UTF-8": (attribute("/", "created", np.bytes_(b"\xff")), "/: attribute created: not UTF-8 text"),
    "record too narrow": (attribute("commit", "datasets", np.array([b"events/time"])), "not a record of 1 datasets"),
}  # fmt: skip


@pytest.mark.parametrize("case", STRUCTURE)
def test_structure(path, case):
    edit, expected = STRUCTURE[case]
    craft(path, edit)
    message = refused(path)
    assert message.startswith(("damaged: ", "has format"))
    assert re.search(expected, message), message


@pytest.mark.parametrize(
    "names", [5, np.bytes_(b"events/time"), np.arange(3), np.array([[b"a"]]), h5py.Empty("S8"), "text"], ids=repr
)
def test_a_record_without_a_list_of_datasets(path, names):
    with opened(path) as file:
        file["commit"].attrs.create("datasets", names)
    assert "commit: attribute datasets: not a list of texts" in refused(path)


def test_damage_that_hdf5_finds_as_it_closes(path):
    """In the header of the heap of a group's links, whose checksum is made right."""
    data = bytearray(path.read_bytes())
    first = data.index(b"FRHP")
    end = next(
        k for k in range(first + 60, len(data)) if lookup3(data[first:k]) == int.from_bytes(data[k : k + 4], "little")
    )
    data[first + 24] ^= 255
    data[end : end + 4] = lookup3(data[first:end]).to_bytes(4, "little")
    path.write_bytes(data)
    assert refused(path)


def test_damage_is_no_failure_to_write(path):
    """Damage that is found only once the log is opened for appending, as it was sound when it was read."""
    with open_log(path) as log:
        rows, data, result = log.commit.rows, path.read_bytes(), 0
    for place in range(0, 20_000, 97):
        path.write_bytes(data[:place] + bytes([data[place] ^ 255]) + data[place + 1 :])
        try:
            open_after(path, rows)[0].close()
        except DamageError:
            result += 1
    assert result >= 20


def test_a_block_half_written(path):
    """The second half of a block of an index is that of before, as after a power failure."""
    data = path.read_bytes()
    blocks = [result.start() for result in re.finditer(b"EA[HI][DB]|FA[HD][DB]|OHDR", data)]
    lines = []
    for place in blocks:
        path.write_bytes(data[: place + 16] + bytes(8) + data[place + 24 :])
        try:
            read_path(path)
        except LogError as error:
            lines.append(str(error))
    assert sum("checksum of an HDF5 block does not match (half written in" in line for line in lines) > 10


def test_a_chunk_beyond_the_end_of_the_file(path):
    """In the log of a killed writer, whose end HDF5 does not know; the commit record is of a shorter file."""
    with h5py.File(path, "r+", libver=("v110", "v110")) as file:
        place = file["events/velocity"].id.get_chunk_info(0).byte_offset
        seal(file, Commit.read(file)._replace(file_size=0))
    head = bytearray(path.read_bytes()[:44])
    head[11] = 5
    with path.open("r+b") as raw:
        raw.write(head + struct.pack("<I", lookup3(bytes(head))))
        raw.truncate(place)
    assert "events/velocity from row 0: " in refused(path)
    assert "beyond the end of the file" in refused(path)


def fifo(path):
    os.mkfifo(path)
    return path


@posix
def test_what_is_not_a_regular_file(tmp_path):
    for odd in (fifo(tmp_path / "fifo"), tmp_path / "link", Path("/dev/null"), Path("/dev/zero")):
        if odd.name == "link":
            odd.symlink_to(tmp_path / "fifo")
        for use in (open_log, recover, LogWriter.resume):
            with pytest.raises(LogError, match=f"^{odd}: cannot be read: not a regular file$"):
                use(odd)
