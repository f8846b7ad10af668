"""The steps in which numba makes machine code here, of a function's byte code."""

import gc
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from numba.core import ir, typed_passes, untyped_passes
from numba.core.analysis import compute_cfg_from_blocks, compute_use_defs
from numba.core.compiler_machinery import CompilerPass
from numba.core.ir_utils import build_definitions
from numba.core.lowering import Lower
from numba.core.rewrites import rewrite_registry
from numba.core.ssa import reconstruct_ssa


class GenericRewrites(untyped_passes.GenericRewrites):
    """numba's step, without lifetimes of variables."""

    def run_pass(self, state: Any) -> bool:
        """Rewrite whatever there is a rule for, until there is nothing left."""
        blocks = state.func_ir.blocks
        for kind in rewrite_registry.rewrites["before-inference"]:
            rule = kind(state)
            rest = list(blocks.items())
            while rest:
                label, block = rest.pop()
                if rule.match(state.func_ir, block, state.typemap, state.calltypes):
                    blocks[label] = rule.apply()
                    rest.append((label, blocks[label]))
        return True


class ReconstructSSA(untyped_passes.ReconstructSSA):
    """numba's step, without lifetimes of variables."""

    def run_pass(self, state: Any) -> bool:
        """Give each value of a variable a name of its own."""
        state.func_ir = reconstruct_ssa(state.func_ir)
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


class PreLowerStripPhis(typed_passes.PreLowerStripPhis):
    """numba's step, without lifetimes of variables."""

    def run_pass(self, state: Any) -> bool:
        """Set variables of several values where the values come from."""
        state.func_ir = self._strip_phi_nodes(state.func_ir)
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


def set_once(blocks: Mapping[int, ir.Block]) -> set[str]:
    """Names of the variables that are set at one place, which the way to each use of theirs leads through.

    blocks: of a function, by their labels, in whose order they are lowered.
    """
    places: dict[str, list[int]] = defaultdict(list)
    for label, block in blocks.items():
        for assignment in block.find_insts(ir.Assign):
            places[assignment.target.name].append(label)
    users: dict[str, list[int]] = defaultdict(list)
    for label, names in compute_use_defs(blocks).usemap.items():  # of what was not set before in the block
        for name in names:
            users[name].append(label)
    before = compute_cfg_from_blocks(blocks).dominators() if users else {}
    return {
        name
        for name, (place, *others) in places.items()
        if not others and all(place < user and place in before.get(user, ()) for user in users[name])
    }


class _Lower(Lower):
    """numba's lowering, where a variable that is set once is a value wherever it is used, and no place in memory.

    numba does so only for what one block sets and uses.
    """

    def _find_singly_assigned_variable(self) -> None:
        self._singly_assigned_vars = set_once(self.func_ir.blocks)
        self._blk_local_varmap: dict[str, Any] = {}


class NativeLowering(typed_passes.NativeLowering):
    """numba's step, with fewer places in memory."""

    lowering_class = _Lower


STEPS: tuple[type[CompilerPass], ...] = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.DeadBranchPrune,  # what is for absent effects goes
    GenericRewrites,
    untyped_passes.RewriteDynamicRaises,
    ReconstructSSA,
    untyped_passes.DeadBranchPrune,
    typed_passes.NopythonTypeInference,
    PreLowerStripPhis,
    typed_passes.NoPythonSupportedFeatureValidation,
    NativeLowering,
    typed_passes.NoPythonBackend,
)
"""numba's own steps, in its order, some in a form of their own.

Those for closures, array expressions, `with`, literal arguments, unrolled tuples, functions inlined by numba itself,
its threads and its reports are not among them, nor are those that find and mark the end of each variable's life:
without numba's runtime, nothing is released there.
"""

_ANALYSIS = dict.fromkeys(STEPS)
"""What steps may look up of each other: `DeadBranchPrune` does, and uses nothing of it."""


class Pipeline:
    """The steps, one after the other."""

    pipeline_name = "idealgas"
    exec_times = ()  # nothing is timed

    def run(self, state: Any) -> None:
        """Compile a function."""
        with _all_kept():
            for step in STEPS:
                one = step()
                one.analysis = _ANALYSIS
                one.run_pass(state)


@contextmanager
def _all_kept() -> Iterator[None]:
    """Let Python collect no garbage: it would go through all that numba has made, again and again."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()
