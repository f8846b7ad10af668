"""What machine code depends on: a digest changes with all that a function is made of, and with nothing else."""

from types import ModuleType

import numpy as np
import pytest

from idealgas.jit.dependencies import Part, digest, names_of, reached

pytestmark = pytest.mark.interpreted


def module(source, name="made"):
    """Make a module from its source."""
    made = ModuleType(name)
    exec(source, vars(made))
    return made


def part(source, name="made"):
    """Return the function f of a module as a part."""
    return Part(module(source, name).f)


IMPORTS = "import enum, math\nimport numpy as np\nfrom typing import NamedTuple\n"
CHANGES = {
    "instructions": ("def f(x): return x + x", "def f(x): return x * x"),
    "constant": ("def f(x): return x + 1", "def f(x): return x + 2"),
    "type of a constant": ("def f(x): return x + 1", "def f(x): return x + 1.0"),
    "sign of zero": ("def f(x): return x + 0.0", "def f(x): return x + -0.0"),
    "last bit": ("def f(x): return x + 0.1", "def f(x): return x + 0.10000000000000002"),
    "bool for a number": ("K = 1\ndef f(x): return x + K", "K = True\ndef f(x): return x + K"),
    "string": ("def f(x): return x == 'a'", "def f(x): return x == 'b'"),
    "string of a lambda": ("f = lambda: 'a'", "f = lambda: 'b'"),
    "name of an attribute": ("def f(x): return x.a", "def f(x): return x.b"),
    "default": ("def f(x, y=1): return x + y", "def f(x, y=2): return x + y"),
    "default by name": ("def f(x, *, y=1): return x + y", "def f(x, *, y=2): return x + y"),
    "global number": ("K = 1.5\ndef f(x): return x + K", "K = 2.5\ndef f(x): return x + K"),
    "global tuple": ("K = (1, (2, 3))\ndef f(x): return K", "K = (1, (2, 4))\ndef f(x): return K"),
    "number of numpy": ("K = np.uint64(5)\ndef f(x): return K", "K = np.int64(5)\ndef f(x): return K"),
    "data type": (
        "K = np.dtype([('x', 'f8')])\ndef f(x): return K",
        "K = np.dtype([('x', 'f4')])\ndef f(x): return K",
    ),
    "alignment": (
        "K = np.dtype([('x', 'i1'), ('y', 'i1')])\ndef f(x): return K",
        "K = np.dtype([('x', 'i1'), ('y', 'i1')], align=True)\ndef f(x): return K",
    ),
    "global dictionary": ("K = {'a': 1}\ndef f(x): return K", "K = {'a': 2}\ndef f(x): return K"),
    "function of a library": ("g = math.sin\ndef f(x): return g(x)", "g = math.cos\ndef f(x): return g(x)"),
    "other class of numpy": ("U = np.uint64\ndef f(x): return U(x)", "U = np.int64\ndef f(x): return U(x)"),
    "name hides what is built in": ("def f(x): return abs(x)", "abs = math.sin\ndef f(x): return abs(x)"),
    "value of a member": (
        "class E(enum.IntEnum): A = 1\ndef f(x): return x == E.A",
        "class E(enum.IntEnum): A = 2\ndef f(x): return x == E.A",
    ),
    "order of fields": (
        "class T(NamedTuple):\n a: int\n b: int\ndef f(x): return T(x, 1)",
        "class T(NamedTuple):\n b: int\n a: int\ndef f(x): return T(x, 1)",
    ),
    "default of a field": (
        "class T(NamedTuple):\n a: int = 1\ndef f(x): return T()",
        "class T(NamedTuple):\n a: int = 2\ndef f(x): return T()",
    ),
    "method": (
        "class C:\n def m(self): return 1\ndef f(x): return C",
        "class C:\n def m(self): return 2\ndef f(x): return C",
    ),
    "method of a base": (
        "class B:\n def m(self): return 1\nclass C(B): pass\ndef f(x): return C",
        "class B:\n def m(self): return 2\nclass C(B): pass\ndef f(x): return C",
    ),
    "attribute of a class": ("class C: K = 1\ndef f(x): return C.K", "class C: K = 2\ndef f(x): return C.K"),
    "inner function": ("def f(x): return (lambda: 1)()", "def f(x): return (lambda: 2)()"),
    "global of an inner function": (
        "K = 1\ndef f(x): return (lambda: K)()",
        "K = 2\ndef f(x): return (lambda: K)()",
    ),
    "closure": (
        "def make(k):\n def f(x): return x + k\n return f\nf = make(1)",
        "def make(k):\n def f(x): return x + k\n return f\nf = make(2)",
    ),
    "function in a closure": (
        "def make(k):\n def f(x): return k(x)\n return f\nf = make(lambda x: 1)",
        "def make(k):\n def f(x): return k(x)\n return f\nf = make(lambda x: 2)",
    ),
    "function that is no part": (
        "def g(x): return 1\ndef f(x): return g(x)",
        "def g(x): return 2\ndef f(x): return g(x)",
    ),
    "function behind another": (
        "def h(x): return 1\ndef g(x): return h(x)\ndef f(x): return g(x)",
        "def h(x): return 2\ndef g(x): return h(x)\ndef f(x): return g(x)",
    ),
    "which of two": (
        "g, h = (lambda x: 1), (lambda x: 2)\ndef f(x): return g(x) - h(x)",
        "h, g = (lambda x: 1), (lambda x: 2)\ndef f(x): return g(x) - h(x)",
    ),
    "function that calls itself": (
        "def g(x): return g(x - 1) if x else 1\ndef f(x): return g(x)",
        "def g(x): return g(x - 1) if x else 2\ndef f(x): return g(x)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
def test_a_digest_changes_with(change):
    before, after = (part(IMPORTS + source).digest for source in CHANGES[change])
    assert before != after
    assert before == part(IMPORTS + CHANGES[change][0]).digest


@pytest.mark.parametrize(
    "after",
    [
        "K = 2\n\n\n# why\ndef f(x):\n    'Doc.'\n    return x + K",
        "K = 2\ndef f(x):\n    'Other text.'\n    return x + K  # why",
        "K = 2\ndef f(x):\n    'Doc.'\n    return (\n        x\n        + K\n    )",
        "K = 2\nL = 3\ndef other(): return L\ndef f(x):\n    'Doc.'\n    return x + K",
        "class Table:\n    'Doc.'\n    K = 5\nK = 1 + 1\ndef f(x):\n    'Doc.'\n    return x + K",
    ],
    ids=["comment", "docstring", "lines", "other names", "class beside it"],
)
def test_a_digest_does_not_change_with(after):
    assert part("K = 2\ndef f(x):\n    'Doc.'\n    return x + K").digest == part(after).digest


def test_options_of_the_compiler_and_what_is_used_of_a_module_count():
    """Of modules of numpy, numba and Python the version counts, which is in the name of the cache folder."""

    def using(k, unused):
        made = module("def f(x): return x + constants.K")
        made.constants = module(f"K, L = {k}, {unused}", "constants")
        return Part(made.f)

    assert using(1, 1).digest == using(1, 2).digest != using(2, 1).digest
    assert vars(names_of(using(1, 1).py_func)[0]["constants"])["K"] == 1
    function = module("def f(x): return x").f
    assert Part(function, forceinline=True).digest != Part(function, forceinline=False).digest


@pytest.mark.parametrize("value", [np.zeros(3), object(), iter(())], ids=["array", "object", "iterator"])
def test_a_value_of_which_nothing_is_known_is_refused(value):
    """Its content could change unseen."""
    made = module("def f(x): return K")
    made.K = value
    with pytest.raises(TypeError, match="compiled code cannot use"):
        _ = Part(made.f).digest


def test_it_counts_which_of_two_closures_is_used():
    """They have the same module and name."""
    made = module(
        "def make(k):\n    def f(x): return k\n    return f\ng, h = make(1), make(2)\ndef f(x): return g(x)", "closures"
    )
    for function in (made.g, made.h):
        Part(function).is_named(function)
    before = Part(made.f).digest
    made.g, made.h = made.h, made.g
    assert Part(made.f).digest != before


LAWS = """
def law(x): return 2 * x
def absent(x): return 3 * x
def helper(x): return 4 * x
def target(x): return 1 * x
def choose(x): return lambda x: helper(x)
def caller(x): return law(x) + absent(x)
def user(x): return target(x)
class Number: pass
def declare(): return 1
def maker(x): return Number()
"""


@pytest.fixture
def laws():
    """A module of its own name with parts: `target` is what `choose` chooses for, `declare` belongs to the module."""
    name = f"laws{np.random.default_rng().integers(1 << 62)}"
    made = module(LAWS, name)
    for function in ("law", "absent", "helper", "target", "caller", "user", "maker"):
        Part(getattr(made, function)).is_named(getattr(made, function))
    Part(made.choose, f"{name}.target", chooses=True)
    return made


def names(keys):
    return {key.partition(".")[2] for key in keys}


def test_functions_count_that_were_compiled_and_all_that_a_choice_mentions(laws):
    """Not those that a function only mentions: code for absent effects is not compiled."""
    assert names(reached([f"{laws.__name__}.caller", f"{laws.__name__}.law"])) == {"caller", "law"}
    assert names(reached([f"{laws.__name__}.user"])) == {"user", "target", "helper"}


def test_declarations_count_with_the_module_they_are_in(laws):
    """Such as a type of numbers, with its operators: compiled code gets it from functions or classes of its module."""
    before = reached([f"{laws.__name__}.maker"])
    Part(laws.declare, laws.__name__, chooses=True)
    assert reached([f"{laws.__name__}.maker"]) - before == {laws.__name__}
    other = module("def f(): return Number()", "elsewhere")
    other.Number = laws.Number
    assert laws.__name__ in reached([Part(other.f).key])


def test_a_digest_of_a_key_covers_all_with_that_key(laws):
    key = f"{laws.__name__}.target"
    before = digest(key)
    Part(laws.declare, key, chooses=True)
    assert digest(key) != before
    assert digest("nothing.of.this.name") != before
