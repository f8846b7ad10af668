"""Bias of a quantity by time steps: a dt + b dt², as contacts are found half a step late and the fastest are missed."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from idealgas.analysis.core.statistics import Estimate

LARGEST = 0.1  # largest bias that counts as a dt + b dt²
FEWEST = 3  # time steps from which a law is fitted
CLEAR = 3.0  # standard errors beyond which a bias is significant


class BiasLaw(NamedTuple):
    """Relative bias a dt + b dt². first, second: a (1/time) and b (1/time²). error: standard error of a."""

    first: float
    second: float
    error: float

    def step(self, target: float) -> float:
        """Least time step with a bias of a size."""
        roots = np.concatenate([np.roots([self.second, self.first, sign * target]) for sign in (-1, 1)])
        return float(min(root.real for root in roots if abs(root.imag) < 1e-9 * abs(root) and root.real > 0))


def bias_law(dt: np.ndarray, biases: Sequence[Estimate]) -> BiasLaw | None:
    """Law of independent biases at time steps (n,), of those up to LARGEST; None if they are few or not significant."""
    value, error = np.array([(one.value, one.standard_error) for one in biases]).reshape(-1, 2).T
    near = (abs(value) < LARGEST) & (error > 0)
    if near.sum() < FEWEST or not (abs(value[near]) > CLEAR * error[near]).any():
        return None
    weights = _fit(dt[near], error[near], (1, 2))
    first, second = weights @ value[near]
    return BiasLaw(float(first), float(second), float(np.linalg.norm(weights[0] * error[near])))


def rate_biases(dt: np.ndarray, rates: Sequence[Estimate]) -> tuple[list[Estimate], BiasLaw | None]:
    """Relative biases of independent rates at time steps (n,) against their limit at dt = 0, and their law.

    The first rate is that of the event-driven run, dt = 0. The limit is the constant of R (1 + a dt + b dt²) fitted to
    all rates with a bias up to LARGEST, so that the error of the event-driven run is not that of all biases.
    """
    value, error = np.array([(one.value, one.standard_error) for one in rates]).T
    if not (error > 0).all():
        return [], None
    near = abs(value / value[0] - 1) < LARGEST
    if enough := near.sum() > FEWEST:
        found = np.zeros((3, len(dt)))
        found[:, near] = _fit(dt[near], error[near], (0, 1, 2))
    else:
        found = np.eye(3, len(dt))
    limit, first, second = found @ value
    spread = np.eye(len(dt)) - np.outer(value / limit, found[0])
    errors = np.linalg.norm(spread * error, axis=1) / limit
    biases = [Estimate(float(v / limit - 1), float(e), math.inf) for v, e in zip(value, errors, strict=True)]
    of_first = np.linalg.norm((found[1] - first / limit * found[0]) * error) / limit
    is_clear = (abs(value / limit - 1) > CLEAR * errors)[near].any()
    return biases, BiasLaw(
        float(first / limit), float(second / limit), float(of_first)
    ) if enough and is_clear else None


def _fit(dt: np.ndarray, error: np.ndarray, powers: tuple[int, ...]) -> np.ndarray:
    """Weights (powers, n) by which values with errors (n,) give the coefficients of powers of dt."""
    columns = np.stack([dt**power for power in powers], axis=1)
    scale = np.linalg.norm(columns, axis=0)
    return np.linalg.pinv(columns / scale / error[:, None]) / scale[:, None] / error
