"""What numba is made to leave out: optimization and machine code of functions that only compiled code calls."""

import gc
import operator
import re
from types import SimpleNamespace
from typing import NamedTuple

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba.core import types
from numba.core.caching import NullCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import DefaultPassBuilder, Flags
from numba.core.typing import Context
from numba.extending import intrinsic

from idealgas._compiler.code import EntryPoint, Part
from idealgas._compiler.contexts import Typing
from idealgas._compiler.steps import STEPS
from idealgas.jit import inline, njit, noinline


def compiled(function):
    """An entry point that is compiled in every run of the tests: what is kept on disk cannot be looked at."""
    entry = njit(function)
    entry._cache = NullCache()
    return entry


@inline
def _deepest(x):
    return x / 3.0


@inline
def _below(x):
    return _deepest(x) + 1.0


@noinline
def _long(x):
    return _below(x) * 3.0


@compiled
def _shared(x):
    return _deepest(x) - 1.0


@compiled
def _entry(x):
    return _deepest(x) + 2.0 * _below(x) + _shared(x)  # inlined directly, through another, and through an entry point


@inline
def _refuse(x):
    if x < 0.0:
        raise ValueError("below zero")
    return x


@compiled
def _refusing(x):
    return _refuse(x)


LEFT_OUT = {
    "AnnotateTypes",
    "DumpParforDiagnostics",
    "FindLiterallyCalls",
    "IRLegalization",
    "InlineClosureLikes",
    "InlineInlinables",
    "InlineOverloads",
    "IRProcessing",
    "LiteralPropagationSubPipelinePass",
    "LiteralUnroll",
    "MakeFunctionToJitFunction",
    "NopythonRewrites",
    "WithLifting",
}


def test_the_steps_are_those_of_numba_without_some():
    """Another numba may have another step, of which it is then to be said whether it is needed here."""
    flags = Flags()
    flags.enable_ssa = True
    steps = [
        step
        for step, _ in DefaultPassBuilder.define_nopython_pipeline(SimpleNamespace(func_ir=None, flags=flags)).passes
    ]
    assert {step.__name__ for step in steps} - {step.__name__ for step in STEPS} == LEFT_OUT
    rest = iter(steps)
    assert all((step if step in steps else step.__base__) in rest for step in STEPS)  # in the same order


def _code(entry):
    return entry.inspect_llvm(entry.signatures[0])


def _functions(text):
    return set(re.findall(r"^define .*? @\"?([\w.$]+)", text, re.MULTILINE))


def test_inlined_functions_are_in_each_caller_and_nowhere_else():
    assert _entry(6.0) == 6.0 / 3.0 + 2.0 * (6.0 / 3.0 + 1.0) + (6.0 / 3.0 - 1.0)
    defined = _functions(_code(_entry))
    assert not [name for name in defined if "_deepest" in name or "_below" in name]
    called = re.findall(r"call .*?@\"?([\w.$]+)", _code(_entry))
    assert not [name for name in called if "_deepest" in name or "_below" in name]


def test_a_part_has_no_machine_code_of_its_own(monkeypatch):
    made = []
    for kind in (EntryPoint, Part):
        finish = kind._finalize_final_module
        monkeypatch.setattr(
            kind, "_finalize_final_module", lambda self, finish=finish: (made.append(self.name), finish(self))
        )

    @compiled
    def entry(x):
        return _below(x) + _long(x)

    assert entry(3.0) == 8.0
    assert made == [entry.py_func.__qualname__]


def test_what_typing_has_just_brought_is_known_to_lowering():
    """As the code of an intrinsic is, which nothing had called before."""

    @intrinsic
    def half(typingctx, x):
        return types.float64(types.float64), lambda context, builder, signature, arguments: builder.fmul(
            arguments[0], arguments[0].type(0.5)
        )

    @inline
    def calls(x):
        return half(x)

    @compiled
    def entry(x):
        return calls(x) + 1.0

    assert entry(3.0) == 2.5


def test_errors_of_an_inlined_function_arrive():
    assert _refusing(2.0) == 2.0
    with pytest.raises(ValueError, match="below zero"):
        _refusing(-1.0)


def test_a_part_is_compiled_once_for_types_whatever_the_literals(monkeypatch):
    compiled_parts = []
    finish = Part.finalize
    monkeypatch.setattr(Part, "finalize", lambda self: (compiled_parts.append(self.name), finish(self)))

    @noinline
    def product(x, factor):
        return x * factor

    @compiled
    def entry(x):
        return product(x, 2) + product(x, 3) + product(x, factor=4)

    assert entry(1.5) == 13.5
    assert len([name for name in compiled_parts if "product" in name]) == 1


def test_a_part_is_compiled_once_for_all_integers_of_at_most_64_bits(monkeypatch):
    """Each keeps its value, the largest too; those of 64 bits without a sign have a part of their own."""
    compiled_parts = []
    finish = Part.finalize
    monkeypatch.setattr(Part, "finalize", lambda self: (compiled_parts.append(self.name), finish(self)))

    @noinline
    def itself(k):
        return k

    @compiled
    def entry(signed, unsigned, flag):
        return itself(signed[0]), itself(unsigned[0]), itself(k=np.int64(-5)), flag and itself(7) == 7

    largest = np.iinfo(np.uint32).max
    assert entry(np.array([-3], np.int32), np.array([largest], np.uint32), True) == (-3, largest, -5, True)
    assert len([name for name in compiled_parts if "itself" in name]) == 1

    @compiled
    def beyond(unsigned):
        return itself(unsigned[0])

    assert beyond(np.array([2**63 + 5], np.uint64)) == 2**63 + 5
    assert len([name for name in compiled_parts if "itself" in name]) == 2


def test_what_calls_of_numba_give_is_asked_for_once(monkeypatch):
    """Both sums are of two floats."""
    asked = []
    resolve = Context.resolve_function_type
    monkeypatch.setattr(
        Context, "resolve_function_type", lambda self, *call: (asked.append(call[0]), resolve(self, *call))[1]
    )
    monkeypatch.setattr(Typing, "_known", {})

    @compiled
    def entry(x, y):
        return (x + y) * (y + x)

    assert entry(1.0, 2.0) == 9.0
    assert [function.typing_key for function in asked] == [operator.add, operator.mul]


@pytest.fixture
def modules(monkeypatch):
    """Intermediate code of all functions that are compiled meanwhile, as numba writes it."""
    texts = []
    add = JITCodeLibrary.add_ir_module
    monkeypatch.setattr(
        JITCodeLibrary, "add_ir_module", lambda self, module: (texts.append(str(module)), add(self, module))[1]
    )
    return texts


class _Inner(NamedTuple):
    numbers: np.ndarray
    scale: float


class _Outer(NamedTuple):
    inner: _Inner
    absent: None
    offsets: np.ndarray


@inline
def _element(outer, k):
    return outer.inner.numbers[k] * outer.inner.scale + outer.offsets[0]


@noinline
def _total(outer, first):
    total = 0.0
    for k in range(first, outer.inner.numbers.shape[0]):
        total += _element(outer, k)
    return total


def _outer():
    return _Outer(_Inner(np.arange(5.0), 0.5), None, np.array([100.0, 7.0]))


def test_named_tuples_are_passed_whole(modules):
    """However many arrays they hold; numba passes the seven numbers of each array."""

    @compiled
    def entry(outer):
        return _total(outer, 2)

    assert entry(_outer()) == 0.5 * (2 + 3 + 4) + 3 * 100.0
    declared = [line for line in "\n".join(modules).splitlines() if re.match(r"(define|declare) .*_total", line)]
    assert len(declared) == 2  # where it is called, and where it is made
    for line in declared:
        assert re.findall(r'"arg\.([\w.]+)"', line) == ["outer", "first"]


def test_numba_itself_passes_named_tuples_as_ever():
    @numba.njit
    def of_numba(outer):
        return outer.inner.scale + outer.offsets[1]

    @compiled
    def entry(outer):
        return _total(outer, 0)

    assert of_numba(_outer()) == 7.5
    assert entry(_outer()) == 0.5 * 10 + 5 * 100.0
    assert numba.njit(lambda outer: of_numba(outer) + 1.0)(_outer()) == 8.5


def test_what_is_set_once_takes_no_place_in_memory(modules):
    @compiled
    def entry(x, n):
        once = x * 3.0
        total = 0.0
        for k in range(n):
            within = once + k
            if within > 4.0:
                total += within
        return total + once

    assert entry(1.0, 4) == 3.0 + (5.0 + 6.0)
    places = {name for name in re.findall(r'%"([\w.]+)" = alloca', "\n".join(modules)) if name[0].isalpha()}
    assert {name.split(".")[0] for name in places} & {"once", "within", "x", "n"} == set()
    assert any(name.startswith("total") for name in places)  # set in several places


@njit
def _branches(x, n, early):
    """Ways on which a variable is set later than it is used, at one of two places, or not at all."""
    seen = 0.0
    for k in range(n):
        if k == early:
            late = x + k
        if k > early:
            seen += late  # set in an earlier round
        if seen > 50.0:
            result = -seen
            break
    else:
        result = seen
    before = result
    while result > 10.0:
        half = 0.5 * result
        result = half if half > x else half - 1.0
    return result + before * x


@given(st.floats(0.0, 20.0), st.integers(0, 12), st.integers(0, 12))
def test_branches_and_loops_give_what_python_gives(x, n, early):
    assert _branches(x, n, early) == getattr(_branches, "py_func", _branches)(x, n, early)


@pytest.mark.parametrize("collects", [True, False])
def test_garbage_is_collected_again_afterwards(collects, monkeypatch):
    during = []
    step = STEPS[0]
    monkeypatch.setattr(
        step, "run_pass", lambda self, state, run=step.run_pass: (during.append(gc.isenabled()), run(self, state))[1]
    )

    @compiled
    def entry(x):
        return _below(x)

    (gc.enable if collects else gc.disable)()
    try:
        assert entry(3.0) == 2.0
        assert gc.isenabled() is collects
    finally:
        gc.enable()
    assert during
    assert not any(during)
