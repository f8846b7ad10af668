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
    """Parameter type of paths: the shell completes them, and the commands check them."""

    name = "file"

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Return a completion item that makes the shell complete the path."""
        return [CompletionItem(incomplete, type="file")]


FILE = _File()


def integer(text: str) -> int:
    """Return the integer that a text such as "1000000" or "1e6" represents."""
    with suppress(ValueError):
        return int(text)
    with suppress(ValueError):
        if (number := float(text)).is_integer():
            return int(number)
    raise click.BadParameter(f"{text!r} is not a valid integer.")


def scene_argument(command: Callable) -> Callable:
    """Add the argument `SCENE.toml` as `path` (- is stdin) and the option `--set` as `overrides`, for `load_scene`."""
    path = click.argument(
        "path", type=FILE, metavar="SCENE.toml", callback=lambda _, __, path: STDIN if path == "-" else path
    )
    return path(overrides_option()(command))


def overrides_option(more: str = "") -> Callable:
    """Return a decorator that adds the option `--set` as `overrides`. more: additional help text."""
    return click.option(
        "--set", "overrides", multiple=True, metavar="TABLE.KEY=VALUE", shell_complete=_complete_key,
        help="Change a key of the scene (species.0.count=50, species.argon.count=50); an empty value restores the "
        f"default.{more}",
    )  # fmt: skip


def _complete_key(_: click.Context, __: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return completion items for the scene keys that begin with the incomplete text."""
    return [CompletionItem(f"{key}=", help=text) for key, text in keys().items() if key.startswith(incomplete)]


force_option = click.option("--force", is_flag=True, help="Overwrite existing output of the same command.")

quiet_option = click.option(
    "-q", "--quiet", is_flag=True, expose_value=False, callback=be_quiet,
    help="Print only errors and the output of --json and --csv.",
)  # fmt: skip

json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON instead of tables.")


def _output(kind: str, endings: tuple[str, ...]) -> Callable:
    """Return a callback that checks the extension of an option for the path of a file of this kind."""

    def check(_: click.Context, __: click.Parameter, value: str | None) -> str | None:
        if value is not None and not value.lower().endswith(endings):
            raise UserError(f"{value}: unknown {kind} format (allowed {', '.join(endings)})")
        return value

    return check


plot_option = click.option(
    "--plot", type=FILE, metavar="FILE.png", callback=_output("figure", FIGURE_ENDINGS),
    help="Write a figure (.png, .pdf or .svg).",
)  # fmt: skip

points_option = click.option(
    "--points",
    type=FILE,
    metavar="FILE.csv",
    callback=_output("table", (".csv", ".parquet")),
    help="Write all data points as a table (.csv or .parquet).",
)

plot_errors_option = click.option(
    "--plot-errors", type=FILE, metavar="FILE.png", callback=_output("figure", FIGURE_ENDINGS),
    help="Write a figure of each standard error against the length of the time blocks; slow fluctuations show as a "
    "rise.",
)  # fmt: skip
