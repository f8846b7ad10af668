"""The Monte Carlo method: discs of a homogeneous gas, without positions, that collide at random.

Trials are a Poisson process; each takes any pair and accepts it in the ratio of its collision rate to the largest
possible one, so that collisions happen exactly at the rates of their pairs. Such a process has no memory: an epoch
begins with a new waiting time and with random numbers of its own, keyed by the seed and the epoch's start. So the
velocities alone are enough to continue a run.
"""

import math

import numpy as np

from idealgas._jit import inline, njit
from idealgas.engine.records import Limits, make_discs
from idealgas.engine.resolve import energy_of_pair, record_pair_loss
from idealgas.engine.rows import batch_capacity, write_pair, write_trial
from idealgas.errors import UserError
from idealgas.events import EventBatch
from idealgas.gas.state import Gas
from idealgas.physics.disc_disc import collide
from idealgas.physics.effects import Effects
from idealgas.physics.periodic import NO_IMAGES
from idealgas.physics.random_numbers import GOLDEN, mix, unit_interval
from idealgas.physics.random_pair import mean_trial_time, touch_at_random
from idealgas.physics.restitution import record_collision

U = np.uintp
DRAWS = np.uint64(5)  # random numbers reserved for a trial


@inline
def draw(start, k):
    """Random number in (0, 1] of a trial; start: counter of the trial, k: index of the number."""
    return unit_interval(mix(start + np.uint64(k) * GOLDEN))


@inline
def random_pair(number, start):
    """Two different indices of discs, all pairs with the same probability; start: counter of the trial."""
    i = np.int64(number * (1.0 - draw(start, 1)))
    j = np.int64((number - 1) * (1.0 - draw(start, 2)))
    return i, j + (j >= i)


@inline
def collide_at_random(record, ids, i, j, time, offset, effects):
    """Collide discs i and j at a local time; offset: impact parameter divided by the sum of the radii."""
    a = record[U(i)]
    b = record[U(j)]
    touch_at_random(a, b, offset)
    a.t = time
    b.t = time
    energy = energy_of_pair(a, b, ids[U(i)], ids[U(j)], effects.rotation, effects.dissipated)
    collide(a, b, ids[U(i)], ids[U(j)], effects.restitution, effects.rotation, None, NO_IMAGES)
    energy -= energy_of_pair(a, b, ids[U(i)], ids[U(j)], effects.rotation, effects.dissipated)
    record_pair_loss(effects.dissipated, energy)
    record_collision(effects.restitution, ids[U(i)], time)
    record_collision(effects.restitution, ids[U(j)], time)


@njit
def advance_trials(
    record, ids, effects, until, most_collisions, most_trials,
    key, trial_time, fastest, one_sided, epoch_start, batch, counters,
):  # fmt: skip
    """Try pairs up to local time `until`, or to a limit, or until the batch is full.

    Returns the number of rows written, whether everything up to `until` has happened, and a rate: relative speed times
    sum of the radii (length²/time) of a pair that exceeds `fastest`, else 0.

    most_collisions, most_trials: numbers still allowed. key: of the epoch's random numbers. trial_time: mean time
    between trials. fastest: largest relative speed times sum of the radii, length²/time. one_sided: whether impact
    parameters have one sign only. batch: None where no log is kept. counters: (1,) COUNTERS, updated.
    """
    counter = counters[0]
    number = record.shape[0]
    capacity = batch_capacity(batch)
    last_trial = counter.trials + most_trials
    collisions = 0
    rows = 0
    reached = False
    excess = 0.0
    while collisions < most_collisions and counter.trials < last_trial and rows < capacity:
        start = key + GOLDEN * DRAWS * np.uint64(counter.trials)
        time = counter.trial_time - trial_time * math.log(draw(start, 0))
        if time > until:
            reached = True
            break
        counter.trial_time = time
        counter.trials += 1
        i, j = random_pair(number, start)
        a = record[U(i)]
        b = record[U(j)]
        speed = math.sqrt((a.vx - b.vx) ** 2 + (a.vy - b.vy) ** 2)
        rate = (a.r + b.r) * speed
        if rate > fastest:
            excess = rate
            break
        if draw(start, 3) * fastest > rate:
            continue
        offset = draw(start, 4)
        collide_at_random(record, ids, i, j, time, offset if one_sided else 2.0 * offset - 1.0, effects)
        write_trial(batch, rows, counter.trials)
        rows += write_pair(batch, rows, epoch_start + time, record, ids, i, j, effects)
        collisions += 1
        counter.time = time
    counter.events += collisions
    counter.disc_collisions += collisions
    return rows, reached, excess


class MonteCarlo:
    """The Monte Carlo method: its records and effects between the start and the end of an epoch."""

    without_positions = True
    single_epoch = False

    def __init__(self, seed: int, v_ref: float, one_sided: bool = False) -> None:
        """Set the seed and v_ref, the relative speed at which a pair of the largest discs is accepted for certain.

        v_ref: length/time. one_sided: whether impact parameters have one sign only.
        """
        self._seed, self._v_ref, self._one_sided = seed, v_ref, one_sided

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin an epoch."""
        self.discs = make_discs(gas, np.arange(len(gas)))
        self._effects = effects
        self._reach = float(np.sort(gas.radius)[-2:].sum())
        self._trial_time = mean_trial_time(len(gas), gas.area, gas.packing_fraction, self._reach, self._v_ref)

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Try pairs, see `advance_trials`; UserError if a pair is faster than v_ref allows."""
        record, ids, _ = self.discs
        rows, reached, excess = advance_trials(
            record, ids, self._effects, limits.until, min(limits.events, limits.collisions), limits.trials,
            epoch_key(self._seed, epoch_start), self._trial_time, self._reach * self._v_ref, self._one_sided,
            epoch_start, batch, counters,
        )  # fmt: skip
        if excess > 0:
            needed = excess / self._reach
            raise UserError(
                f"run.v_ref: too small: an acceptance of {needed / self._v_ref:.4g} in trial {counters[0].trials} "
                f"(got {self._v_ref:.6g}; allowed >= {needed:.6g}, better {1.25 * needed:.3g})"
            )
        return rows, reached

    def deepest_overlap(self) -> float:
        """Always 0: discs without positions do not overlap."""
        return 0.0


def epoch_key(seed: int, epoch_start: float) -> np.uint64:
    """Key of an epoch's random numbers, from the seed and the epoch's start (time)."""
    words = np.array([seed, np.float64(epoch_start).view(np.uint64)], np.uint64)
    return np.random.SeedSequence(words.view(np.uint32).tolist()).generate_state(1, np.uint64)[0]
