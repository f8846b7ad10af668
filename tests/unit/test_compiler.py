"""What numba is made to leave out: optimization and machine code of inlined functions."""

import re
from types import SimpleNamespace

import pytest
from numba.core.caching import NullCache
from numba.core.compiler import DefaultPassBuilder, Flags

from idealgas._compiler import _STEPS, _EntryPoint, _Inlined
from idealgas._jit import inline, njit


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


def test_an_inlined_function_has_no_machine_code(monkeypatch):
    made = []
    for kind in (_EntryPoint, _Inlined):
        finish = kind._finalize_final_module
        monkeypatch.setattr(
            kind, "_finalize_final_module", lambda self, finish=finish: (made.append(self.name), finish(self))
        )

    @compiled
    def entry(x):
        return _below(x)

    assert entry(3.0) == 2.0
    assert made == [entry.py_func.__qualname__]


def test_errors_of_an_inlined_function_arrive():
    assert _refusing(2.0) == 2.0
    with pytest.raises(ValueError, match="below zero"):
        _refusing(-1.0)
