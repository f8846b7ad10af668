"""Account of the energy of a gas: its parts, where it comes from and where it is lost."""

import numpy as np

from idealgas.log import Log
from idealgas.physics.piston import piston_energy

PISTON, HEAT_BATH, STEPS = "piston", "the heat bath", "changes in time"
"""Names of the wall that is the piston and of a heat bath among the sources of energy."""

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
    piston = log.scene.piston
    if piston and piston.mass:  # its energy is a part of the energy, so that it gives none from outside
        own = [wall.name for wall in log.walls].index(piston.wall)
        counted[own], unpaid = False, unpaid + lost[:, 1 + own]
        pull = piston.acceleration(log.box, log.scene.properties.acceleration, time)
        place, velocity = observed["piston_position"], observed["piston_velocity"]
        parts["piston"] = piston_energy(piston.mass, place, velocity, pull)
    bath, steps = (observed.get(name, np.zeros(len(given))) for name in ("bath_energy", "step_energy"))
    from_outside = given[:, counted].sum(axis=1) + bath + steps
    total = sum(parts.values()) + unpaid - from_outside
    scale = max(float(np.abs(series).max(initial=0.0)) for series in (*parts.values(), from_outside, unpaid))
    walls = [PISTON if piston and wall.name == piston.wall else wall.name for wall in log.walls]
    sources = dict(zip(walls, given.T, strict=False)) | {HEAT_BATH: bath, STEPS: steps}
    by_source = {name: series for name, series in sources.items() if series.any()}
    sinks = zip(("discs", *walls), lost.T, strict=True)
    losses = {name: series for name, series in sinks if np.abs(series).max(initial=0.0) > ROUNDING * scale}
    return parts, by_source, losses, (total - total[0]) / (scale or 1.0)
