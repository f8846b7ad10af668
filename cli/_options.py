"""Arguments and options that several commands share."""

from collections.abc import Callable
from contextlib import suppress

import click
from click.shell_completion import CompletionItem

from idealgas.errors import UserError
from idealgas.system import STDIN

from ._scenes import keys
from ._terminal import be_quiet

FIGURE_ENDINGS = (".png", ".pdf", ".svg")


class _File(click.ParamType):
    """A path, which shells complete and commands check themselves."""

    name = "file"

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Let the shell complete the path."""
        return [CompletionItem(incomplete, type="file")]


FILE = _File()


def integer(text: str) -> int:
    """Return an integer from a text, which may have the form 1e6."""
    with suppress(ValueError):
        return int(text)
    with suppress(ValueError):
        if (number := float(text)).is_integer():
            return int(number)
    raise click.BadParameter(f"{text!r} is not a valid integer.")


def scene_argument(command: Callable) -> Callable:
    """Add the argument `SCENE.toml` as `path` and the option `--set` as `overrides`, for `load_scene`; - is stdin."""
    path = click.argument(
        "path", type=FILE, metavar="SCENE.toml", callback=lambda _, __, path: STDIN if path == "-" else path
    )
    return path(overrides_option()(command))


def overrides_option(more: str = "") -> Callable:
    """Return the option `--set`, as `overrides`. more: additional help text."""
    return click.option(
        "--set", "overrides", multiple=True, metavar="TABLE.KEY=VALUE", shell_complete=_complete_key,
        help="Change a key of the scene (species.0.count=50, species.argon.count=50); an empty value restores the "
        f"default.{more}",
    )  # fmt: skip


def _complete_key(_: click.Context, __: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return the keys of scenes that begin with the incomplete text."""
    return [CompletionItem(f"{key}=", help=text) for key, text in keys().items() if key.startswith(incomplete)]


force_option = click.option("--force", is_flag=True, help="Overwrite existing output of the same command.")

quiet_option = click.option(
    "-q", "--quiet", is_flag=True, expose_value=False, callback=be_quiet,
    help="Print only errors and the output of --json and --csv.",
)  # fmt: skip

json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON instead of tables.")


def _check_ending(_: click.Context, __: click.Parameter, value: str | None) -> str | None:
    if value is not None and not value.lower().endswith(FIGURE_ENDINGS):
        raise UserError(f"{value}: unknown figure format (allowed {', '.join(FIGURE_ENDINGS)})")
    return value


plot_option = click.option(
    "--plot", type=FILE, metavar="FILE.png", callback=_check_ending, help="Write a figure (.png, .pdf or .svg)."
)

plot_errors_option = click.option(
    "--plot-errors", type=FILE, metavar="FILE.png", callback=_check_ending,
    help="Write a figure of each standard error against the length of the blocks of time, which reveals slow "
    "fluctuations.",
)  # fmt: skip
