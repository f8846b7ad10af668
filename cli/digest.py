"""Command `idealgas digest`: print the digest of a log, or check the example scenes against recorded digests."""

import json

import click

from idealgas.errors import UserError, unknown
from idealgas.examples import names, path_of

from ._options import FILE
from ._scenes import DIGESTS
from ._terminal import data


@click.command(epilog="Example: idealgas digest gas.h5")
@click.argument("arguments", type=FILE, nargs=-1, metavar="RUN.h5 | --check [SCENE...]")
@click.option("--check", is_flag=True, help="Run example scenes (default: all), and compare digests with digests.json.")
@click.pass_context
def digest(context: click.Context, arguments: tuple[str, ...], check: bool) -> None:
    """Print the SHA-256 digest of the events and the final state of a log.

    Equal scenes have equal digests on every machine, with any number of threads and any compression. With --check, each
    scene is run for at most 20 000 events, and the exit code is 1 if a digest differs.
    """
    if not check:
        if len(arguments) != 1:
            raise UserError("digest: give one RUN.h5, or --check")
        from idealgas.log.digest import digest as digest_of

        from ._analysis import open_log

        with open_log(arguments[0]) as log:
            data(digest_of(log))
        return
    for name in arguments:
        if name not in names():
            raise unknown("example", name, names())
    from idealgas.run.digest import scene_digest

    recorded = json.loads(path_of(DIGESTS).read_text(encoding="utf-8"))
    same = True
    for name in arguments or names():
        computed = scene_digest(path_of(f"{name}.toml"))
        same &= computed == recorded.get(name)
        data(f"{name}: {'same' if computed == recorded.get(name) else 'differs'} {computed}")
    if not same:
        context.exit(1)
