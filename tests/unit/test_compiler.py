"""What numba is made to leave out: optimization and machine code of functions that only compiled code calls."""

import gc
import operator
import re
from types import SimpleNamespace

import pytest
from numba.core.caching import NullCache
from numba.core.compiler import DefaultPassBuilder, Flags
from numba.core.typing import Context

from idealgas._compiler import _STEPS, _EntryPoint, _Part, _Typing
from idealgas._jit import inline, njit, out_of_line


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


@out_of_line
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
    assert {step.__name__ for step in steps} - {step.__name__ for step in _STEPS} == LEFT_OUT
    rest = iter(steps)
    assert all(step in rest for step in _STEPS)  # in the same order


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
    for kind in (_EntryPoint, _Part):
        finish = kind._finalize_final_module
        monkeypatch.setattr(
            kind, "_finalize_final_module", lambda self, finish=finish: (made.append(self.name), finish(self))
        )

    @compiled
    def entry(x):
        return _below(x) + _long(x)

    assert entry(3.0) == 8.0
    assert made == [entry.py_func.__qualname__]


def test_errors_of_an_inlined_function_arrive():
    assert _refusing(2.0) == 2.0
    with pytest.raises(ValueError, match="below zero"):
        _refusing(-1.0)


def test_a_part_is_compiled_once_for_types_whatever_the_literals(monkeypatch):
    compiled_parts = []
    finish = _Part.finalize
    monkeypatch.setattr(_Part, "finalize", lambda self: (compiled_parts.append(self.name), finish(self)))

    @out_of_line
    def product(x, factor):
        return x * factor

    @compiled
    def entry(x):
        return product(x, 2) + product(x, 3) + product(x, factor=4)

    assert entry(1.5) == 13.5
    assert len([name for name in compiled_parts if "product" in name]) == 1


def test_what_calls_of_numba_give_is_asked_for_once(monkeypatch):
    """Both sums are of two floats."""
    asked = []
    resolve = Context.resolve_function_type
    monkeypatch.setattr(
        Context, "resolve_function_type", lambda self, *call: (asked.append(call[0]), resolve(self, *call))[1]
    )
    monkeypatch.setattr(_Typing, "_known", {})

    @compiled
    def entry(x, y):
        return (x + y) * (y + x)

    assert entry(1.0, 2.0) == 9.0
    assert [function.typing_key for function in asked] == [operator.add, operator.mul]


@pytest.mark.parametrize("collects", [True, False])
def test_garbage_is_collected_again_afterwards(collects, monkeypatch):
    during = []
    step = _STEPS[0]
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
