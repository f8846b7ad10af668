"""Account of the energy of a gas: its parts, where it comes from and where it is lost."""

import numpy as np

from idealgas.analysis.core.chambers import piston_names
from idealgas.log import Log
from idealgas.physics.piston import piston_energy

HEAT_BATH, STEPS = "the heat bath", "changes in time"
"""Names among the sources of energy; pistons have those of `piston_names`."""

ROUNDING = 1e-12
"""Energy that collisions lose, relative to the largest energy, that is rounding."""

Series = dict[str, np.ndarray]


def account(log: Log, time: np.ndarray, observed: Series) -> tuple[Series, Series, Series, np.ndarray]:
    """Parts of the energy, energy from walls and a heat bath, energy lost by kind of collision, and the balance."""
    names = {"motion": "kinetic_energy", "spin": "rotational_energy", "height": "potential_energy"}
    parts = {part: observed[name] for part, name in names.items() if name in observed}
    given = observed.get("wall_energy", np.zeros((len(observed["kinetic_energy"]), 0)))
    lost = observed.get("dissipated_energy", np.zeros((len(given), 1 + len(log.walls))))
    counted, unpaid = np.ones(given.shape[1], bool), lost[:, 0]
    walls = [wall.name for wall in log.walls]
    for k, (piston, name) in enumerate(zip(log.scene.piston, piston_names(log.scene), strict=True)):
        own = walls.index(piston.wall)
        walls[own] = name
        if piston.mass:  # its energy is a part of the energy, so that it gives none from outside
            counted[own], unpaid = False, unpaid + lost[:, 1 + own]
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
