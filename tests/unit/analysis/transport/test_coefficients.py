"""Currents, their growth and transport coefficients against slow and obvious computations."""

import json
import math

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas, log_of, species, streamed

from idealgas.analysis.transport.coefficients import _coefficients, flow_in_samples
from idealgas.analysis.transport.helfand import Lags, growth, lags_of
from idealgas.analysis.transport.measure import transport
from idealgas.analysis.transport.result import WALLS
from idealgas.tallies.currents import APART_X, CARRIED, HEAT_X, HEAT_Y, PASSED_ON, XX, XY, YY, Currents
from idealgas.tallies.flights import Moments
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.stream import stream

GAS = gas(12, 0.3, (6, 5), "collisions_per_disc = 60", periodic="xy", temperature=1.0, seed=3)
HEAVY = species("heavy", 3, 0.4, mass=2.5)


@pytest.fixture(scope="module", params=["", HEAVY], ids=["equal", "mixture"])
def log(request):
    return log_of(GAS + request.param)


@pytest.fixture(scope="module", params=[(0.0, 1.0, 7), (0.23, 0.71, 4), (0.1, 1.0, 900)], ids=str)
def edges(log, request):
    start, end, blocks = request.param
    return np.linspace(start * log.end_time, end * log.end_time, blocks + 1)


def obvious(log, edges):
    """Currents in blocks by plain loops over flights and collisions."""
    flow = np.zeros((len(edges) - 1, 2, 7))
    mass, box, kinds = log.discs.mass, np.array(log.box), log.discs.species
    two = len(log.discs.species_names) == 2
    share = (1 / np.array([12, -3]))[kinds] if two else np.zeros(len(mass))
    frame = mass @ log.discs.velocity / mass.sum()
    velocity = log.state_at(edges[0]).velocity - frame
    since = np.full(len(mass), edges[0])

    def fly(i, until):
        carried = [*(mass[i] * velocity[i][[0, 0, 1]] * velocity[i][[0, 1, 1]]), *velocity[i] * _energy(i)]
        carried += [*share[i] * velocity[i]]
        for k in range(len(edges) - 1):
            duration = min(until, edges[k + 1]) - max(since[i], edges[k])
            if duration > 0:
                flow[k, CARRIED] += duration * np.array(carried)
        since[i] = until

    def _energy(i):
        return mass[i] * (velocity[i] @ velocity[i]) / 2

    columns = ("time", "disc", "partner", "position", "velocity")
    (rows,) = log.chunks(columns, log.row_at(edges[0], "right"), log.row_at(edges[-1], "right"))
    for row, (time, i, j) in enumerate(zip(rows.time, rows.disc, rows.partner, strict=True)):
        fly(i, time)
        before, energy = velocity[i].copy(), _energy(i)
        velocity[i] = rows.velocity[row] - frame
        if i < j:  # the next row is that of the partner
            apart = rows.position[row] - rows.position[row + 1]
            apart -= box * np.round(apart / box)
            (px, py), gain = mass[i] * (velocity[i] - before), _energy(i) - energy
            k = min(max(int(np.searchsorted(edges, time, "left")) - 1, 0), len(edges) - 2)
            flow[k, PASSED_ON] += [px * apart[0], px * apart[1], py * apart[1], *gain * apart, 0, 0]
    for i in range(len(mass)):
        fly(i, edges[-1])
    return flow


def test_currents(log, edges):
    currents, moments, impacts = Currents(), Moments(), Impacts(len(log.walls), log.periodic)
    stream(log, edges, [currents, moments, impacts])
    assert currents.flow == pytest.approx(obvious(log, edges), rel=1e-10, abs=1e-10)
    flights = moments.flights.sum(axis=1)[:, 1:3]
    assert currents.flow[:, CARRIED, XX : YY + 1 : 2] == pytest.approx(flights, rel=1e-11, abs=1e-11)
    trace = currents.flow[:, PASSED_ON, XX] + currents.flow[:, PASSED_ON, YY]
    assert trace == pytest.approx(impacts.pair_virial, rel=1e-11, abs=1e-11)


def test_one_species_moves_apart_from_the_other(log, edges):
    """As the middles of their discs do."""
    currents = streamed(log, edges, Currents())
    states = [log.state_at(time) for time in edges[[0, -1]]]
    first, last = (state.position + state.image * log.box for state in states)
    middles = [(last - first)[log.discs.species == s].mean(axis=0) for s in range(len(log.discs.species_names))]
    apart = middles[0] - middles[1] if len(middles) == 2 else np.zeros(2)
    assert currents.flow[:, CARRIED, APART_X:].sum(axis=0) == pytest.approx(apart, rel=1e-9, abs=1e-9)


def test_growth_is_half_the_slope_of_plain_averages():
    flow, lags = np.random.default_rng(2).normal(size=(2, 101)) + 0.3, Lags(0.5, 3, 7)
    result = growth(flow, lags)
    squares = np.zeros((2, 8, 95))
    for route, series in enumerate(flow - flow.mean(axis=1, keepdims=True)):
        for start in range(95):
            for steps in range(8):
                squares[route, steps, start] = series[start : start + steps].sum() ** 2
    long, short = (t - t * t / (101 * 0.5) for t in (3.5, 1.5))
    assert result.series == pytest.approx((squares[:, 7] - squares[:, 3]) / 2 / (long - short))
    assert lags.plateau == (1.5, 3.5)
    time = np.arange(8) * 0.5
    used = squares.mean(axis=0)[:, : 95 - 95 % 13].mean(axis=1)
    assert result.running == pytest.approx(np.diff(used) / np.diff(time - time**2 / 50.5) / 2)
    assert lags.times == pytest.approx((time[1:] + time[:-1]) / 2)


def test_growth_of_a_current_that_is_known():
    """Noise that forgets: x_t = a x_{t-1} + noise has K = 1/2(1 - a)² in steps of time 1; four standard errors."""
    random, a, n = np.random.default_rng(3), 0.5, 200_000
    noise = random.normal(size=(2, n))
    current = np.zeros((2, n))
    for t in range(1, n):
        current[:, t] = a * current[:, t - 1] + noise[:, t]
    result = growth(current, lags_of(1.0, 20.0, 0.5))
    expected = 1 / (2 * (1 - a) ** 2)
    assert len(result.running) == 20
    assert (np.abs(result.running[10:] - expected) < 4 * result.error[10:]).all()
    assert (result.error[10:] < 0.05 * expected).all()
    assert result.running[0] < 0.7 * expected  # it has not forgotten yet


def test_coefficients_are_growth_over_area_and_temperature(log):
    """Viscosities are K/(A T), the conductivity is K/(A T²); xy, (xx - yy)/2 and heat have one current here."""
    each, trace = np.random.default_rng(4).normal(size=(2, 101))
    flow = np.zeros((101, 2, 7))
    flow[:, CARRIED, [XX, XY, HEAT_X, HEAT_Y]] = np.column_stack((trace + each, each, each, each))
    flow[:, PASSED_ON, YY] = trace - each
    known, unit = growth(np.array([each, trace]), Lags(0.5, 3, 7)).series.mean(axis=1), 30 * 4.0
    result = _coefficients(flow, Lags(0.5, 3, 7), log.discs, 4.0, True, None)
    for name, value, routes in (
        ("viscosity", known[0] / unit, 2),
        ("thermal_conductivity", known[0] / unit / 4, 2),
        ("bulk_viscosity", known[1] / unit, 1),
    ):
        assert [route.value for route in result[name].routes.values()] == pytest.approx([value] * routes)


@pytest.mark.parametrize(("width", "longest"), [(1.0, 20.0), (1.0, 1.0), (30.0, 20.0), (0.2, 3.0)])
def test_lags_leave_a_plateau(width, longest):
    lags = lags_of(width, longest, 0.5)
    assert 0 < lags.first < lags.last
    assert lags.width * lags.last == pytest.approx(max(longest, 2 * width), abs=width)


def test_coefficients_of_a_log(log):
    result = transport(log)
    whole = result.collective
    single = len(log.discs.species_names) == 1
    last = ["bulk_viscosity", *["mutual_diffusion"] * (not single)]
    assert list(whole.coefficients) == ["viscosity", *["thermal_conductivity"] * single, *last]
    assert whole.plateau[1] == pytest.approx(2 * whole.plateau[0])
    for name, each in whole.coefficients.items():
        routes = [route.value for route in each.routes.values()]
        assert each.value.value == pytest.approx(np.mean(routes))
        assert each.value.value > 0
        assert (each.value.theory is not None) == (single or name == "mutual_diffusion")
        assert (each.difference is None) == (len(routes) == 1)
        if each.difference is not None:
            assert each.difference.value == pytest.approx(routes[0] - routes[1])
    trace = (result.pressure["xx"].value + result.pressure["yy"].value) / 2
    impacts = streamed(log, np.array([result.window.start, result.window.end]), Impacts(len(log.walls), log.periodic))
    gas, dof = log.discs, 2 * len(log.discs) - 2
    frame = gas.mass @ gas.velocity / gas.mass.sum()
    temperature = (gas.mass * ((gas.velocity - frame) ** 2).sum(axis=1)).sum() / dof
    virial = impacts.pair_virial[0] / result.window.duration / 2
    assert trace == pytest.approx((len(gas) * temperature + virial) / gas.area, rel=1e-9)
    assert abs(result.pressure["xy"].deviation) < 4
    assert json.dumps(result.as_dict(), allow_nan=False)
    assert any("plateau: t = " in note for table in result.plain_tables() for note in table.notes)


def test_walls_have_no_coefficients_of_the_whole_gas(make):
    log = make("box.left=reflecting", "box.right=reflecting")
    result = transport(log)
    assert result.collective is None
    assert any(WALLS in table.notes for table in result.plain_tables())
    assert math.isfinite(result.diffusion[0].running[-1])


def test_species_that_differ_by_name_only_diffuse_like_their_discs():
    gas = 'name = "{}", count = {}, radius = 0.3, temperature = 1.0'
    species = ", ".join("{" + gas.format(name, count) + "}" for name, count in (("white", 12), ("black", 30)))
    result = transport(log_of(f"box.size = [8, 9]\nspecies = [{species}]\nrun.events = 20_000", *PERIODIC))
    mutual = result.collective.coefficients["mutual_diffusion"].value
    for each in result.diffusion:
        assert mutual.theory == pytest.approx(each.coefficient.theory, rel=0.05)  # exactly so in an infinite gas
    assert abs(mutual.deviation) < 4


def test_a_longer_lag_is_a_later_plateau(make):
    log = make()
    short, long = (transport(log, lag=lag) for lag in (2.0, 4.0))
    assert long.collective.plateau == pytest.approx(tuple(2 * t for t in short.collective.plateau), rel=0.02)
    assert long.diffusion[0].lag[-1] == pytest.approx(2 * short.diffusion[0].lag[-1])
    assert (short.free_times, long.free_times) == pytest.approx((2.0, 4.0))


SAMPLED = (
    gas(60, 0.4, (16, 12), "events = 12_000", periodic="xy", temperature=1.0, seed=3)
    + """
[[disc]]
position = [8, 6]
velocity = [9, -7]
radius = 0.4
[log]
pressure = true
heat_flow = true
snapshot_every = 0.5
"""
)


@pytest.mark.slow
def test_the_same_coefficients_without_events():
    """At the instants of snapshots the integrals of both are the same but for rounding; a fast disc moves the gas."""
    flows = {}
    for name, override in (("events", "log.events=true"), ("samples", "log.events=false")):
        log = log_of(SAMPLED, override)
        last = 0.5 * int(log.end_time / 0.5)
        result = transport(log, start=1.5, end=last, lag=10.0)
        flows[name], width = flow_in_samples(log, result.window, result.collective.plateau[1])
        if log.has_events:
            edges = 1.5 + width * np.arange(len(flows[name]) + 1)
            currents = streamed(log, edges, Currents())
            assert flows[name][..., :APART_X] == pytest.approx(currents.flow[..., :APART_X], rel=1e-9, abs=1e-9)
        else:
            assert (result.diffusion, result.pair_distributions, result.free_paths) == ((), (), ())
            assert list(result.collective.coefficients) == ["viscosity", "bulk_viscosity"]  # two species
            assert len(result.plain_tables()) == 4
            assert json.dumps(result.as_dict(), allow_nan=False)
    assert np.array_equal(flows["events"], flows["samples"], equal_nan=True)


@pytest.mark.slow
def test_walls_leave_the_pressure_tensor():
    """By events and by samples in a window that snapshots bound; samples lack how far the gas moved across."""
    walls, tensors = ("box.bottom=reflecting", "box.top=reflecting", "log.heat_flow=false"), []
    for override in ("log.events=true", "log.events=false"):
        log = log_of(SAMPLED, *walls, override)
        result = transport(log, start=1.5, end=0.5 * int(log.end_time / 0.5))
        assert (result.collective, result.walled) == (None, True)
        tensors.append(result.pressure)
    for name in ("xx", "yy"):
        assert tensors[0][name].value == pytest.approx(tensors[1][name].value, rel=1e-9)
    assert 0.5 < tensors[0]["xx"].value / tensors[0]["yy"].value < 2
    assert all(abs(tensor["xy"].deviation) < 4 for tensor in tensors)
