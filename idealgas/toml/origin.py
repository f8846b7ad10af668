"""Where the keys of a scene were written: what turns an issue into a line with file and line number."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain

from idealgas.toml.error import Issue, Key
from idealgas.toml.lines import key_lines


@dataclass
class Origin:
    """A text, its file's name, the places of overrides by the key they set, and the key of the scene in the text.

    All origins are equal, as they are no part of a scene.
    """

    text: str = field(default="", compare=False)
    name: str = field(default="", compare=False)
    overridden: Mapping[Key, str] = field(default_factory=dict, compare=False)
    above: Key = field(default=(), compare=False)

    def report(self, issues: Sequence[Issue]) -> list[str]:
        """One line for each issue, in the order of the file's lines; issues of overrides come last."""
        lines = []
        for issue in issues:
            blamed = next((o for key in issue.keys if (o := self._override(key)) is not None), None)
            line = self.line(issue.keys[0])
            place = f"{blamed}: " if blamed is not None else f"{self.name}:{line}: " if self.name else ""
            lines.append((blamed is not None, line, f"{place}{issue}"))
        return [text for *_, text in sorted(lines, key=lambda item: item[:2])]

    def _override(self, key: Key) -> str | None:
        """Place of the override that sets the key, or something in a table around it that the text does not have."""
        tables = [key[:n] for n in range(1, len(key) + 1)]
        absent = [table for table in tables if (*self.above, *table) not in self._lines][:1]
        set_by = self.overridden.items()
        exact = (place for k, place in set_by if key[: len(k)] == k)
        around = (place for k, place in set_by for table in absent if k[: len(table)] == table)
        return next(chain(exact, around), None)

    def line(self, key: Key) -> int:
        """Line of the key or of the closest table above it; the first line if there is none."""
        key = (*self.above, *key)
        return next((self._lines[key[:n]] for n in range(len(key), 0, -1) if key[:n] in self._lines), 1)

    @cached_property
    def _lines(self) -> dict[Key, int]:
        return key_lines(self.text)
