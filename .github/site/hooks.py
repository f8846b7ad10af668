"""Make the pages of the site that come from other files: READMEs, the gallery and the reference of the analyses."""

import posixpath
import re
import tomllib
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
REPOSITORY = PROJECT["urls"].get("Repository", "")
"""Address of the repository, to which the pages link; empty if pyproject.toml does not give it."""

OWN = ".github/site/pages"
"""Folder of the pages that exist only on the site."""

PAGES = {
    "README.md": "index.md",
    "configs/README.md": "scenes.md",
    "idealgas/log/README.md": "log.md",
    "idealgas/run/README.md": "run.md",
    "idealgas/engine/README.md": "engine.md",
    "idealgas/accuracy/README.md": "accuracy.md",
    "idealgas/sweep/README.md": "sweep.md",
    "tests/README.md": "tests.md",
    ".github/CONTRIBUTING.md": "contributing.md",
    ".github/CHANGELOG.md": "changes.md",
    **{
        path.relative_to(ROOT).as_posix(): f"analyses/{path.name.replace('README', 'index')}"
        for path in (ROOT / "idealgas" / "analysis").glob("*.md")
    },
}
"""Page of the site for each file of the repository that becomes a page."""

LINK = re.compile(r"(\[[^]]*\])\(([^):#]+)(#[^)]*)?\)")


def on_files(files: Any, config: Any) -> Any:
    """Add the pages and their pictures to the site."""
    from mkdocs.structure.files import File

    pages: dict[str, str | bytes] = {page: _text(source) for source, page in PAGES.items()}
    for path, content in (pages | _gallery()).items():
        files.append(File.generated(config, path, content=content))
    for picture in sorted((ROOT / ".readme").glob("*")):
        files.append(File.generated(config, f"pictures/{picture.name}", abs_src_path=str(picture)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Insert the analyses into the reference, and redirect links in pages that exist only on the site."""
    if (ROOT / OWN / page.file.src_uri).exists():
        markdown = linked(markdown, f"{OWN}/{page.file.src_uri}", REPOSITORY)
    return markdown.replace("<!-- analyses -->", "\n".join(_analyses()))


def on_post_page(output: str, **_: Any) -> str:
    """Label the search dialog for screen readers."""
    search = 'data-md-component="search" role="dialog"'
    return output.replace(search, f'{search} aria-label="Search"')


def linked(text: str, source: str, repository: str) -> str:
    """Return the text of a page with its links redirected to pages and pictures of the site or to the repository.

    If the address of the repository is empty, files that are not on the site are named but not linked.
    """
    page = PAGES.get(source, posixpath.basename(source))

    def link(match: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(posixpath.dirname(source), match[2]))
        place = PAGES.get(target, target.replace(".readme/", "pictures/").removeprefix(f"{OWN}/"))
        if place != target:
            path = posixpath.relpath(place, posixpath.dirname(page) or ".")
        elif (ROOT / target).exists() and not repository:
            return match[1][1:-1]
        elif (ROOT / target).exists():
            path = f"{repository}/{'tree' if (ROOT / target).is_dir() else 'blob'}/main/{target}"
        else:
            return match[0]
        return f"{match[1]}({path}{match[3] or ''})"

    return LINK.sub(link, text)


def _text(source: str) -> str:
    """Return the text of a page that is made from a file of the repository."""
    return linked((ROOT / source).read_text(encoding="utf-8"), source, REPOSITORY)


def _gallery() -> dict[str, str | bytes]:
    """Return the files of the gallery: its page, with the description and commands of every scene, and the pictures."""
    from idealgas.gallery import ABOUT, SCENES, commands, described, draw

    files: dict[str, str | bytes] = {}
    parts = ["# Gallery", ABOUT]
    for name in SCENES:
        title, description = described(name)
        description = description.replace("<pre ", '<pre style="overflow-x: auto" ')  # the theme does not style it
        parts.append(f"## {title}")
        if (picture := draw(name)) is not None:
            files[f"gallery/{name}.png"] = picture
            parts.append(f"![{title}, at the start](gallery/{name}.png)")
        parts.append(description)
        parts.append("\n".join(("```bash", *commands(name), "```")))
    return files | {"gallery.md": "\n\n".join(parts) + "\n"}


def _analyses() -> Iterator[str]:
    """Yield the lines of the reference for each analysis: its function, and its results with their JSON keys."""
    from idealgas.analysis import registry

    for analysis in registry.analyses():
        yield f"\n### {analysis.key}\n"
        yield f"::: {analysis.measure.__module__}.{analysis.measure.__qualname__}\n    options: {{heading_level: 4}}\n"
        for result in analysis.results:
            yield f"::: {result.__module__}.{result.__qualname__}\n    options: {{heading_level: 4, members: false}}\n"
            yield f"JSON keys: {', '.join(f'`{key}`' for key in _keys(result))}.\n"


def _keys(result: type) -> Iterator[str]:
    """Yield the JSON keys of the fields of a result, except fields whose values are inlined or omitted."""
    from idealgas.fields import INLINE, OMITTED, Key

    for field in fields(result):
        marks = getattr(field.type, "__metadata__", ())
        if not {INLINE, OMITTED} & {mark for mark in marks if not isinstance(mark, Key)}:
            yield next((mark.name for mark in marks if isinstance(mark, Key)), field.name)
