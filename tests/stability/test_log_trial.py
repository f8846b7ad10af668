"""Files that crash HDF5 or keep it busy for ever: commands try them in a process of their own first."""

import os
import signal

import pytest
from log_fuzz.headers import spoil
from log_fuzz.sound import unpacked
from support import idealgas

from idealgas.errors import UserError
from idealgas.log.trial import try_reading

ENDLESS, GREEDY = "HDF5 does not come to an end", "HDF5 asks for more than 1,073,741,824 bytes"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "command", "what"), [(80, "resume", ENDLESS), (113, "resume", GREEDY), (113, "info", GREEDY)]
)
def test_refused(case, command, what, tmp_path):
    """Changed headers of the log of a killed writer."""
    path = tmp_path / "run.h5"
    spoil(case, path, {"killed": unpacked("killed")}, ("killed",))
    before = path.read_bytes()
    done = idealgas(command, "run.h5", folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith(f"run.h5: damaged: {what}")
    assert path.read_bytes() == before


def test_sound_logs_pass(tmp_path):
    for name in ("plain", "killed"):
        path = tmp_path / f"{name}.h5"
        path.write_bytes(unpacked(name))
        try_reading(path)
    try_reading(tmp_path / "none.h5")  # is said by the command


def test_a_crash_is_said(tmp_path, monkeypatch):
    path = tmp_path / "run.h5"
    path.write_bytes(unpacked("plain"))
    monkeypatch.setattr("idealgas.log.trial.layout_of", lambda dataset: os.kill(os.getpid(), signal.SIGSEGV))
    with pytest.raises(UserError, match=r"run.h5: damaged: HDF5 crashes in reading it \(SIGSEGV\)"):
        try_reading(path)
