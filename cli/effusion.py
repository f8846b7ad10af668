"""`idealgas effusion`: how fast does a gas leave through a slit?"""

from typing import TYPE_CHECKING

import click

from ._analysis import analysis_options, open_log, print_estimates, print_json

if TYPE_CHECKING:
    from idealgas.analysis.effusion.measure import Effusion


@click.command()
@click.argument("paths", metavar="RUN.h5|DIR...", nargs=-1, required=True)
@analysis_options
def effusion(paths: tuple[str, ...], start: float | None, end: float | None, plot: str | None, as_json: bool) -> None:
    """Measure the flow through a gate that opens, and compare it with n⟨v⟩/π.

    A folder is that of a sweep with the analysis "effusion"; runs that differ in their seeds alone are put together.
    """
    import os

    from idealgas.analysis.core.statistics import mean_of_replicates
    from idealgas.analysis.effusion.measure import effusion as measure
    from idealgas.study.sweep.results import effusions

    groups: dict[str, list[Effusion]] = {}
    for path in paths:
        if os.path.isdir(path):
            for name, found in effusions(path):
                groups.setdefault(name, []).append(found)
            continue
        with open_log(path) as log:
            groups[path] = [measure(log, start, end)]
    together = {name: mean_of_replicates([found.speed for found in group]) for name, group in groups.items()}
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.effusion.figure import effusion_figure

        save(effusion_figure(groups, together), plot)
    if as_json:
        print_json({name: estimate.as_dict() for name, estimate in together.items()})
        return
    print_estimates("Flux over density (length/time), theory ⟨v⟩/π", list(together.items()))
