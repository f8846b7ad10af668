"""Wrong texts: scenes, commands, names, and the summary, which is JSON."""

import h5py
import numpy as np
from numpy.random import Generator

from helpers.crafted import swap
from helpers.log_fuzz.editor import Change, Editor, Effect, broken, some

ESCAPE = "\x1b[31;1mred\x1b]0;title\x07"
ODD = (
    ESCAPE,
    "[/red][bold]",
    "$x^$ \\frac{",
    "</script><script>alert(1)</script>",
    "\x00\x01\x7f",
    "\u202egnirts",
    "a\nb",
)
"""Texts that have a meaning to a terminal, rich, mathtext or a browser."""
WRONG = b"\xff\xfe\x80\xc3"


def rewrite(editor: Editor, path: str, texts: list[bytes]) -> None:
    """The texts of a dataset, with as many bytes each as the longest needs."""
    size = max([editor.file[path].dtype.itemsize, *map(len, texts)])
    swap(path, data=np.array(texts, h5py.string_dtype("utf-8", size)))(editor.file)


def texts_in(editor: Editor, path: str) -> list[bytes]:
    return editor.values(path).tolist()


def odd_text(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, ["discs/species_name", "walls/name", "runs/command"])
    texts = texts_in(editor, path)
    texts[random.integers(len(texts))] = some(random, [*ODD]).encode()
    rewrite(editor, path, texts)
    return Effect(f"an odd text in {path}")


def wrong_text(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, ["discs/species_name", "walls/name", "runs/command", "runs/scene", "summary/name"])
    texts = texts_in(editor, path)
    if not texts:
        return None
    place = int(random.integers(len(texts)))
    texts[place] = WRONG + texts[place][4:]
    rewrite(editor, path, texts)
    return broken("not UTF-8:", path)


def long_text(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, ["runs/scene", "runs/command", "discs/species_name", "walls/name"])
    texts = texts_in(editor, path)
    texts[-1] += b"\n#" + b" long" * (2 ** int(random.integers(16, 20)))
    rewrite(editor, path, texts)
    return broken("a long text in", path) if path.endswith("name") else Effect(f"a long text in {path}")


def scene(editor: Editor, random: Generator) -> Effect | None:
    texts = texts_in(editor, "runs/scene")
    text = texts[-1]
    ways = {
        "empty": b"",
        "not TOML": b"[[[",
        "half": text[: len(text) // 2] + b"\n[",
        "an unknown table": text + b"\n[warp]\nfactor = 9\n",
        "no box": text.replace(b"[box]", b"[cube]"),
        "deep": b"a = " + b"[" * 5000 + b"]" * 5000,
        "a huge number": text.replace(b"count = ", b"count = 999999999999999999999"),
        "nan": text.replace(b"size = [", b"size = [nan, "),
        "binary": bytes(range(1, 32)),
    }
    way = some(random, [way for way in ways if ways[way] != text])
    texts[-1] = ways[way]
    rewrite(editor, "runs/scene", texts)
    return broken(f"{way}:", "runs/scene")


def title(editor: Editor, random: Generator) -> Effect | None:
    texts = texts_in(editor, "runs/scene")
    odd = some(random, [*ODD]).encode("unicode_escape").replace(b"\\x", b"\\u00").replace(b'"', b"'")
    lines = [line for line in texts[-1].split(b"\n") if not line.startswith(b"title")]
    texts[-1] = b"\n".join(lines).replace(b"[scene]", b'[scene]\ntitle = "' + odd + b'"')
    rewrite(editor, "runs/scene", texts)
    return Effect("an odd title")


def summary(editor: Editor, random: Generator) -> Effect | None:
    if not editor.rows["summary"]:
        return None
    names, values = texts_in(editor, "summary/name"), texts_in(editor, "summary/value")
    place = int(random.integers(len(names)))
    if random.random() < 0.3:
        names[place] = some(random, [b"", b"end_time", b"events", ESCAPE.encode(), b"x"])
        rewrite(editor, "summary/name", names)
        return Effect("another name in the summary")
    not_json = [b"{", b"nul", b"NaN", b"Infinity", b"1e999", WRONG]
    value = some(random, [*not_json, b'"text"', b"[1, 2]", b"{}", b"-1", b"null", b"true"])
    values[place] = value
    rewrite(editor, "summary/value", values)
    what = f"{names[place].decode()} = {value!r} in"
    return broken(what, "summary/value") if value in not_json else Effect(f"{what} the summary")


CHANGES: tuple[Change, ...] = (odd_text, odd_text, wrong_text, long_text, scene, title, summary, summary)
"""Each is drawn as often as it is listed."""
