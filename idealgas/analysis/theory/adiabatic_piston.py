"""Relaxation of two gases of equal pressure towards one temperature through a piston between them.

The piston has no temperature of its own and conducts no heat, but its velocity fluctuates: each gas pulls it to its own
temperature (Gruber and Piasecki, Physica A 268, 412 (1999); Munakata and Ogawa, Phys. Rev. E 64, 036119 (2001)).
"""

import math

import numpy as np


def conductance(
    temperature: float | np.ndarray, of_piston: float, force: float | np.ndarray, m: float | np.ndarray, mass: float
) -> np.ndarray:
    """Energy that gases give to a piston per time and difference of their temperature from its own, 1/time.

    For Maxwellian velocities of discs and piston and uncorrelated hits it is 4 m M/(m + M)² F σ/(T √(2π)) with the
    force F of a gas of temperature T on the piston of temperature T_P, and σ² = T/m + T_P/M.

    Args:
        temperature: of the gases, energy.
        of_piston: temperature of the motion of the piston, energy.
        force: of each gas on the piston, energy/length.
        m: mass of a disc of each gas.
        mass: of the piston, M.
    """
    share = 4 * m * mass / (m + mass) ** 2 / math.sqrt(2 * math.pi)
    return np.asarray(share * force * np.sqrt(temperature / m + of_piston / mass) / temperature)


def slowest_rate(conductance: np.ndarray, capacity: np.ndarray) -> float:
    """Slowest rate at which the temperatures of gases in a row become equal, 1/time; 0 if no energy passes.

    Args:
        conductance: (K,), of the pistons between the gases, from one gas to the next, 1/time.
        capacity: (K + 1,), heat capacities of the gases at constant pressure, no unit; 0 for a vacuum.
    """
    rates = np.zeros((len(capacity), len(capacity)))
    scale = 1 / np.sqrt(np.maximum(capacity, 1.0))
    for k, each in enumerate(conductance):
        both = np.zeros(len(capacity))
        both[k], both[k + 1] = scale[k], -scale[k + 1]
        rates += each * np.outer(both, both)
    eigenvalues = np.linalg.eigvalsh(rates)
    rounding = 1e-9 * max(float(eigenvalues[-1]), np.finfo(float).tiny)  # of the 0 that belongs to equal temperatures
    slow = eigenvalues[eigenvalues > rounding]
    return float(slow.min(initial=math.inf)) if len(slow) else 0.0


def heat_flow(temperature: np.ndarray, force: float, m: float, mass: float) -> np.ndarray:
    """Energy (2,) that each of two gases takes from a piston with no mean velocity, energy/time.

    At its temperature T_P the piston takes as much from one gas as it gives to the other, by `conductance`.

    Args:
        temperature: (2,), of the gases, energy.
        force: of each gas on the piston, energy/length.
        m: mass of a disc.
        mass: of the piston, M.
    """
    of_piston = math.sqrt(temperature[0] * temperature[1])
    for _ in range(8):
        weight = conductance(temperature, of_piston, force, m, mass)
        of_piston = float(weight @ temperature / weight.sum())
    return conductance(temperature, of_piston, force, m, mass) * (of_piston - temperature)


def relaxation(
    first: np.ndarray, number: np.ndarray, m: float, mass: float, z: float, length: float, time: np.ndarray
) -> np.ndarray:
    """Temperatures (2, F) of two gases of equal pressure at times (F,), the first of which is the start.

    The force of each gas on the piston, Z E/L, does not change with the total energy E, and the piston moves as heat
    expands one gas: of the heat a part Z/(1 + Z) is given back as work.

    Args:
        first: (2,), temperatures at the start, energy.
        number: (2,), numbers of discs.
        m: mass of a disc.
        mass: of the piston.
        z: compressibility factor Z of the gases.
        length: that the centres of the discs of both gases have together.
        time: (F,).
    """
    force = z * float(number @ first) / length

    def rate(temperature: np.ndarray) -> np.ndarray:
        return np.asarray(heat_flow(temperature, force, m, mass) / (1 + z) / number)

    found = [np.asarray(first, float)]
    for step in np.diff(time):  # Runge and Kutta
        t = found[-1]
        k1 = rate(t)
        k2 = rate(t + step / 2 * k1)
        k3 = rate(t + step / 2 * k2)
        k4 = rate(t + step * k3)
        found.append(t + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return np.array(found).T
