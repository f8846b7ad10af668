"""Text of scenes, logs and users as plain text: whatever it has in it, a terminal or a page only shows it."""

import re

_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters but tabs and ends of lines, those that turn the direction of text, and what is no character."""


def plain(text: str) -> str:
    """The text with control characters written out, as in TOML and JSON."""
    return _CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", text)
