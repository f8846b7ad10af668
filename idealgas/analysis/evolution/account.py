"""Energy balance of a gas: terms of the energy, sources and losses."""

import numpy as np

from idealgas.log import Log
from idealgas.physics.piston import piston_energy
from idealgas.tallies.chambers import piston_names

HEAT_BATH, STEPS = "the heat bath", "changes in time"
"""Names of sources of energy other than walls; pistons are named as in `piston_names`."""

ROUNDING = 1e-12
"""Largest energy loss in collisions, relative to the largest energy, that is attributed to rounding errors."""

Series = dict[str, np.ndarray]


def account(log: Log, time: np.ndarray, observed: Series) -> tuple[Series, Series, Series, np.ndarray]:
    """Return the terms of the energy, the energy received by source, the losses by kind of collision, and the balance.

    Args:
        log: log of the run.
        time: (P,), times of the samples.
        observed: (P,), observables at these times, by name.

    Returns:
        parts: (P,), terms of the energy, by name.
        by_source: (P,), energy received since the start, by source.
        losses: (P,), energy lost since the start, by kind of collision.
        balance: (P,), change of the energy that no source or loss explains, relative to the largest term.
    """
    names = {"motion": "kinetic_energy", "spin": "rotational_energy", "height": "potential_energy"}
    parts = {part: observed[name] for part, name in names.items() if name in observed}
    given = observed.get("wall_energy", np.zeros((len(observed["kinetic_energy"]), 0)))
    lost = observed.get("dissipated_energy", np.zeros((len(given), 1 + len(log.walls))))
    counted, unpaid = np.ones(given.shape[1], bool), lost[:, 0]
    walls = [wall.name for wall in log.walls]
    for k, (piston, name) in enumerate(zip(log.scene.piston, piston_names(log.scene), strict=True)):
        number = walls.index(piston.wall)
        walls[number] = name
        if piston.mass:  # its energy is one of the terms, so that it is not a source from outside
            counted[number], unpaid = False, unpaid + lost[:, 1 + number]
            pull = piston.acceleration(log.box, log.scene.properties.acceleration, time)
            place, velocity = (observed[column][:, k] for column in ("piston_position", "piston_velocity"))
            parts[name] = piston_energy(piston.mass, place, velocity, pull)
    bath, steps = (observed.get(name, np.zeros(len(given))) for name in ("bath_energy", "step_energy"))
    from_outside = given[:, counted].sum(axis=1) + bath + steps
    total = sum(parts.values()) + unpaid - from_outside
    scale = max(float(np.abs(series).max(initial=0.0)) for series in (*parts.values(), from_outside, unpaid))
    sources = dict(zip(walls, given.T, strict=False)) | {HEAT_BATH: bath, STEPS: steps}
    by_source = {name: series for name, series in sources.items() if series.any()}
    sinks = zip(("discs", *walls), lost.T, strict=True)
    losses = {name: series for name, series in sinks if np.abs(series).max(initial=0.0) > ROUNDING * scale}
    return parts, by_source, losses, (total - total[0]) / (scale or 1.0)
