"""Words that do not come back: code, messages, scenes and pages use the terms of the field and plain English."""

import re

import pytest
from helpers.support import ROOT

FILES = sorted(
    {
        *(ROOT / "idealgas").rglob("*.py"),
        *(ROOT / "cli").glob("*.py"),
        *(ROOT / "configs").rglob("*.toml"),
        *ROOT.glob("*.md"),
        *(path for folder in (".github", "configs", "idealgas", "tests") for path in (ROOT / folder).rglob("*.md")),
    }
)
"""Code, messages, scenes and pages."""

PATTERNS = {
    r"seldom": "rarely",
    r"foretell\w*|foretold": "predict",
    r"anew": "again",
    r"of before": "previous, older",
    r"in vain": "without success",
    r"for ever": "indefinitely",
    r"to and fro": "back and forth",
    r"as ever": "as before",
    r"go(?:es)? on with": "continue, resume",
    r"(?:is|are) (?:not|no longer) there": "is missing, no longer exists",
    r"exists already": "already exists",
    r"writer died|writer is dead": "was not closed",
    r"hand(?:s|ed)? over": "migrate, pass",
    r"somebody|nobody|whoever": "name the program, the disc or the user",
    r"kick(?:s|ed|ing)?": "thermostat collision",
    r"rival|dances?": "the term, not a simile",
    r"Maxwell and Boltzmann": "Maxwell-Boltzmann",
    r"(?:events|rows|hits|collisions|kicks|bounces|digits|file|row|column|entry|line|core) an? "
    r"(?:disc|law|analysis|effect|row|column|core|second|process|species|point)": "per",
    r"premises?": "caveat, condition",
    r"heat conductivity": "thermal conductivity",
    r"place of the piston": "piston position",
    r"dev\./s\.e\.": "deviation (σ)",
    r"in_words": "format_estimate",
    r"show_names": "disable_mathtext",
    r"kept_momentum": "conserved_momentum",
    r"is there again": "is inserted",
    r"every event on record|events? (?:is|are) on record": "recorded",
    r"kept up against": "constant",
    r"a word of its own|its own for each": "unique",
    r"(?:to get|gets?) \w+(?: \w+)* right to": "accurate to",
    r"neighbours (?:are|can be) told": "found",
    r"way back": "reversal, return",
    r"outer pressure": "external pressure",
    r"the house": "structure",
    r"(?:theory|walls?|pages?|series|which|kernel) (?:tells?|knows?)|tells? nothing|knows? none": "gives, shows, has",
    r"on another day|an earlier version|at the time of writing|this evening": "present tense, no diary",
}
"""Regular expressions of words, and what to write instead."""


@pytest.mark.parametrize("pattern", PATTERNS)
def test_pattern_is_absent(pattern):
    found = []
    for path in FILES:
        text = path.read_text(encoding="utf-8")
        for match in re.finditer(rf"(?<![\w-])(?:{pattern})(?![\w-])".replace(" ", r"[\s#]+"), text):
            line = text.count("\n", 0, match.start()) + 1
            found.append(f"{path.relative_to(ROOT)}:{line}: {match[0]!r}; write: {PATTERNS[pattern]}")
    assert not found, "\n".join(found)


@pytest.mark.parametrize("text", ["It is seldom so.", "collisions a disc", "32 events a\n    disc", "is not there"])
def test_patterns_find_what_they_are_for(text):
    assert any(re.search(pattern.replace(" ", r"[\s#]+"), text) for pattern in PATTERNS)
