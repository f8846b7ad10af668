"""TOML text from a file, and its plain values."""

import re
import tomllib
from os import PathLike
from pathlib import Path
from typing import Any

from idealgas.files import HEAD, describe_file_type
from idealgas.toml.messages import SceneError


def read_text(path: str | PathLike[str]) -> str:
    """Text of a TOML file. SceneError if there is none."""
    try:
        raw = Path(path).read_bytes()
        return raw.decode()
    except UnicodeDecodeError as error:
        if b"\0" in raw[:HEAD]:
            raise SceneError([f"{path}: not TOML text, but {describe_file_type(raw[:HEAD])}"]) from None
        line = raw.count(b"\n", 0, error.start) + 1
        raise SceneError([f"{path}:{line}: not UTF-8 text (got byte 0x{raw[error.start]:02x})"]) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([f"{path}: cannot be read ({reason})"]) from None


def parse_document(text: str, name: str) -> dict[str, Any]:
    """A TOML text as plain values. SceneError if it is not TOML."""
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise SceneError([f"{name}: not TOML: nested too deeply"]) from None
    except ValueError as error:
        what, line = str(error), text.count("\n") + 1
        if match := re.fullmatch(r"(.*) \(at line (\d+), column \d+\)", what, re.DOTALL):
            what, line = match[1], int(match[2])
        raise SceneError([f"{name}:{line}: not TOML: {what}"]) from None
