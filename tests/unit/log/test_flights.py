"""Flights of discs against a slow and obvious computation from the event rows."""

from itertools import pairwise

import numpy as np
import pytest
from helpers.support import logged, uncompiled
from scipy.integrate import quad

import idealgas.log.flights as module
from idealgas.columns import Kind
from idealgas.log import Flights, LogError
from idealgas.log.flights import NO_EVENT, NOBODY
from idealgas.scene import parse_scene

GAS = """
scene.seed = 3
box.size = [5, 4]
species = [{name = "gas", count = 9, radius = 0.3, mass = 2.0, temperature = 1.0}]
run.events = 300
"""
SIDES = {"x": ("left", "right"), "y": ("bottom", "top")}


def joined(axes):
    return [f'box.{side}="periodic"' for axis in axes for side in SIDES[axis]]


CASES = {
    "plain": [],
    "gravity": ["gravity.acceleration=[0.3, -0.7]"],
    "rough": ["rotation={inertia=0.5, roughness=1, wall_roughness=1}"],
    "periodic": joined("xy"),
    "falling along joined sides": [*joined("x"), "gravity.acceleration=[0, -0.5]"],
    "thermostat": ["thermostat={temperature=2, rate=3}"],
    "without positions": ['run.method="monte_carlo"'],
}


def make(path, *overrides):
    with uncompiled():
        return logged(parse_scene(GAS, overrides=overrides), path)


@pytest.fixture(scope="module", params=CASES)
def log(request, tmp_path_factory):
    with make(tmp_path_factory.mktemp("flights") / "run.h5", *CASES[request.param]) as log:
        yield log


def expected(log, edges):
    """Flights from edge to edge as dictionaries: those that events end in order, with their pieces, then the others."""
    gravity, box = np.array(log.gravity), np.array(log.box)
    state, result = log.state_at(edges[0]), []
    records = [(edges[0], *(None if c is None else c[disc] for c in state[1:])) for disc in range(len(log.discs))]

    def at(disc, time):
        began, position, velocity, image, spin = records[disc]
        t = time - began
        place = position + velocity * t + gravity * t**2 / 2
        boxes = np.floor(place / box) * log.periodic
        return place - boxes * box, velocity + gravity * t, None if image is None else image + boxes, spin

    def path(velocity, time):
        if not gravity.any():
            return np.hypot(*velocity) * time
        turn = np.clip(-(velocity @ gravity) / (gravity @ gravity), 0, time)
        speed = lambda t: np.hypot(*(velocity + gravity * t))  # noqa: E731
        return quad(speed, 0, turn, epsabs=0, epsrel=1e-13)[0] + quad(speed, turn, time, epsabs=0, epsrel=1e-13)[0]

    def fly(disc, end, event):
        begin = records[disc][0]
        inner = [edge for edge in edges[1:-1] if begin < edge < end]
        cuts = sorted({begin, *inner, end}) if begin < end else [begin, end]
        for start, stop in pairwise(cuts):
            last = stop == cuts[-1]
            kind, partner, after, spin = (
                event if last and event else (NO_EVENT, NOBODY, at(disc, stop)[1], at(disc, stop)[3])
            )
            result.append(
                {
                    "disc": disc,
                    "species": log.discs.species[disc],
                    "block": max(i for i in range(len(edges) - 1) if edges[i] < (start + stop) / 2 or i == 0),
                    "start": start,
                    "end": stop,
                    "kind": kind,
                    "partner": partner,
                    "ends_in_collision": kind != NO_EVENT and partner >= 0,
                    "velocity": at(disc, start)[1],
                    "end_velocity": at(disc, stop)[1],
                    "new_velocity": after,
                    "displacement": at(disc, start)[1] * (stop - start) + gravity * (stop - start) ** 2 / 2,
                    "path": path(at(disc, start)[1], stop - start),
                    "position": at(disc, start)[0],
                    "end_position": at(disc, stop)[0],
                    "image": at(disc, start)[2],
                    "angular_velocity": at(disc, start)[3],
                    "new_angular_velocity": spin,
                }
            )

    for batch in log.events(t1=np.nextafter(edges[-1], np.inf)):
        for row in range(len(batch.time)):
            if batch.time[row] <= edges[0]:
                continue
            get = lambda name: None if getattr(batch, name) is None else getattr(batch, name)[row]  # noqa: B023, E731
            disc = int(get("disc"))
            fly(disc, get("time"), (get("kind"), get("partner"), get("velocity"), get("angular_velocity")))
            place = np.full(2, np.nan) if get("position") is None else get("position")
            records[disc] = get("time"), place, get("velocity"), get("image"), get("angular_velocity")
    for disc in range(len(log.discs)):
        fly(disc, edges[-1], None)
    return result


def check(log, edges, result):
    flights = expected(log, edges)
    assert len(result.disc) == len(flights)
    for name, values in result._asdict().items():
        if values is None:
            assert flights[0][name] is None or np.isnan(flights[0][name]).all(), name
            continue
        right = np.array([flight[name] for flight in flights])
        if name == "end_position":  # a disc that an event leaves on a joined side may be on either
            box = np.where(log.periodic, log.box, np.inf)
            apart = np.abs(values - right)
            assert np.minimum(apart, np.abs(box - apart)).max() < 1e-11
        elif values.dtype.kind == "f":
            assert values == pytest.approx(right, rel=1e-11, abs=1e-11), name
        else:
            assert values.tolist() == right.tolist(), name


@pytest.mark.parametrize("part", [(0.0, 1.0, 1), (0.0, 1.0, 7), (0.2, 0.7, 3), (0.1, 1.0, 500)], ids=str)
def test_flights_and_their_pieces(log, part):
    first, last, blocks = part
    edges = np.linspace(first * log.end_time, last * log.end_time, blocks + 1)
    check(log, edges, Flights.joined(log.flights(edges)))


def test_by_default_flights_fill_the_log_and_an_event_at_an_edge_ends_the_block_before(log):
    result = Flights.joined(log.flights())
    assert (result.kind != NO_EVENT).sum() == len(log)
    assert (result.block == 0).all()
    assert np.bincount(result.disc, result.end - result.start) == pytest.approx(np.full(9, log.end_time))
    assert result.end[-9:].tolist() == [log.end_time] * 9
    (times,) = log.chunks(("time",))
    edges = np.array([*times.time[[50, 100, 150]], log.end_time])
    check(log, edges, Flights.joined(log.flights(edges)))


def test_states_at_edges_are_those_of_the_log(log):
    edges = np.linspace(0, log.end_time, 8)
    result = Flights.joined(log.flights(edges))
    for block, state in enumerate(log.frames(edges[:-1])):
        opening = result.start == edges[block]
        order = np.argsort(result.disc[opening])
        assert result.velocity[opening][order] == pytest.approx(state.velocity, abs=1e-12)
        if log.has_positions:
            assert result.position[opening][order] == pytest.approx(state.position, abs=1e-12)


def test_small_batches_have_the_same_flights_and_whole_pairs(log, monkeypatch):
    """Pairs of rows may lie across the edge of two chunks, and pieces of one flight fill several batches."""
    edges = np.linspace(0, log.end_time, 40)
    whole, chunks = Flights.joined(log.flights(edges)), log.chunks
    monkeypatch.setattr(module, "BATCH", 5)

    def short(columns, start, stop):
        for row in range(start, stop, 7):
            yield from chunks(columns, row, min(row + 7, stop))

    monkeypatch.setattr(log, "chunks", short)
    batches = list(log.flights(edges))
    for each, other in zip(whole, Flights.joined(batches), strict=True):
        assert np.array_equal(each, other)
    assert np.median([len(batch.disc) for batch in batches]) < 9
    for batch in batches:
        ended = batch.kind == Kind.DISC
        disc, partner = batch.disc[ended], batch.partner[ended]
        assert (disc[::2] == partner[1::2]).all()
        assert (disc[1::2] == partner[::2]).all()
        assert (disc[::2] < disc[1::2]).all()


def test_some_discs_and_some_columns_and_a_data_frame(log):
    edges = np.linspace(0, log.end_time, 6)
    whole = Flights.joined(log.flights(edges))
    selected = Flights.joined(log.flights(edges, discs=[2, 5]))
    few = Flights.joined(log.flights(edges, discs=7, columns=("end", "new_velocity")))
    chosen = np.isin(whole.disc, [2, 5])
    for each, other in zip(whole, selected, strict=True):
        assert each is None is other or np.array_equal(each[chosen], other)
    assert np.array_equal(few.end, whole.end[whole.disc == 7])
    assert np.array_equal(few.new_velocity, whole.new_velocity[whole.disc == 7])
    assert few.disc is None is few.velocity
    times = [0.0, log.end_time / 2, log.end_time]
    frame, result = log.to_pandas("flights", times=times), Flights.joined(log.flights(times))
    assert frame["end_vy"].tolist() == result.end_velocity[:, 1].tolist()
    assert frame["kind"].isna().tolist() == (result.kind == NO_EVENT).tolist()
    assert (frame["kind"] == "disc").tolist() == (result.kind == Kind.DISC).tolist()
    assert set(log.to_pandas("flights", disc=3)["disc"]) == {3}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"edges": [0.0]}, "two or more times"),
        ({"edges": [1.0, 0.5]}, "in increasing order"),
        ({"edges": [0.0, 1e9]}, r"no flights from t = 0 to 1e\+09"),
        ({"columns": ("spin",)}, "have no spin"),
        ({"discs": [9]}, "allowed: 0 to 8"),
    ],
    ids=str,
)
def test_what_a_log_does_not_have_is_one_line(log, arguments, message):
    with pytest.raises(LogError, match=message):
        log.flights(**arguments)


def test_a_log_without_events_has_no_flights(tmp_path):
    with (
        make(tmp_path / "run.h5", "log.events=false", "log.snapshot_every=0.5", "run.events=", "run.until=3") as log,
        pytest.raises(LogError, match=r"has no events \(made with log.events = false\)"),
    ):
        log.flights()
