"""Changes of what a log has as text: scenes, commands, names, and the summary, which is JSON."""

import h5py
import numpy as np
from numpy.random import Generator

from log_fuzz.editor import Editor
from log_fuzz.effect import Effect, broken, orderly
from log_fuzz.values import Change, some

ESCAPE = "\x1b[31;1mred\x1b]0;title\x07"
ODD = (ESCAPE, "[/red][bold]", "$x^$ \\frac{", "</script><script>alert(1)</script>", "\x00\x01\x7f", "‮gnirts", "a\nb")
"""Texts that mean something to a terminal, rich, mathtext or a browser."""
WRONG = b"\xff\xfe\x80\xc3"


def _rewrite(editor: Editor, path: str, texts: list[bytes]) -> None:
    size = max([1, *map(len, texts)])
    kind = h5py.string_dtype("utf-8", max(size, editor.file[path].dtype.itemsize))
    editor.remake(path, np.array(texts, kind), dtype=kind)


def odd_name(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, ["discs/species_name", "walls/name", "runs/command"])
    assert path is not None
    names = editor.values(path).tolist()
    names[random.integers(len(names))] = ODD[random.integers(len(ODD))].encode()
    _rewrite(editor, path, names)
    return orderly(f"an odd text in {path}")


def wrong_text(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, ["discs/species_name", "walls/name", "runs/command", "runs/scene", "summary/name"])
    assert path is not None
    texts = editor.values(path).tolist()
    if not texts:
        return None
    place = int(random.integers(len(texts)))
    texts[place] = WRONG + texts[place][4:]
    _rewrite(editor, path, texts)
    return broken("not UTF-8:", path)


def long_text(editor: Editor, random: Generator) -> Effect | None:
    """A text without end: a megabyte, or four."""
    path = some(random, ["runs/scene", "runs/command", "discs/species_name", "walls/name"])
    assert path is not None
    texts = editor.values(path).tolist()
    texts[-1] = texts[-1] + b"\n#" + b" long" * (2 ** int(random.integers(16, 20)))
    _rewrite(editor, path, texts)
    return broken("a long text in", path) if path.endswith("name") else orderly(f"a long text in {path}")


def scene_text(editor: Editor, random: Generator) -> Effect | None:
    texts = editor.values("runs/scene").tolist()
    scene = texts[-1]
    ways = {
        "empty": b"",
        "no TOML": b"[[[",
        "half": scene[: len(scene) // 2] + b"\n[",
        "an unknown table": scene + b"\n[warp]\nfactor = 9\n",
        "no box": scene.replace(b"[box]", b"[cube]"),
        "deep": b"a = " + b"[" * 5000 + b"]" * 5000,
        "a huge number": scene.replace(b"count = ", b"count = 999999999999999999999"),
        "nan": scene.replace(b"size = [", b"size = [nan, "),
        "binary": bytes(range(1, 32)),
    }
    way = list(ways)[random.integers(len(ways))]
    if ways[way] == scene:
        return None
    texts[-1] = ways[way]
    _rewrite(editor, "runs/scene", texts)
    return broken(f"{way}:", "runs/scene")


def scene_title(editor: Editor, random: Generator) -> Effect | None:
    texts = editor.values("runs/scene").tolist()
    odd = ODD[random.integers(len(ODD))].encode("unicode_escape").replace(b"\\x", b"\\u00").replace(b'"', b"'")
    lines = [line for line in texts[-1].split(b"\n") if not line.startswith(b"title")]
    texts[-1] = b"\n".join(lines).replace(b"[scene]", b'[scene]\ntitle = "' + odd + b'"')
    _rewrite(editor, "runs/scene", texts)
    return orderly("an odd title")


def summary(editor: Editor, random: Generator) -> Effect | None:
    if not editor.rows["summary"]:
        return None
    names, values = editor.values("summary/name").tolist(), editor.values("summary/value").tolist()
    wrong = (b"{", b"nul", b"NaN", b"Infinity", b'"text"', b"[1, 2]", b"{}", b"1e999", b"-1", b"null", WRONG, b"true")
    value = wrong[random.integers(len(wrong))]
    place = int(random.integers(len(names)))
    values[place] = value
    _rewrite(editor, "summary/value", values)
    if value in (b"{", b"nul", WRONG, b"NaN", b"Infinity", b"1e999"):
        return broken(f"{value!r} in", "summary/value")
    return orderly(f"{names[place].decode()} = {value!r} in the summary")


def summary_names(editor: Editor, random: Generator) -> Effect | None:
    if not editor.rows["summary"]:
        return None
    names = editor.values("summary/name").tolist()
    names[random.integers(len(names))] = (b"", b"end_time", b"events", ESCAPE.encode(), b"x")[random.integers(5)]
    _rewrite(editor, "summary/name", names)
    return orderly("another name in the summary")


CHANGES: tuple[Change, ...] = (
    odd_name,
    odd_name,
    wrong_text,
    long_text,
    scene_text,
    scene_title,
    summary,
    summary,
    summary_names,
)
"""Each is drawn as often as it stands here."""
