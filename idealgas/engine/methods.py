"""The methods by which an engine finds events, and the one place where one of them is chosen."""

from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.monte_carlo import MonteCarlo
from idealgas.engine.multiprecision import PreciseBruteForce
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
    rises: bool = False,
    threads: int | None = 1,
) -> Method:
    """Make a method by its name in a scene; ValueError for an unknown name or a missing parameter.

    precision: number type of `brute_force`. dt: step of `time_driven`, time. v_ref: relative speed at which
    `monte_carlo` accepts a pair of the largest discs for certain, length/time. seed: of its random numbers. one_sided:
    whether its impact parameters have one sign only. rises: whether v_ref is raised where it is too small. threads:
    number of those of `event_driven`, None for as many as are worth it.
    """
    match name:
        case "event_driven":
            return EventDriven(threads=threads)
        case "brute_force":
            return BruteForce() if precision == "float64" else PreciseBruteForce(precision)
        case "time_driven" if dt is not None:
            return TimeDriven(dt)
        case "monte_carlo" if v_ref is not None:
            return MonteCarlo(seed, v_ref, one_sided=one_sided, rises=rises)
    raise ValueError(f"no method {name} with these parameters")
