"""Logs for the tests of analyses."""

from functools import partial

import pytest
from helpers.logs import log_of
from helpers.small_gases import LANES


@pytest.fixture(scope="module")
def make(request):
    """Make the log of the module's GAS with overrides."""
    return partial(log_of, request.module.GAS)


@pytest.fixture(scope="module")
def log(make):
    """The log of the module's GAS."""
    return make()


@pytest.fixture
def lanes(uncompiled):
    """The log of two discs that meet nothing but walls."""
    return log_of(LANES)
