"""What machine code tells the processor and the compiler: which memory comes next, and what is seldom."""

import pytest
from fresh_python import python

pytestmark = pytest.mark.slow

NEAR = """
from idealgas.jit import njit
from idealgas.prefetch import fetch_next_line

@njit
def near(column, row):
    fetch_next_line(column, row)
"""
NEAR_THE_END = """
import numpy as np
from idealgas.prefetch import fetch_next_line
from module import near
for column in (np.arange(3.0), np.ones((3, 2)), np.zeros(3, np.uint8)):
    before = column.copy()
    assert fetch_next_line(column, 2) is None and near(column, np.uintp(2)) is None
    assert (column == before).all()
print(*(code.count("call void @llvm.prefetch") for code in near.inspect_llvm().values()))
"""


def test_memory_behind_an_array_is_asked_for_and_left_alone(tmp_path):
    """Its last row has no line behind it; in Python nothing is asked for."""
    (tmp_path / "module.py").write_text(NEAR)
    assert python(NEAR_THE_END, tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")) == "1 1 1"


SELDOM = """
from idealgas._expect import seldom
from idealgas.jit import njit

@njit
def number(column):
    found = 0
    for k in range(column.shape[0]):
        if seldom(column[k] > 1.5):
            found += 1
    return found
"""
EITHER_WAY = """
import numpy as np
from idealgas._expect import seldom
from module import number
assert [number(np.array(column)) for column in ([0.0, 1.0], [2.0, 3.0], [0.0, 2.0])] == [0, 2, 1]
assert seldom(True) is True and seldom(False) is False
print(*(code.count("@llvm.expect.i1(i1") for code in number.inspect_llvm().values()))
"""


def test_what_is_said_to_be_seldom_may_be_true_or_false(tmp_path):
    """LLVM has taken note of it: nothing is left to be called."""
    (tmp_path / "module.py").write_text(SELDOM)
    assert python(EITHER_WAY, tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")) == "0"
