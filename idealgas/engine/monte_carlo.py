"""The Monte Carlo method: discs of a homogeneous gas, without positions, that collide at random.

Trials are a Poisson process. Each trial draws a random pair and accepts it with a probability equal to the ratio of its
collision rate to the largest possible rate, so every pair collides exactly at its rate. Such a process has no memory:
an epoch begins with a new waiting time and with its own random numbers, keyed by the seed and the start of the epoch.
A run can therefore be continued from the velocities alone, together with v_ref if it has been raised.

The largest possible rate is the collision rate of a pair of the largest discs at relative speed v_ref. If a disc
emerges from a collision so fast that two such discs could exceed a default v_ref, v_ref is raised before the next
trial; no pair is then ever too fast, whether it is drawn or not. The time of the change depends only on the past, and
from then on both the rate of trials and the accepted fraction follow the new v_ref, so every pair still collides at its
rate (thinning with a bound that depends on the past: Ogata, IEEE Trans. Inf. Theory 27, 23 (1981)). It would be wrong
to raise v_ref only when a pair that is too fast is drawn: until then the pair would have collided too rarely.
"""

import math
from functools import partial
from typing import NamedTuple

import numpy as np

from idealgas.columns import Column, EventBatch
from idealgas.effects.bundle import Effects
from idealgas.engine.event_writer import batch_capacity, write_pair, write_trial
from idealgas.engine.method import Limits, Method
from idealgas.engine.resolve import resolve_pair
from idealgas.errors import UserError
from idealgas.jit import inline, njit
from idealgas.physics.collision_rates import mean_trial_time
from idealgas.physics.disc_disc import random_contact
from idealgas.physics.elementary import log
from idealgas.physics.periodic import NO_IMAGES
from idealgas.physics.random_numbers import GOLDEN, mix, unit_interval
from idealgas.state import Gas

U = np.uintp
DRAWS = np.uint64(5)  # random numbers reserved for a trial

V_REF = Column("v_ref", "f8", (), "length/time")
"""Column of the log for a reference speed that may be raised."""

FASTEST_DISC = 0.499  # largest speed of a disc in units of v_ref: just under a half, so that rounding does not matter
RAISED = 2.5  # the new v_ref in units of the speed of the disc that was too fast


@inline
def draw(start, k):
    """Random number k in (0, 1] of a trial; start: counter of the trial."""
    return unit_interval(mix(start + np.uint64(k) * GOLDEN))


@inline
def random_pair(number, start):
    """Indices of a random pair of discs; all pairs have the same probability. start: counter of the trial."""
    i = np.int64(number * (1.0 - draw(start, 1)))
    j = np.int64((number - 1) * (1.0 - draw(start, 2)))
    return i, j + (j >= i)


@inline
def too_fast(a, b, fastest_square):
    """Return the squared speed of the faster of two discs, (length/time)², if it exceeds `fastest_square`; otherwise 0.

    fastest_square: None if there is no bound.
    """
    if fastest_square is not None:
        square = max(a.vx * a.vx + a.vy * a.vy, b.vx * b.vx + b.vy * b.vy)
        return square if square > fastest_square else 0.0
    return 0.0


class Trials(NamedTuple):
    """Parameters of the trials of an epoch.

    Attributes:
        key: key of the epoch's random numbers.
        mean_wait: mean time between trials.
        fastest: largest allowed product of relative speed and sum of the radii, length²/time.
        fastest_square: square of the largest allowed speed of a disc, (length/time)²; None without a bound.
        one_sided: whether all impact parameters have the same sign.
    """

    key: np.uint64
    mean_wait: float
    fastest: float
    fastest_square: float | None
    one_sided: bool


@njit
def advance_trials(discs, trials, effects, limits, epoch_start, batch, counters):
    """Try pairs until a limit or the end of the batch is reached, or until a pair or a disc is too fast.

    Returns:
        The number of rows written; whether all events up to the time limit have happened; the product of relative
        speed and sum of the radii (length²/time) of a pair that exceeds `fastest`, or 0; the squared speed of a disc
        that exceeds `fastest_square` after the last collision, (length/time)², or 0.
    """
    record, ids, _ = discs
    key, trial_time, fastest, fastest_square, one_sided = trials
    most_collisions = min(limits.events, limits.collisions)
    counter = counters[0]
    number = record.shape[0]
    capacity = batch_capacity(batch)
    last_trial = counter.trials + limits.trials
    collisions = 0
    rows = 0
    reached = False
    excess = 0.0
    square = 0.0
    while collisions < most_collisions and counter.trials < last_trial and rows < capacity:
        start = key + GOLDEN * DRAWS * np.uint64(counter.trials)
        time = counter.trial_time - trial_time * log(draw(start, 0))
        if time > limits.until:
            reached = True
            break
        counter.trial_time = time
        counter.trials += 1
        i, j = random_pair(number, start)
        a = record[U(i)]
        b = record[U(j)]
        vx, vy = a.vx - b.vx, a.vy - b.vy
        speed = math.sqrt(vx * vx + vy * vy)
        rate = (a.r + b.r) * speed
        if rate > fastest:
            excess = rate
            break
        if draw(start, 3) * fastest > rate:
            continue
        offset = draw(start, 4)
        random_contact(a, b, offset if one_sided else 2.0 * offset - 1.0)
        a.t = b.t = time
        resolve_pair(a, b, ids[U(i)], ids[U(j)], time, NO_IMAGES, effects)
        write_trial(batch, rows, counter.trials)
        rows += write_pair(batch, rows, epoch_start + time, record, ids, i, j, effects)
        collisions += 1
        counter.time = time
        square = too_fast(a, b, fastest_square)
        if square > 0.0:
            break
    counter.events += collisions
    counter.disc_collisions += collisions
    return rows, reached, excess, square


class MonteCarlo(Method):
    """The Monte Carlo method, with the discs and effects of the current epoch."""

    has_positions = False

    def __init__(self, seed: int, v_ref: float, one_sided: bool = False, rises: bool = False) -> None:
        """Set the seed and v_ref, the relative speed at which a pair of the largest discs is always accepted.

        v_ref: length/time. one_sided: whether all impact parameters have the same sign. rises: whether v_ref is raised
        when it is too small; otherwise the run then ends with an error.
        """
        self._seed, self._v_ref, self._one_sided = seed, v_ref, one_sided
        self._extra_state: dict[Column, float] = {V_REF: v_ref} if rises else {}

    @property
    def extra_state(self) -> dict[Column, float]:
        """Reference speed, if it may be raised."""
        return self._extra_state

    @property
    def v_ref(self) -> float:
        """Relative speed at which a pair of the largest discs is always accepted, length/time."""
        return self.extra_state.get(V_REF, self._v_ref)

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin an epoch."""
        super().start(gas, effects)
        self._reach = float(np.sort(gas.radius)[-2:].sum())
        self._trial_time = partial(mean_trial_time, len(gas), gas.area, gas.packing_fraction, self._reach)

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Try pairs (see `advance_trials`); raise UserError if a pair is too fast for the v_ref of the scene."""
        v_ref = self.v_ref
        trials = Trials(
            epoch_key(self._seed, epoch_start),
            self._trial_time(v_ref),
            self._reach * v_ref,
            (FASTEST_DISC * v_ref) ** 2 if V_REF in self.extra_state else None,
            self._one_sided,
        )
        rows, reached, excess, square = advance_trials(
            self.discs, trials, self._effects, limits, epoch_start, batch, counters
        )
        if excess > 0:
            needed = excess / self._reach
            raise UserError(
                f"run.v_ref: too small: an acceptance probability of {needed / v_ref:.4g} in trial "
                f"{counters[0].trials} (got {v_ref:.6g}; allowed >= {needed:.6g}, better {1.25 * needed:.3g})"
            )
        if square > 0:
            self.extra_state[V_REF] = RAISED * math.sqrt(square)
        return rows, reached

    def deepest_overlap(self, gas: Gas, effects: Effects) -> float:
        """Return 0: discs without positions do not overlap."""
        return 0.0


def epoch_key(seed: int, epoch_start: float) -> np.uint64:
    """Return the key of an epoch's random numbers, computed from the seed and the time at which the epoch begins."""
    words = np.array([seed, np.float64(epoch_start).view(np.uint64)], np.uint64)
    return np.random.SeedSequence(words.view(np.uint32).tolist()).generate_state(1, np.uint64)[0]
