"""Relaxation of two gases at equal pressure to a common temperature through the piston between them.

The piston conducts no heat, but its velocity fluctuates, and each gas drives these fluctuations towards its own
temperature (Gruber and Piasecki, Physica A 268, 412 (1999); Munakata and Ogawa, Phys. Rev. E 64, 036119 (2001)).
"""

import math

import numpy as np


def conductance(
    temperature: float | np.ndarray, of_piston: float, force: float | np.ndarray, m: float | np.ndarray, mass: float
) -> np.ndarray:
    """Return the energy that each gas gives to a piston per unit time and temperature difference, 1/time.

    If the velocities of discs and piston are Maxwellian and hits are uncorrelated, this conductance is
    4 m M/(m + M)² F σ/(T √(2π)), where F is the force of a gas of temperature T on the piston of temperature T_P, and
    σ² = T/m + T_P/M.

    Args:
        temperature: temperature T of each gas, energy.
        of_piston: temperature T_P of the motion of the piston, energy.
        force: force F of each gas on the piston, energy/length.
        m: mass of a disc of each gas.
        mass: mass M of the piston.
    """
    share = 4 * m * mass / (m + mass) ** 2 / math.sqrt(2 * math.pi)
    return np.asarray(share * force * np.sqrt(temperature / m + of_piston / mass) / temperature)


def slowest_rate(conductance: np.ndarray, capacity: np.ndarray) -> float:
    """Return the slowest rate at which the temperatures of gases in a row equalise; 0 if they exchange no energy.

    The rate has unit 1/time.

    Args:
        conductance: (K,), conductance of the piston between each gas and the next, 1/time.
        capacity: (K + 1,), heat capacity of each gas at constant pressure, no unit; 0 for a vacuum.
    """
    rates = np.zeros((len(capacity), len(capacity)))
    scale = 1 / np.sqrt(np.maximum(capacity, 1.0))
    for k, each in enumerate(conductance):
        both = np.zeros(len(capacity))
        both[k], both[k + 1] = scale[k], -scale[k + 1]
        rates += each * np.outer(both, both)
    eigenvalues = np.linalg.eigvalsh(rates)
    rounding = 1e-9 * max(float(eigenvalues[-1]), np.finfo(float).tiny)  # error of eigenvalue 0: equal temperatures
    slow = eigenvalues[eigenvalues > rounding]
    return float(slow.min(initial=math.inf)) if len(slow) else 0.0


def heat_flow(temperature: np.ndarray, force: float, m: float, mass: float) -> np.ndarray:
    """Return the energy per time that each of two gases receives from a piston with zero mean velocity, (2,).

    The unit is energy/time. The temperature of the piston is such that the piston receives as much energy from one gas
    as it gives to the other; both follow from `conductance`.

    Args:
        temperature: (2,), temperatures of the gases, energy.
        force: force of each gas on the piston, energy/length.
        m: mass of a disc.
        mass: mass M of the piston.
    """
    of_piston = math.sqrt(temperature[0] * temperature[1])
    for _ in range(8):
        weight = conductance(temperature, of_piston, force, m, mass)
        of_piston = float(weight @ temperature / weight.sum())
    return conductance(temperature, of_piston, force, m, mass) * (of_piston - temperature)


def relaxation(
    first: np.ndarray, number: np.ndarray, m: float, mass: float, z: float, length: float, time: np.ndarray
) -> np.ndarray:
    """Return the temperatures (2, F) of two gases at equal pressure at times (F,), the first of which is the start.

    The force of each gas on the piston, Z E/L, depends only on the conserved total energy E. As heat expands one gas,
    the piston moves, and a fraction Z/(1 + Z) of the heat is returned as work.

    Args:
        first: (2,), initial temperatures, energy.
        number: (2,), numbers of discs.
        m: mass of a disc.
        mass: mass of the piston.
        z: compressibility factor Z of the gases.
        length: total length L available to the centres of the discs of both gases.
        time: (F,), times.
    """
    force = z * float(number @ first) / length

    def rate(temperature: np.ndarray) -> np.ndarray:
        return np.asarray(heat_flow(temperature, force, m, mass) / (1 + z) / number)

    temperatures = [np.asarray(first, float)]
    for step in np.diff(time):  # Runge-Kutta
        t = temperatures[-1]
        k1 = rate(t)
        k2 = rate(t + step / 2 * k1)
        k3 = rate(t + step / 2 * k2)
        k4 = rate(t + step * k3)
        temperatures.append(t + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return np.array(temperatures).T
