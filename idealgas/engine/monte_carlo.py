"""The Monte Carlo method: discs of a homogeneous gas, without positions, that meet at random.

Trials come as a Poisson process; each takes any pair and accepts it in the ratio of its collision rate to the largest
there may be, so that the gas jumps exactly at the rates of its pairs. Such a process has no memory: an epoch begins
with a fresh wait and with random numbers of its own, keyed by the seed and the epoch's start. Nothing but velocities
has to be kept to go on from there.
"""

import math

import numpy as np

from idealgas._jit import inline, njit
from idealgas.engine.records import Limits, make_discs
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
DRAWS = np.uint64(5)  # random numbers a trial may need


@inline
def draw(start, k):
    """Number k of a trial, in (0, 1]."""
    return unit_interval(mix(start + np.uint64(k) * GOLDEN))


@inline
def random_pair(number, start):
    """Two different places, all pairs alike."""
    i = np.int64(number * (1.0 - draw(start, 1)))
    j = np.int64((number - 1) * (1.0 - draw(start, 2)))
    return i, j + (j >= i)


@inline
def collide_at_random(record, ids, i, j, time, offset, effects):
    """A trial is accepted; offset: impact parameter over the sum of the radii."""
    a = record[U(i)]
    b = record[U(j)]
    touch_at_random(a, b, offset)
    a.t = time
    b.t = time
    collide(a, b, ids[U(i)], ids[U(j)], effects.restitution, effects.rotation, None, NO_IMAGES)
    record_collision(effects.restitution, ids[U(i)], time)
    record_collision(effects.restitution, ids[U(j)], time)


@njit
def advance_trials(
    record, ids, effects, until, most_collisions, most_trials,
    key, trial_time, fastest, one_sided, epoch_start, batch, counters,
):  # fmt: skip
    """Try pairs up to local time `until`, or to a limit, or until the batch is full.

    Return the number of rows written, whether everything up to `until` has happened, and 0, or the relative speed
    times the sum of the radii of a pair that has more than `fastest` of it.

    key: of the epoch's random numbers. trial_time: mean. batch: None where no log is kept. counters: (1,) COUNTERS,
    updated.
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
    """The method as an object: what an epoch needs between its start and its end."""

    without_positions = True
    single_epoch = False

    def __init__(self, seed: int, v_ref: float, one_sided: bool = False) -> None:
        """v_ref: relative speed at which a pair of the largest discs is accepted for certain.

        one_sided: impact parameters of one sign only.
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
        """See `advance_trials`. UserError if a pair is faster than v_ref allows."""
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
        """None: nobody is anywhere."""
        return 0.0


def epoch_key(seed: int, epoch_start: float) -> np.uint64:
    """Where the random numbers of an epoch begin."""
    words = np.array([seed, np.float64(epoch_start).view(np.uint64)], np.uint64)
    return np.random.SeedSequence(words.view(np.uint32).tolist()).generate_state(1, np.uint64)[0]
