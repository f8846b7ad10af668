"""Programs in a Python of their own."""

import os
import shutil
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


def package_copy(copy, folder, **settings):
    """Copy the package with its commands; returns run(program, ...), which runs Python with the copy in a folder."""
    for source, name in (("idealgas", "idealgas"), ("cli", "idealgas_cli")):
        shutil.copytree(ROOT / source, copy / name, ignore=shutil.ignore_patterns("__pycache__"))

    def run(program, *arguments, code=0, **environment):
        done = subprocess.run(
            [sys.executable, "-c", program, *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(copy)} | settings | environment,
            stdin=subprocess.DEVNULL,
        )
        assert done.returncode == code, done.stderr
        return done.stdout if code == 0 else done.stderr

    return run


COMMAND = "from idealgas_cli.main import main; main()"
"""Program of the command in such a copy."""
