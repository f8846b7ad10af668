"""Impacts in blocks of time, from the sums in the samples of a run, for logs without events."""

import numpy as np

from idealgas.columns import FIRST_SEGMENT, OUTWARD
from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.tallies.equilibration import Window, equilibrated_from
from idealgas.tallies.equilibrium import kind_of_state, must_apply, must_be_shared
from idealgas.tallies.exchange import through_pistons
from idealgas.tallies.observables import Observable
from idealgas.tallies.stream import MOST_BLOCKS, span
from idealgas.theory.conserved import centre_of_mass_velocity

FEWEST_SAMPLES = 17
"""Smallest number of samples in a window; with fewer blocks, error bars would be meaningless."""

SUMS = (
    "kinetic_flow",
    "collision_flow",
    "wall_virial",
    "face_normal_impulse",
    "face_tangential_impulse",
    "face_hits",
)


class SampledImpacts:
    """Sums over the events in B blocks of time, like those of `Impacts`, for W walls and S species.

    The attributes pair_virial (the trace of collision_flow), inner_virial, wall_virial, collisions, impulse and hits
    have the same meaning as in `Impacts`.

    Attributes:
        kinetic_flow: (B, 3), ∫ Σ m v_a v_b dt for xx, xy and yy, energy·time.
        collision_flow: (B, 4), Σ Δp_a r_b over pair collisions for xx, xy, yy and yx, energy·time.
        flow: (B, 2, 3), the kinetic and the collisional flow for xx, xy and yy, in the frame of zero total momentum.
        push: (B, F), momentum given to each of F faces, perpendicular to the face and into the wall, mass·length/time.
        drag: (B, F), momentum given along each face, mass·length/time.
        dragged: whether walls receive tangential momentum.
    """

    def __init__(self, log: Log, edges: np.ndarray) -> None:
        """Read the sums of a log for blocks with boundaries `edges` (B + 1,), time.

        At boundaries between samples, the sums are interpolated linearly.
        """
        self.edges = edges
        sums = {name: in_blocks(*log.observables[name], edges) for name in SUMS if name in log.observables}
        self.collisions = _collisions(log, edges)
        self.kinetic_flow, self.collision_flow = sums["kinetic_flow"], sums["collision_flow"]
        still = centre_of_mass_velocity(log.scene, log.discs)
        whole = log.discs.mass.sum() * still[[0, 0, 1]] * still[[0, 1, 1]] * np.diff(edges)[:, None]
        self.flow = np.stack((self.kinetic_flow - whole, self.collision_flow[:, :3]), axis=1)
        self.pair_virial = self.collision_flow[:, 0] + self.collision_flow[:, 2]
        self.inner_virial = self.collision_flow[:, :3:2][:, [not wrapped for wrapped in log.periodic]].sum(axis=1)
        self.wall_virial = sums["wall_virial"]
        self.push, self.drag = sums["face_normal_impulse"], sums["face_tangential_impulse"]
        self.dragged = bool(self.drag.any())
        into, along = face_directions(log)
        self.impulse = _by_wall(self.push[..., None] * into + self.drag[..., None] * along)
        self.hits = _by_wall(sums["face_hits"])


def face_directions(log: Log) -> tuple[np.ndarray, np.ndarray]:
    """Return unit vectors (F, 2) into and along every face, which are the directions of positive push and drag."""
    ends = np.array([(wall.start, wall.end) for wall in log.walls[FIRST_SEGMENT:]]).reshape(-1, 2, 2)
    way = ends[:, 1] - ends[:, 0]
    way[~way.any(axis=1), 0] = 1.0  # fixed discs
    tangent = way / np.hypot(*way.T)[:, None]
    right = np.column_stack((tangent[:, 1], -tangent[:, 0]))  # points into the left face
    into = np.concatenate((OUTWARD, np.stack((right, -right), axis=1).reshape(-1, 2)))
    along = np.concatenate((np.abs(OUTWARD)[:, ::-1], np.repeat(tangent, 2, axis=0)))
    return into, along


def sampled(log: Log, start: float | None, end: float | None, needs: tuple[str, ...]) -> tuple[Window, SampledImpacts]:
    """Return the window of time to use, and the sums in it, for a log without events.

    The window begins and ends at samples. If no start is given, it begins when the momentum flow, the virial and the
    collision rates have become stationary.

    Args:
        log: log of the gas.
        start: start of the window, time; None to detect it.
        end: end of the window, time; None for the end of the log.
        needs: properties of the scene that the analysis requires.

    Raises:
        UserError: if the log has neither events nor such sums, if it does not cover the window, if the window contains
            too few samples, or if the scene lacks a required property.
    """
    must_apply(log, start, needs)
    if SUMS[0] not in log.observables:
        raise UserError(
            f"{log.path}: has neither events (log.events = false) nor sums (these require log.pressure = true)"
        )
    first, last = span(log, start, end)
    time = log.observables[SUMS[0]][0]
    time = time[(time >= first) & (time <= last)]
    if len(time) < FEWEST_SAMPLES:
        few = f"only {len(time)} samples between t = {first:g} and {last:g}, one for each epoch or snapshot"
        raise UserError(f"{log.path}: {few} (allowed >= {FEWEST_SAMPLES})")
    edges = np.linspace(time[0], time[-1], min(len(time) - 1, MOST_BLOCKS) + 1)
    impacts = SampledImpacts(log, edges)
    if start is not None:
        return Window(edges, 0, detected=False, slowest=through_pistons(log)), impacts
    pairs = in_blocks(*log.observables["disc_collisions"], edges)
    series = map(Observable, (*impacts.kinetic_flow[:, ::2].T, impacts.pair_virial, pairs))
    first = equilibrated_from(log, edges, tuple(series))
    window = Window(edges, first, detected=True, state=kind_of_state(log), slowest=through_pistons(log))
    energies = (
        window.of(impacts.kinetic_flow[:, ::2])
        - log.discs.mass.sum() * centre_of_mass_velocity(log.scene, log.discs) ** 2
    )
    must_be_shared(log, energies[:, None])
    return window, impacts


def in_blocks(time: np.ndarray, total: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return the increments in blocks of time, (B, …), of a running sum (P, …) that was sampled at times (P,)."""
    columns = total.reshape(len(time), -1).T
    grown = np.array([np.diff(np.interp(edges, time, column)) for column in columns])
    return grown.T.reshape(-1, *total.shape[1:])


def _collisions(log: Log, edges: np.ndarray) -> np.ndarray:
    """Return the numbers of collisions of each species with each group of discs, (B, S, G).

    The shape is (B, 0, G) if the log does not distinguish species. In samples, the matrix of collisions between species
    is upper triangular.
    """
    species = len(log.discs.species_names)
    if species == 1:
        return 2 * in_blocks(*log.observables["disc_collisions"], edges).reshape(-1, 1, 1)
    if len(log.discs.partners) < species or "pair_collisions" not in log.observables:
        return np.zeros((len(edges) - 1, 0, len(log.discs.partners)))
    pairs = in_blocks(*log.observables["pair_collisions"], edges)
    return pairs + np.swapaxes(pairs, 1, 2)


def _by_wall(faces: np.ndarray) -> np.ndarray:
    """Return sums (B, W, …) by wall, given sums (B, F, …) by face."""
    sides, segments = np.split(faces, [FIRST_SEGMENT], axis=1)
    return np.concatenate((sides, segments[:, ::2] + segments[:, 1::2]), axis=1)
