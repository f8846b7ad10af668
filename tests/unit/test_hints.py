"""What machine code tells the processor: which memory comes next."""

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
