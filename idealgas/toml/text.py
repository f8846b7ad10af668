"""Read TOML files, and determine the line number of each key, which `tomllib` does not report."""

import os
import re
import tomllib
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any

from idealgas.files import HEAD, describe_file_type
from idealgas.system import STDIN
from idealgas.toml.issues import Issue, Key, SceneError

MOST_BYTES, MOST_TEXT = 2_000_000, 8_000_000
"""Largest sizes of a TOML file, in bytes, and of a TOML text, in characters; a text may also contain all defaults."""

MOST_LINES = 20
"""Largest number of mistakes in a document that are reported individually."""

MOST_PARTS = 32
"""Largest number of parts in a dotted key. A scene needs 4; the parsing time grows with the square of the number."""

_DOTTED = re.compile(rf"""(?<![\w"'.-])(?:(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{MOST_PARTS}}}""")


def read_text(path: str | PathLike[str]) -> str:
    """Return the text of a TOML file. Raises SceneError if it cannot be read."""
    try:
        with open(os.dup(0) if str(path) == STDIN and not Path(STDIN).exists() else path, "rb") as file:
            raw = file.read(MOST_BYTES + 1)
        if len(raw) <= MOST_BYTES or b"\0" in raw[:HEAD]:
            return raw.decode()
    except UnicodeDecodeError as error:
        if b"\0" in raw[:HEAD]:
            raise SceneError([f"{path}: not TOML text, but {describe_file_type(raw[:HEAD])}"]) from None
        line = raw.count(b"\n", 0, error.start) + 1
        raise SceneError([f"{path}:{line}: not UTF-8 text (got byte 0x{raw[error.start]:02x})"]) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([f"{path}: cannot be read ({reason})"]) from None
    allowed = f"<= {MOST_BYTES:,} bytes; for many discs use [start] file"
    raise SceneError([f"{path}: too large (got more; allowed {allowed})"])


def parse_document(text: str, name: str) -> dict[str, Any]:
    """Return the values of a TOML text. Raises SceneError if it is not TOML, or too large to be parsed in seconds."""
    if len(text) > MOST_TEXT:
        raise SceneError([f"{name}: too long (got {len(text):,} characters; allowed <= {MOST_TEXT:,})"])
    if dotted := _DOTTED.search(text):
        line = text.count("\n", 0, dotted.start()) + 1
        raise SceneError([f"{name}:{line}: a key with too many parts (got {MOST_PARTS} dots; allowed fewer)"])
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise SceneError([f"{name}: not TOML: nested too deeply"]) from None
    except ValueError as error:
        what, line = str(error), text.count("\n") + 1
        if match := re.fullmatch(r"(.*) \(at line (\d+), column \d+\)", what, re.DOTALL):
            what, line = match[1], int(match[2])
        raise SceneError([f"{name}:{line}: not TOML: {what}"]) from None


_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = re.compile(r"""[A-Za-z0-9_-]+|"(?:[^"\\]|\\.)*"|'[^']*'""")
_VALUE = re.compile(r'''"""(?:[^\\]|\\.)*?"{3,5}|\'{3}.*?\'{3,5}|"(?:[^"\\]|\\.)*"|'[^']*'|[^,\[\]{}#\n]+''', re.DOTALL)


def key_lines(text: str) -> dict[Key, int]:
    """Return the line number of every table, key and array element of a valid TOML text."""
    return _Scanner(text).lines


class _Scanner:
    """Scanner that records the line of every key of a valid TOML text and skips the values."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0
        self.newlines = [match.start() for match in re.finditer("\n", text)]
        self.lines: dict[Key, int] = {}
        self.tables: dict[Key, int] = {}  # index of the latest table in each array of tables
        table: Key = ()
        while self.skip_blank() < len(text):
            if self.take("[["):
                *above, name = self.key()
                array = (*self.current(above), name)
                index = self.tables[array] = self.tables.get(array, -1) + 1
                table = (*array, index)
                self.mark(table)
                self.take("]]")
            elif self.take("["):
                table = self.current(self.key())
                self.mark(table)
                self.take("]")
            else:
                self.pair(table)

    def skip_blank(self) -> int:
        if match := _BLANK.match(self.text, self.position):
            self.position = match.end()
        return self.position

    def take(self, token: str) -> bool:
        self.skip_blank()
        is_next = self.text.startswith(token, self.position)
        self.position += len(token) * is_next
        return is_next

    def match(self, pattern: re.Pattern[str]) -> str:
        self.skip_blank()
        match = pattern.match(self.text, self.position)
        assert match, "tomllib accepted this text"
        self.position = match.end()
        return match.group()

    def mark(self, key: Key) -> None:
        line = bisect_left(self.newlines, self.position) + 1
        for length in range(1, len(key) + 1):
            self.lines.setdefault(key[:length], line)

    def key(self) -> list[str]:
        parts: list[str] = []
        while not parts or self.take("."):
            part = self.match(_KEY)
            parts.append(tomllib.loads(f"key = {part}")["key"] if part[0] in "\"'" else part)
        return parts

    def current(self, names: list[str]) -> Key:
        """Return the path of a table, in which the name of each array is followed by the index of its latest table."""
        path: Key = ()
        for name in names:
            path = (*path, name)
            if path in self.tables:
                path = (*path, self.tables[path])
        return path

    def pair(self, table: Key) -> None:
        key = (*table, *self.key())
        self.mark(key)
        self.take("=")
        self.value(key)

    def value(self, key: Key) -> None:
        if self.take("{"):
            while not self.take("}"):
                self.pair(key)
                self.take(",")
        elif self.take("["):
            index = 0
            while not self.take("]"):
                self.mark((*key, index))
                self.value((*key, index))
                self.take(",")
                index += 1
        else:
            self.match(_VALUE)


@dataclass
class TextOrigin:
    """The text and file from which a document was read.

    All origins compare equal, so that they do not affect the comparison of scenes.

    Attributes:
        text: TOML text.
        name: name of the file.
        overridden: overrides as the user wrote them, by the key that they set.
        above: key of the table in the text that contains the scene; empty if the text is the scene.
        names: names of tables in arrays, by key.
    """

    text: str = field(default="", compare=False)
    name: str = field(default="", compare=False)
    overridden: Mapping[Key, str] = field(default_factory=dict, compare=False)
    above: Key = field(default=(), compare=False)
    names: Mapping[Key, str] = field(default_factory=dict, compare=False)

    @property
    def folder(self) -> Path:
        """Folder of the file; paths in the document are relative to it."""
        return Path(self.name).parent

    def report(self, issues: Sequence[Issue]) -> list[str]:
        """Return a line for each issue, in the order of the file; issues caused by overrides come last.

        If there are more than MOST_LINES lines, the last line states how many more issues there are.
        """
        lines: dict[str, tuple[bool, int]] = {}
        for issue in issues:
            blamed = next((o for key in issue.keys if (o := self._override(key)) is not None), None)
            line = self.line(issue.keys[0])
            place = f"{blamed}: " if blamed is not None else f"{self.name}:{line}: " if self.name else ""
            lines.setdefault(f"{place}{issue.line(self.names)}", (blamed is not None, line))
        texts = sorted(lines, key=lambda text: lines[text])
        more = [f"… and {len(texts) - MOST_LINES:,} more mistakes"] if len(texts) > MOST_LINES else []
        return [*texts[:MOST_LINES], *more]

    def _override(self, key: Key) -> str | None:
        """Return the override that caused an issue with a key; None if the text of the file did.

        This is an override that sets the key itself, or any key of a table that contains it but is not in the text.
        """
        tables = [key[:n] for n in range(1, len(key) + 1)]
        absent = [table for table in tables if (*self.above, *table) not in self._lines][:1]
        set_by = self.overridden.items()
        exact = (place for k, place in set_by if key[: len(k)] == k)
        around = (place for k, place in set_by for table in absent if k[: len(table)] == table)
        return next(chain(exact, around), None)

    def line(self, key: Key) -> int:
        """Return the line number of a key, or of the innermost table that contains it; otherwise 1."""
        key = (*self.above, *key)
        return next((self._lines[key[:n]] for n in range(len(key), 0, -1) if key[:n] in self._lines), 1)

    @cached_property
    def _lines(self) -> dict[Key, int]:
        return key_lines(self.text)
