"""On which line of a TOML text each key stands; `tomllib` does not say."""

import re
import tomllib
from bisect import bisect_left

from idealgas.toml.error import Key

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = re.compile(r"""[A-Za-z0-9_-]+|"(?:[^"\\]|\\.)*"|'[^']*'""")
_VALUE = re.compile(r'''"""(?:[^\\]|\\.)*?"{3,5}|\'{3}.*?\'{3,5}|"(?:[^"\\]|\\.)*"|'[^']*'|[^,\[\]{}#\n]+''', re.DOTALL)


def key_lines(text: str) -> dict[Key, int]:
    """Line of every table, key and array element of a text that `tomllib` accepts."""
    return _Scanner(text).lines


class _Scanner:
    """Walks over valid TOML; what values mean is left to `tomllib`."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0
        self.newlines = [match.start() for match in re.finditer("\n", text)]
        self.lines: dict[Key, int] = {}
        self.tables: dict[Key, int] = {}  # arrays of tables, and the index of the latest of each
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
        found = self.text.startswith(token, self.position)
        self.position += len(token) * found
        return found

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
        """Path of a table, with the index of the latest one after each array of tables."""
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
