"""The lists of versions that .ci/lock makes belong to what pyproject.toml asks for."""

import tomllib

import pytest
from helpers.support import ROOT
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NEEDED = [Requirement(text) for text in PROJECT["dependencies"]]
TESTS = [Requirement(text) for text in PROJECT["optional-dependencies"]["test"]]


def versions(name: str) -> dict[str, Version]:
    """Version of each package of a list in .ci."""
    lines = (ROOT / ".ci" / name).read_text(encoding="utf-8").splitlines()
    pairs = (line.split("==") for line in lines if not line.startswith("#"))
    return {canonicalize_name(package): Version(version) for package, version in pairs}


@pytest.mark.parametrize("package", NEEDED, ids=str)
def test_the_oldest_versions_are_the_lower_bounds(package):
    (bound,) = package.specifier
    assert bound.operator == ">="
    assert versions("oldest.txt")[canonicalize_name(package.name)] == Version(bound.version), "run .ci/lock"


@pytest.mark.parametrize("package", [*NEEDED, *TESTS], ids=str)
def test_the_newest_versions_are_allowed(package):
    assert versions("newest.txt")[canonicalize_name(package.name)] in package.specifier, "run .ci/lock"
