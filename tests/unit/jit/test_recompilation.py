"""After an edit exactly those entry points are compiled again that depend on it, each for the types concerned."""

import json
import shutil

import pytest
from helpers.fresh_python import package_copy, python
from helpers.support import ROOT

SOURCES = {
    "constants.py": """
from enum import IntEnum
SCALE = 2.0
class Kind(IntEnum):
    DISC = 3
""",
    "law.py": '''
from idealgas.engine.constants import SCALE
from idealgas.jit import inline, noinline
@inline
def law(x):
    """Law."""
    return SCALE * x
@noinline
def behind(x):
    return 1.0 * law(x)
''',
    "gravity.py": """
from idealgas.jit import inline
class GravityTable:
    g = 1.0
@inline
def fall(x, g):
    return x - g
""",
    "choice.py": """
from idealgas.jit import inline, overload
def halved(x): return x / 2.0
@inline
def half(x): return 0.5 * x
@overload(halved)
def choose(x): return lambda x: half(x)
""",
    "entry.py": """
from idealgas.engine.choice import halved
from idealgas.engine.constants import Kind
from idealgas.engine.gravity import fall
from idealgas.engine.law import behind
from idealgas.jit import inline, njit
def make(k):
    @inline
    def multiply(x): return k * x
    return multiply
multiply, other = make(10.0), make(0.0)
@inline
def motion(x, g):
    if g is not None: return fall(x, g)
    return x
@njit
def advance(x, g):
    return motion(behind(x), g)
def entries(k):
    @njit
    def entry(x): return k * x
    return entry
twice, thrice = entries(2.0), entries(3.0)
@njit
def analyse(x):
    return multiply(halved(x)) + (3.0 if Kind.DISC == 3 else 4.0)
""",
}
PROGRAM = """
import json
from idealgas.jit import files
compiled, save = [], files.save
def watched(name, signature, *rest):
    compiled.append(f"{name.rpartition('.')[2]} {signature.split()[-1]}")
    save(name, signature, *rest)
files.save = watched
from idealgas.engine.entry import advance, analyse, thrice, twice
assert (twice(1.0), thrice(1.0)) == (2.0, 3.0)  # of one name
print(json.dumps([advance(1.0, None), advance(1.0, 1.5), analyse(1.0), compiled]))
"""
PLAIN, WITH_GRAVITY, ANALYSIS = "advance none", "advance float64", "analyse float64"
EDITS = [
    # what; files, texts and their replacements; results; what is compiled
    (
        "comment, docstring, table of an effect",
        [
            ("law.py", "    return SCALE", "    # why\n    return SCALE"),
            ("law.py", "Law.", "Another law."),
            ("gravity.py", "g = 1.0", "g, h = 2.0, 3.0"),
        ],
        [2, 0.5, 8],
        [],
    ),
    ("law of an effect", [("gravity.py", "x - g", "x - 2.0 * g")], [2, -1, 8], [WITH_GRAVITY]),
    ("constant elsewhere", [("constants.py", "SCALE = 2.0", "SCALE = 3.0")], [3, 0, 8], [PLAIN, WITH_GRAVITY]),
    ("function behind others", [("law.py", "SCALE * x", "SCALE * x + 1.0")], [4, 1, 8], [PLAIN, WITH_GRAVITY]),
    ("function that is chosen", [("choice.py", "0.5 * x", "0.25 * x")], [4, 1, 5.5], [ANALYSIS]),
    ("choice", [("choice.py", "half(x)\n", "0.5 * half(x)\n")], [4, 1, 4.25], [ANALYSIS]),
    ("closure", [("entry.py", "make(10.0)", "make(20.0)")], [4, 1, 5.5], [ANALYSIS]),
    (
        "member of an enumeration, option of the compiler",
        [("constants.py", "DISC = 3", "DISC = 4"), ("law.py", "@noinline", "@inline")],
        [4, 1, 6.5],
        [PLAIN, WITH_GRAVITY, ANALYSIS],
    ),
    ("back to a former version", [("constants.py", "DISC = 4", "DISC = 3")], [4, 1, 5.5], []),
]


def edit(folder, name, text, replacement):
    """Replace a text that stands once in a file."""
    path = folder / name
    source = path.read_text(encoding="utf-8")
    assert source.count(text) == 1
    path.write_text(source.replace(text, replacement), encoding="utf-8")


def test_an_edit_compiles_what_depends_on_it(tmp_path):
    """The results are those of the edited source, and what was compiled before stays on disk."""
    folder = tmp_path / "idealgas"
    (folder / "engine").mkdir(parents=True)
    shutil.copytree(ROOT / "idealgas" / "jit", folder / "jit")
    for name in ("system.py", "errors.py"):
        shutil.copy(ROOT / "idealgas" / name, folder)
    for name, source in {"../__init__.py": "", "__init__.py": "", **SOURCES}.items():
        (folder / "engine" / name).write_text(source)

    def run():
        *results, compiled = json.loads(python(PROGRAM, tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")))
        return results, compiled

    assert run() == ([2, 0.5, 8], ["entry float64", "entry-1 float64", PLAIN, WITH_GRAVITY, ANALYSIS])
    for what, changes, results, compiled in EDITS:
        for name, text, replacement in changes:
            edit(folder / "engine", name, text, replacement)
        assert (what, *run()) == (what, results, compiled)


RUNS = """
import json, sys
import numpy as np
from idealgas.jit import files
compiled, save = [], files.save
def watched(name, *rest):
    compiled.append(name)
    save(name, *rest)
files.save = watched
from idealgas.statistics import autoregression
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene
sets = []
for k, side in enumerate(("", "bottom = {vibrating = {amplitude = 0.2, frequency = 1.3}}")):
    tables = "[[species]]\\nname = 'gas'\\ncount = 4\\nradius = 0.3\\ntemperature = 0.5\\nregion = [0, 0.5, 9, 9]"
    scene = parse_scene(f"run.events = 40\\n[box]\\nsize = [9, 9]\\n{side}\\n{tables}")
    simulate(scene, f"{sys.argv[1]}/{k}.h5", force=True)
    sets.append([name for name in compiled if "engine" in name])
    compiled.clear()
autoregression._go_on(np.full(1, 0.5), np.ones(3))
print(json.dumps([*sets, compiled]))
"""


@pytest.mark.slow
def test_an_edit_of_the_package_compiles_what_depends_on_it(tmp_path):
    """As an edit of a law is tried by its author: only sets of effects that contain it are compiled again.

    With little optimisation, which takes less time.
    """
    run_copy = package_copy(tmp_path / "copy", tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache"), NUMBA_OPT="1")
    folder = tmp_path / "copy" / "idealgas"

    def run():
        return json.loads(run_copy(RUNS, tmp_path, NUMBA_DISABLE_JIT="0"))

    plain, vibrating, analysis = run()
    kernel = "idealgas.statistics.autoregression._go_on"
    assert plain
    assert set(vibrating) <= set(plain)
    assert analysis == [kernel]
    assert run() == [[], [], []]
    edit(folder, "effects/gravity.py", "[gx, gy], length/time²", "[gx, gy] in length/time²")
    edit(folder, "engine/event_driven/kernel.py", "import numpy as np\n", "import numpy as np  # why\n\n\n")
    assert run() == [[], [], []]
    edit(folder, "physics/vibration.py", "MOST_PIECES = 64", "MOST_PIECES = 65")
    assert run() == [[], ["idealgas.engine.event_driven.kernel.advance_events"], []]
    edit(folder, "statistics/autoregression.py", "total = 0.0", "total = 0.0 * p")
    assert run() == [[], [], [kernel]]
