"""Checks of a run's method and stop rules."""

from __future__ import annotations

import math
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

import numpy as np

from idealgas.scene.defaults import mean_speed
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.document import Document

MONTE_CARLO, TIME_DRIVEN, BRUTE_FORCE = "monte_carlo", "time_driven", "brute_force"
OWNERS = {
    "trials": (MONTE_CARLO, "trials"),
    "v_ref": (MONTE_CARLO, "trials"),
    "impact": (MONTE_CARLO, "trials"),
    "dt": (TIME_DRIVEN, "steps"),
    "precision": (BRUTE_FORCE, "choice of precision"),
}
"""Method to which each of these keys belongs, and the feature that the other methods lack."""

PLAIN = "float64"
"""Default precision of all methods."""

MOST_SNAPSHOTS, MOST_STEPS, MOST_TRIALS = 1e7, 1e10, 1e10
"""Largest numbers of snapshots, steps and trials in a run; such runs take hours even with few discs."""

MOST_EVENTS = 1e14
"""Largest number of collisions in a run heated by a bath or a side; more would take over a year."""

MOST_HEATING = 2.0**40
"""Largest ratio of a later temperature to the temperatures and energies before it.

The sums of energy are stored as multiples of one unit, which is chosen at the start and has to suit all temperatures.
"""

LONGEST = 2.0**52
"""Number of mean free times after which the times of successive collisions are no longer distinct as floats."""


def method_issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Check that no keys of other methods are given, and that the method supports everything in the scene."""
    run = scene.run
    for key, (owner, feature) in OWNERS.items():
        if run.method != owner and (value := getattr(run, key)) is not None:
            allowed = f'no {key}, or method = "{owner}"'
            yield Issue((("run", key), ("run", "method")), f"no {feature} in {run.method}", str(value), allowed)
    if run.method == MONTE_CARLO:
        yield from _monte_carlo_issues(scene, invalid)
    elif run.method == TIME_DRIVEN:
        yield from _step_issues(scene)
    elif run.method == BRUTE_FORCE and run.precision not in (None, PLAIN):
        yield from _precision_issues(scene)
    if "log" not in invalid and scene.log.pressure:
        yield from _pressure_issues(scene)
    if "log" not in invalid and scene.log.heat_flow:
        yield from _heat_flow_issues(scene)


def _step_issues(scene: Document) -> Iterator[Issue]:
    got = f'method = "{TIME_DRIVEN}"'
    if scene.run.dt is None:
        yield Issue((("run", "dt"), ("run", "method")), "missing", got, "a number > 0, the time step")
    for place in _keys(scene, "allows_time_steps"):
        yield Issue((place, ("run", "method")), "not supported by time steps", got, f"event_driven, {BRUTE_FORCE}")


def _precision_issues(scene: Document) -> Iterator[Issue]:
    """Check for effects, which are supported only in double precision.

    The exception is steering in float32: a reversal rounds velocities to float64, which is exact for float32.
    """
    for place in _keys(scene):
        if place == ("steering",) and scene.run.precision == "float32":
            continue
        wrong = "only smooth elastic discs in a reflecting box are supported"
        yield Issue((place, ("run", "precision")), wrong, f'precision = "{scene.run.precision}"', f'"{PLAIN}"')


def _pressure_issues(scene: Document) -> Iterator[Issue]:
    """Check that the method and precision allow the momentum flow to be recorded."""
    run = scene.run
    got = f'method = "{run.method}"' if run.precision in (None, PLAIN) else f'precision = "{run.precision}"'
    if run.method in (MONTE_CARLO, TIME_DRIVEN) or run.precision not in (None, PLAIN):
        keys = ("log", "pressure"), ("run", "precision" if run.precision else "method")
        yield Issue(keys, "not recorded by this method", got, f'event_driven, {BRUTE_FORCE} with "{PLAIN}"')


def _heat_flow_issues(scene: Document) -> Iterator[Issue]:
    """Check that the heat flow is recorded only with the pressure and in gases without sources of heat."""
    key: Key = ("log", "heat_flow")
    if not scene.log.pressure:
        wrong = "only recorded together with the momentum flow"
        yield Issue((key, ("log", "pressure")), wrong, "pressure = false", "pressure = true")
    if not all(scene.properties.periodic):
        wrong = "walls exchange heat and momentum with the gas"
        yield Issue((key, ("box",)), wrong, "sides that reflect", "four periodic sides")
    for effect in scene.active_effects:
        if not (effect.properties.uniform and effect.properties.conserves_motion):
            for place in effect.keys:
                yield Issue((place, key), "changes velocities between collisions", effect.name, "heat_flow = false")


def _monte_carlo_issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Check for effects that require disc positions, and for gases in which no collisions can occur."""
    for place in _keys(scene, "allows_monte_carlo"):
        got = f'method = "{MONTE_CARLO}"'
        yield Issue((place, ("run", "method")), "requires discs with positions", got, "event_driven, brute_force")
    if not {"species", "disc"} & invalid and scene.has_discs:
        if scene.number_of_discs < 2:
            yield Issue((("run", "method"),), "no pair to collide", "one disc", "two discs or more")
        elif scene.mean_speed == 0:
            yield Issue(
                (("run", "method"),), "nothing moves, so no pair meets", "speeds that are all 0", "discs that move"
            )
        elif scene.run.v_ref is not None:
            yield from _slow_issues(scene, scene.run.v_ref)


def _slow_issues(scene: Document, v_ref: float) -> Iterator[Issue]:
    """Check that v_ref is large enough; the run itself might not detect a small value before it ends."""
    for i, s in enumerate(scene.species) if scene.draws_velocities else scene.placed:
        still = s.velocities or s.count <= 1
        least = 0.0 if still else mean_speed([s], np.empty((0, 2))) * s.largest_radius / scene.largest_radius
        if v_ref < least:
            keys = (("run", "v_ref"), *(("species", i, key) for key in ("speed", "temperature", "mass", "radius")))
            yield Issue(
                keys, "slower than the discs at the start", f"{v_ref}", f">= {least:.6g}, preferably ten times this"
            )


def number_issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Check that the run is not too long for the clock and does not have too many snapshots, steps or trials."""
    run, end = scene.run, scene.expected_end
    if run.until is not None and LONGEST * scene.mean_free_time < end:
        got = f"{run.until}, about {run.until / scene.mean_free_time:.3g} mean free times"
        allowed = f"<= {LONGEST:.3g} of them, a time <= {LONGEST * scene.mean_free_time:.3g}"
        yield Issue((("run", "until"), ("run",)), "too long for the resolution of the clock", got, allowed)
    yield from _heated_issues(scene)
    every = None if "log" in invalid else scene.log.snapshot_every
    for key, period, quantity, most in (
        (("log", "snapshot_every"), every, "snapshots", MOST_SNAPSHOTS),
        (("run", "dt"), run.dt, "steps", MOST_STEPS),
    ):
        if period is not None and most * period < end < math.inf:
            allowed = f"<= {most:g}, with a time >= {end / most:.3g}"
            yield Issue((key, ("run",)), f"too many {quantity}", f"about {end / period:.3g}", allowed)
    if run.v_ref is None or run.trials is not None or math.isinf(scene.trial_time):
        return
    trials = end / scene.trial_time
    if MOST_TRIALS < trials < math.inf:
        allowed = f"<= {MOST_TRIALS:g}, with a speed <= {run.v_ref * MOST_TRIALS / trials:.3g}"
        yield Issue((("run", "v_ref"), ("run",)), "too many trials", f"about {trials:.3g}", allowed)


def _heated_issues(scene: Document) -> Iterator[Issue]:
    """Check that no side or heat bath is so hot that energy sums would lose digits or the run would take years."""
    run, properties = scene.run, scene.properties
    keys: list[Key] = []
    for effect in scene.active_effects:
        if effect.properties.temperatures:
            keys += [("thermostat", "temperature") if key == ("thermostat",) else key for key in effect.keys]
    if not keys:
        return
    first = [t for t in (*properties.emits, properties.bath) if t is not None]
    before, later = max([scene.mean_kinetic_energy, *first]), max(properties.later_temperatures, default=0.0)
    if later > MOST_HEATING * before:
        got, allowed = f"{later:g} after {before:.3g}", f"at most {MOST_HEATING:.3g} times as hot"
        wrong = "temperature step too large for the precision of the energy account"
        yield Issue((*keys, ("run",)), wrong, got, allowed)
        return
    lightest, hottest = (
        min([*(size.mass for size in scene.sizes), *scene.explicit_discs.mass.tolist()]),
        max(*first, later, 0.0),
    )
    speed = math.sqrt(math.pi * hottest / (2 * lightest))  # as the discs may be cold at the start
    if run.until is None or speed <= scene.mean_speed:
        return
    events = scene.number_of_discs * run.until / scene.free_time_at(speed)
    if events > MOST_EVENTS:
        got = f"{hottest:g}, about {events:.3g} collisions until t = {run.until:g}"
        allowed = f"<= {MOST_EVENTS:g}, at T <= {hottest * (MOST_EVENTS / events) ** 2:.3g}"
        yield Issue((*keys, ("run", "until")), "too hot: the run would take years", got, allowed)


def _keys(scene: Document, missing: str | None = None) -> Iterator[Key]:
    """Yield the keys of all effects, or only of the effects that lack a given property."""
    for effect in scene.active_effects:
        if missing is None or not getattr(effect.properties, missing):
            yield from effect.keys


def endless_issues(scene: Document) -> Iterator[Issue]:
    """Check that the run has a stop rule that will be met."""
    run = scene.run
    if run.collisions_per_disc is not None and not scene.properties.interacting:
        place: tuple[Key, ...] = (("run", "collisions_per_disc"), ("interactions", "discs"))
        yield Issue(place, "discs that do not interact never collide", f"{run.collisions_per_disc}", "until or events")
        return
    keys: tuple[Key, ...] = (("run",), ("run", "until"), ("run", "events"), ("run", "collisions_per_disc"))
    if run.until is not None or run.trials is not None:
        return
    if run.events is None and run.collisions_per_disc is None:
        yield Issue(keys, "no stop rule", "nothing", "at least one of until, events and collisions_per_disc")
        return
    alone = scene.number_of_discs == 1 or not scene.properties.interacting
    if not scene.properties.drives_discs and not (scene.has_discs and scene.mean_speed):
        yield Issue(keys, "nothing moves, so no event ends the run", "speeds that are all 0", "a run with until")
    elif run.events is None and alone:
        yield Issue(keys, "a single disc never collides", "collisions_per_disc alone", "a run with until or events")
    elif alone and all(scene.properties.periodic) and scene.properties.empty and scene.properties.isolated:
        what = "a single disc meets" if scene.properties.interacting else "discs that do not interact meet"
        yield Issue(keys, f"{what} nothing in a periodic box", "events alone", "a run with until")
