"""Programs in a Python of their own."""

import subprocess
import sys

from helpers.support import ROOT


def start(program, folder, **environment):
    """A fresh Python that finds the modules of a folder first, then this package."""
    environment = {"NUMBA_DISABLE_JIT": "0", "PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT), **environment}
    command = [sys.executable, "-B", "-c", program]  # its own bytecode may be stale when sources change within a second
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, cwd=folder, env=environment, text=True, **pipes)


def python(program, folder, **environment):
    """What a program prints in a fresh Python."""
    process = start(program, folder, **environment)
    output, errors = process.communicate()
    assert (process.returncode, errors) == (0, "")
    return output.strip()
