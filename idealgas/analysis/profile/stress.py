"""Pressure tensor in strips: the flux of the momentum that discs carry and that collisions transfer."""

import numpy as np

from idealgas.log import Log
from idealgas.statistics.estimates import Estimate, mean, mean_of_flux
from idealgas.tallies.stream import ReadProgress, stream
from idealgas.tallies.stress import PassedOn
from idealgas.theory.conserved import conserved_momentum


def pressure_of_strips(
    log: Log,
    axis: int,
    edges: np.ndarray,
    times: np.ndarray,
    carried: np.ndarray,
    stored: np.ndarray,
    progress: ReadProgress | None,
) -> dict[str, tuple[Estimate, ...]]:
    """Return the components xx, yy and xy of the pressure tensor in strips between edges (K + 1,), energy/length².

    The component xy is the flux, along the axis, of the momentum component perpendicular to the axis. Between walls,
    the component along the axis is the force across a line through the box, divided by the length of the line. Smooth
    walls perpendicular to the axis transfer no tangential momentum. The tangential momentum that has crossed a line is
    then exactly what the gas on one side of the line has lost.

    Args:
        log: log of the gas.
        axis: axis of the strips, 0 for x or 1 for y.
        edges: edges of the strips, length.
        times: (F,), times of the frames.
        carried: (F, K, 3), kinetic contributions of the discs in each frame to xx, yy and xy, times the area of a
            strip, energy.
        stored: (F, K), total momentum, perpendicular to the axis, of the discs below a line, averaged over all lines in
            a strip.
        progress: called as progress(done, total) while the log is read.
    """
    passed_on = PassedOn(axis, edges, log.periodic, log.scene.properties.shear)
    stream(log, times, [passed_on], progress)
    area = float(edges[1] - edges[0]) * log.box[1 - axis]
    rates = passed_on.stress / np.diff(times)[:, None, None]
    pressure = ((carried[1:] + carried[:-1]) / 2 + rates) / area
    strips = range(len(edges) - 1)
    components = {name: tuple(mean(pressure[:, k, c]) for k in strips) for c, name in enumerate(("xx", "yy", "xy"))}
    if not log.periodic[axis] and conserved_momentum(log.scene)[1 - axis]:
        lost = -np.diff(stored, axis=0) / np.diff(times)[:, None] / log.box[1 - axis]
        shear = pressure[..., 2]  # after the loss is subtracted, only the scatter of single instants remains
        components["xy"] = tuple(mean_of_flux(shear[:, k], shear[:, k] - lost[:, k]) for k in strips)
    return components
