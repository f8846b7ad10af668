"""Crafted logs with correct checksums: each is refused with one line that names the fault."""

import os
import re
import shutil
import struct
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.crafted import craft, link, put, read_path, refused, seal, swap
from helpers.log_samples import write_log
from isal import isal_zlib

from idealgas.log import LogError, LogWriter, open_log, recover
from idealgas.log.hdf5.commit import Commit
from idealgas.log.hdf5.superblock import lookup3

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


def test_what_is_not_a_regular_file(tmp_path):
    for odd in (fifo(tmp_path / "fifo"), tmp_path / "link", Path("/dev/null"), Path("/dev/zero")):
        if odd.name == "link":
            odd.symlink_to(tmp_path / "fifo")
        for use in (open_log, recover, LogWriter.resume):
            with pytest.raises(LogError, match=f"^{odd}: cannot be read: not a regular file$"):
                use(odd)
