"""The methods by which an engine finds events, and the one place where one is chosen."""

from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.monte_carlo import MonteCarlo
from idealgas.engine.precise import PreciseBruteForce
from idealgas.engine.simulation import Method
from idealgas.engine.time_driven import TimeDriven


def make_method(
    name: str,
    *,
    precision: str = "float64",
    dt: float | None = None,
    v_ref: float | None = None,
    seed: int = 0,
    one_sided: bool = False,
) -> Method:
    """A fresh method by its name in a scene.

    precision: of `brute_force`. dt: step of `time_driven`, time. Of `monte_carlo`: v_ref, relative
    speed at which a pair collides for certain, length/time; seed; one_sided, whether impact parameters have one sign.
    ValueError for another name.
    """
    match name:
        case "event_driven":
            return EventDriven()
        case "brute_force":
            return BruteForce() if precision == "float64" else PreciseBruteForce(precision)
        case "time_driven" if dt is not None:
            return TimeDriven(dt)
        case "monte_carlo" if v_ref is not None:
            return MonteCarlo(seed, v_ref, one_sided=one_sided)
    raise ValueError(f"no method {name} with these parameters")
