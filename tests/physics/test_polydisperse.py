"""A gas of discs of all sizes against the theory of mixtures: pressure, rates, speeds, free flights at fixed seeds."""

import math

import pytest
from helpers.against_theory import LEAST_P
from helpers.logs import gas, log_of

from idealgas import histogram
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.transport.measure import transport
from idealgas.theory import hard_discs

SPREAD = 0.2 * math.sqrt(3)
"""Half the width of a uniform distribution of standard deviation 0.2."""


def scene(phi, number=1000, spread=SPREAD, *, run, log=""):
    """A periodic gas of radii from 1 - spread to 1 + spread, alike; with spread None all of them are 1."""
    side = math.sqrt(number * math.pi * 1.04 / phi)
    text = gas(number, 1.0, (side, side), run, periodic="xy", then=log)
    radius = "radius = 1.0" if spread is None else f"radius = {{ uniform = [{1 - spread!r}, {1 + spread!r}] }}"
    return text.replace("radius = 1.0", f"{radius}\nmass = {{ density = 0.3 }}")


@pytest.mark.parametrize("phi", [0.1, 0.3, 0.5])
def test_pressure_is_that_of_the_mixture(phi):
    """Z of Santos, Yuste & López de Haro (1999) within three standard errors, which are below 0.3 %."""
    sums = "log = { events = false, pressure = true, snapshot_every = 2 }"
    result = pressure(log_of(scene(phi, run="events = 600_000", log=sums)))
    assert result.packing_fraction == pytest.approx(phi, rel=1e-6)
    z = result.routes[-1].compressibility_factor
    assert z.standard_error < 0.003 * z.value
    assert abs(z.value - z.theory) < 3 * z.standard_error
    equal = float(hard_discs.compressibility_factor(phi, 1000))
    assert equal - z.value > 3 * z.standard_error  # equal discs of this packing fraction have more


def test_rates_and_distributions_are_those_of_the_mixture():
    """Rates and free paths within three standard errors, KS of speeds and free flights at 0.001."""
    log = log_of("polydisperse", "run.collisions_per_disc=150")
    result = transport(log)
    (rate,), (paths,), (contact,) = result.collision_rates, result.free_paths, result.contacts
    for each in (rate.rate, paths.path, paths.time, paths.speed, contact.value):
        assert each.standard_error < 0.01 * each.value
        assert (
            abs(each.value - each.theory) < 3 * each.standard_error + 0.002 * each.value
        )  # contact values are so good
    for quantity in ("speed", "vx", "energy", "free-path", "free-time"):
        (each,) = histogram(log, quantity=quantity).distributions
        assert all(test.p_value > LEAST_P for test in each.tests), quantity
    (g,) = result.pair_distributions
    assert g.edges[0] == pytest.approx(2 * log.discs.radius.min())
    assert g.contact == pytest.approx(2 * log.discs.radius.mean())


def test_a_distribution_of_no_width_is_a_gas_of_equal_discs():
    scenes = [scene(0.3, 100, spread, run="events = 20_000") for spread in (None, 0)]
    item, other = (pressure(log_of(each)).as_dict() for each in scenes)
    for result in (item, other):
        result.pop("origin", None)
    assert item == other
