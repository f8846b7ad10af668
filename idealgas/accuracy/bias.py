"""Bias of a quantity due to time steps, a dt + b dt².

The first term arises because contacts are detected half a step late on average. The second term includes the pairs that
pass through each other because no step ends while they overlap and still approach.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from idealgas.statistics.estimates import Estimate

LARGEST = 0.1  # largest bias that is included in a fit
FEWEST = 3  # smallest number of time steps for a fit
CLEAR = 3.0  # number of standard errors above which a bias is significant


class BiasLaw(NamedTuple):
    """Relative bias a dt + b dt².

    Attributes:
        first: a, 1/time.
        second: b, 1/time².
        error: standard error of a.
    """

    first: float
    second: float
    error: float

    def step(self, target: float) -> float:
        """Return the smallest time step at which the magnitude of the bias is `target`."""
        roots = np.concatenate([np.roots([self.second, self.first, sign * target]) for sign in (-1, 1)])
        return float(min(root.real for root in roots if abs(root.imag) < 1e-9 * abs(root) and root.real > 0))


def bias_law(dt: np.ndarray, biases: Sequence[Estimate]) -> BiasLaw | None:
    """Fit the bias law to independent biases at time steps (n,).

    Biases above LARGEST are excluded. The result is None if too few remain or none of them is significant.
    """
    value, error = np.array([(bias.value, bias.standard_error) for bias in biases]).reshape(-1, 2).T
    near = (abs(value) < LARGEST) & (error > 0)
    if near.sum() < FEWEST or not (abs(value[near]) > CLEAR * error[near]).any():
        return None
    weights = _fit(dt[near], error[near], (1, 2))
    first, second = weights @ value[near]
    return BiasLaw(float(first), float(second), float(np.linalg.norm(weights[0] * error[near])))


def rate_biases(dt: np.ndarray, rates: Sequence[Estimate]) -> tuple[list[Estimate], BiasLaw | None]:
    """Return the biases of independent rates at time steps (n,) relative to the limit dt → 0, and their law.

    The first rate is that of the event-driven run, with dt = 0. The limit is the constant R in R (1 + a dt + b dt²),
    fitted to all rates with a bias of up to LARGEST, so that the error of the event-driven run is not part of every
    bias.
    """
    value, error = np.array([(rate.value, rate.standard_error) for rate in rates]).T
    if not (error > 0).all():
        return [], None
    near = abs(value / value[0] - 1) < LARGEST
    if enough := near.sum() > FEWEST:
        weights = np.zeros((3, len(dt)))
        weights[:, near] = _fit(dt[near], error[near], (0, 1, 2))
    else:
        weights = np.eye(3, len(dt))
    limit, first, second = weights @ value
    spread = np.eye(len(dt)) - np.outer(value / limit, weights[0])
    errors = np.linalg.norm(spread * error, axis=1) / limit
    biases = [Estimate(float(v / limit - 1), float(e), math.inf) for v, e in zip(value, errors, strict=True)]
    first_error = np.linalg.norm((weights[1] - first / limit * weights[0]) * error) / limit
    is_clear = (abs(value / limit - 1) > CLEAR * errors)[near].any()
    return biases, BiasLaw(
        float(first / limit), float(second / limit), float(first_error)
    ) if enough and is_clear else None


def _fit(dt: np.ndarray, error: np.ndarray, powers: tuple[int, ...]) -> np.ndarray:
    """Return weights (powers, n); times values (n,) with these errors, they give the coefficients of powers of dt."""
    columns = np.stack([dt**power for power in powers], axis=1)
    scale = np.linalg.norm(columns, axis=0)
    return np.linalg.pinv(columns / scale / error[:, None]) / scale[:, None] / error
