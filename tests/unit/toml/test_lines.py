import tomllib

import pytest

from idealgas.toml.text import key_lines

HARD = r'''# a comment with [brackets] = "quotes"
top = 1
"quoted.key" = 'C:\path # no comment'
a.b . "c" = true   # a dotted key

[table]   # comment
text = """
[not.a.table]
x = 1
quotes inside: "" and \""" and one more""""
literal = \'\'\'
y = 2
it\'s\'\'\'\'
array = [ 1, # first
  "two, ] and three",
  [ 3, [] ], { in = 4, ner = [
    5] },
]
when = 1979-05-27 07:32:00

[[items]]
n = 1
[[items]]
[items.sub]
n = 2
[[items.sub.deep]]
n = 3
[[ items . sub . deep ]]
n = 4
[ table . below ]
last = "no newline at the end"'''.replace(r"\'", "'")

EXPECTED = {
    ("top",): 2,
    ("quoted.key",): 3,
    ("a",): 4,
    ("a", "b", "c"): 4,
    ("table",): 6,
    ("table", "text"): 7,
    ("table", "literal"): 11,
    ("table", "array"): 14,
    ("table", "array", 0): 14,
    ("table", "array", 1): 15,
    ("table", "array", 2, 0): 16,
    ("table", "array", 3, "in"): 16,
    ("table", "array", 3, "ner", 0): 17,
    ("table", "when"): 19,
    ("items",): 21,
    ("items", 0, "n"): 22,
    ("items", 1): 23,
    ("items", 1, "sub"): 24,
    ("items", 1, "sub", "n"): 25,
    ("items", 1, "sub", "deep", 0, "n"): 27,
    ("items", 1, "sub", "deep", 1): 28,
    ("items", 1, "sub", "deep", 1, "n"): 29,
    ("table", "below", "last"): 31,
}


def keys(node, path=()):
    """Every path of a parsed document."""
    children = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    return {path} | {key for name, child in children for key in keys(child, (*path, name))}


def test_lines_of_a_hard_text():
    lines = key_lines(HARD)
    assert {key: lines.get(key) for key in EXPECTED} == EXPECTED


@pytest.mark.parametrize("text", ["", "# only a comment", HARD, 'x = ""\ny = """"""\nz = \'\'\n', "a = {}\nb = []"])
def test_the_keys_are_those_that_tomllib_finds(text):
    assert set(key_lines(text)) | {()} == keys(tomllib.loads(text))
