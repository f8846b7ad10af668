"""Command `idealgas digest`: digest of a log; comparison of the example scenes with their digests on record."""

import json

import click

from idealgas.errors import UserError, unknown
from idealgas.examples import names, path_of

from ._options import FILE
from ._scenes import DIGESTS
from ._terminal import data


@click.command(epilog="Example: idealgas digest gas.h5")
@click.argument("arguments", type=FILE, nargs=-1, metavar="RUN.h5 | --check [SCENE...]")
@click.option("--check", is_flag=True, help="Run example scenes (all by default) and compare with digests.json.")
@click.pass_context
def digest(context: click.Context, arguments: tuple[str, ...], check: bool) -> None:
    """Print the SHA-256 digest of the events and the final state of a log.

    Equal scenes give equal digests on every machine, with any number of threads and any compression. --check runs each
    scene for at most 20 000 events; the exit code is 1 if a digest differs.
    """
    if not check:
        if len(arguments) != 1:
            raise UserError("digest: one RUN.h5 is needed, or --check")
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
        found = scene_digest(path_of(f"{name}.toml"))
        same &= found == recorded.get(name)
        data(f"{name}: {'same' if found == recorded.get(name) else 'differs'} {found}")
    if not same:
        context.exit(1)
