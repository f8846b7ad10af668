"""Equilibrium of a gas from its conserved quantities: the temperature and the velocities of each species and axis.

Total energy is conserved, and so is total momentum along axes where no wall or heat bath changes it. Angular momentum
is never conserved, as sides and periodic images exert torques.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idealgas.scene import Scene
from idealgas.state import MOST_PAIRED, Gas
from idealgas.theory import conserved, distributions
from idealgas.theory.barometric import ColumnProfile, barometric_temperature, fixed_energy_column

DIRECTIONS = 128
"""Number of directions over which speeds are averaged if the axes have different temperatures."""


CLASSES = 32
"""Total number of classes into which species of unlike discs are divided."""


class Composition(NamedTuple):
    """Names, radii, masses and numbers of the S kinds of discs of a gas; a kind is a species or a class of its discs.

    Attributes:
        name: species name of each kind.
        radius: (S,), radius of each kind, length.
        mass: (S,), mass of each kind.
        number: (S,), number of discs of each kind.
        species: (S,), index of the species of each kind.
    """

    name: tuple[str, ...]
    radius: np.ndarray
    mass: np.ndarray
    number: np.ndarray
    species: np.ndarray

    @property
    def members(self) -> np.ndarray:
        """Whether each kind belongs to each species, (species, S), 1 or 0."""
        return (self.species == np.arange(self.species.max() + 1)[:, None]).astype(float)

    @property
    def shares(self) -> np.ndarray:
        """Fraction of the discs of each species that belongs to each kind, (species, S)."""
        numbers = self.members * self.number
        return numbers / numbers.sum(axis=1, keepdims=True)

    @property
    def partners(self) -> tuple[str, ...]:
        """Names of the groups between which collisions are counted, in the order of `Gas.partners`."""
        names = tuple(dict.fromkeys(self.name))
        return names if len(names) <= MOST_PAIRED else ("all",)

    def with_partners(self, rates: np.ndarray) -> np.ndarray:
        """Return rates (species, G) of a disc of each species with each group of discs, from rates (S, S) by kind."""
        first = np.flatnonzero(np.diff(self.species, prepend=-1))
        groups = first if len(first) <= MOST_PAIRED else [0]
        weight = self.number / np.add.reduceat(self.number, first)[self.species]
        return np.add.reduceat(weight[:, None] * np.add.reduceat(rates, groups, axis=1), first)

    def packing_fraction(self, density: np.ndarray) -> float:
        """Return the packing fraction φ of a gas whose kinds have number densities `density` (S,), 1/length²."""
        return float(np.pi * (density * self.radius**2).sum())

    @property
    def mass_share_of_others(self) -> np.ndarray:
        """Fraction 1 - m/M of the total mass M that belongs to discs other than one disc of each kind, (S,), no unit.

        The masses of the other discs are summed, so that no digits are lost if one disc is far heavier than all others.
        """
        all_of = self.number * self.mass
        lower = np.append(0.0, np.cumsum(all_of[:-1]))
        higher = np.append(0.0, np.cumsum(all_of[:0:-1]))[::-1]
        other_masses = lower + higher + (self.number - 1) * self.mass
        return other_masses / (other_masses + self.mass)


def composition(gas: Gas) -> Composition:
    """Return the composition of a gas by species; unlike discs of a species are given their mean radius and mass."""
    return _kinds(gas, 1, 1.0)


def classes(gas: Gas) -> Composition:
    """Return the composition of a gas, with species of unlike discs divided by radius into classes of equal size.

    The division preserves the packing fraction and the total mass. The mean of a function of the radius over K classes
    differs from its mean over the discs by about 1/K² of the second-order term in the spread of the radii, whatever the
    number of discs.
    """
    return _kinds(gas, CLASSES, 2.0)


def _kinds(gas: Gas, most: int, power: float) -> Composition:
    """Return the composition with up to `most` kinds of unlike discs, whose radius is (mean R^power)^(1/power)."""
    _, first, number = np.unique(gas.species, return_index=True, return_counts=True)
    species, unlike = np.arange(len(first)), gas.unlike
    if not unlike:
        return Composition(gas.species_names, gas.radius[first], gas.mass[first], number, species)
    order = np.split(np.lexsort((gas.mass, gas.radius, gas.species)), np.cumsum(number)[:-1])
    pieces = [
        min(max(most // len(unlike), 1), n) if name in unlike else 1
        for name, n in zip(gas.species_names, number.tolist(), strict=True)
    ]
    parts = [part for ids, n in zip(order, pieces, strict=True) for part in np.array_split(ids, n)]
    radius = [_mean(gas.radius[part], power) for part in parts]
    mass = [_mean(gas.mass[part], 1.0) for part in parts]
    species = np.repeat(species, pieces)
    names = tuple(gas.species_names[k] for k in species)
    return Composition(names, np.array(radius), np.array(mass), np.array([len(part) for part in parts]), species)


def _mean(values: np.ndarray, power: float) -> float:
    """Return the power mean of positive values; exact if they are equal."""
    return float(values[0] if np.ptp(values) == 0 else (values**power).mean() ** (1 / power))


@dataclass(frozen=True)
class Ensemble:
    """Ensemble of a gas in equilibrium: at fixed energy (and momentum, if conserved), or in a heat bath.

    Attributes:
        centre_of_mass_velocity: (2,), subtracted from all velocities, length/time; 0 along axes where momentum is not
            conserved.
        dof: number D of degrees of freedom of translation and spin that share the energy; infinite in a heat bath.
        temperature: T = 2E/D, energy (k_B = 1).
        discs: kinds of discs, see `classes`.
        of_axes: (S, 2), means of m vx² and m vy² of a disc of each kind, energy. The mean is T along an axis where
            momentum is not conserved, and T(1 - m/M) for a disc of mass m where it is, with M the total mass of all
            discs. It is 0 for fixed discs (`conserved.are_fixed`), which do not acquire their share of the energy in
            any run.
    """

    centre_of_mass_velocity: np.ndarray
    dof: float
    temperature: float
    discs: Composition
    of_axes: np.ndarray

    @property
    def of_species(self) -> np.ndarray:
        """Mean kinetic energy of translation of a disc of each species, (S,), energy."""
        return self.of_axes.mean(axis=1)

    @property
    def mean_speed(self) -> np.ndarray:
        """Mean speed of a disc of each species, (S,), length/time."""
        return np.array([self.velocity_law("speed", s).mean for s in range(len(self.of_axes))])

    @property
    def inverse_mass(self) -> np.ndarray:
        """Mean of 1/m over the discs of each species, (S,), 1/mass."""
        return self.discs.shares @ (1 / self.discs.mass)

    def variances(self, number: np.ndarray) -> np.ndarray:
        """Return the variances at one instant of Σ|v| (length²/time²) and Σ m v² (energy²) over each species, (2, S).

        The variances are those of Gaussian velocities. At fixed energy they are reduced by the part that is explained
        by fluctuations of the energy, the squared covariance with the energy divided by the variance of the energy.

        Args:
            number: (S,), numbers of discs.
        """
        dof = number * self.of_axes.sum(axis=1) / self.temperature
        alone, shared = self.inverse_mass, (self.discs.shares @ self.discs.mass**-0.5) ** 2
        speeds = number * self.temperature * (alone * (2 - math.pi / 2) - shared * math.pi / 8 * dof / self.dof)
        return np.array([speeds, 2 * self.temperature**2 * dof * (1 - dof / self.dof)])

    def of_directions(self, species: int) -> np.ndarray:
        """Return the temperatures T(θ) = Tx cos² θ + Ty sin² θ of a species at evenly spaced angles, energy.

        If Tx = Ty, there is only one temperature. Velocities are √(T(θ)/m) times an isotropic vector, so that
        distributions of speeds are averages over θ.
        """
        x, y = self.of_axes[species]
        if x == y:
            return np.array([x])
        angle = (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS * math.pi / 2
        return x * np.cos(angle) ** 2 + y * np.sin(angle) ** 2

    def velocity_law(self, quantity: str, species: int, dof: float | None = None) -> distributions.Law:
        """Return the distribution of vx, vy, speed or energy of a disc of a species.

        `dof` is the number D of degrees of freedom, by default that of the ensemble; infinity gives the
        Maxwell-Boltzmann distribution.
        """
        dof = self.dof if dof is None else dof
        if quantity in ("vx", "vy"):
            temperatures = [float(self.of_axes[species, "xy".index(quantity[1])])]
        else:
            temperatures = self.of_directions(species).tolist()
        laws: dict[distributions.Law, float] = {}
        for k in np.flatnonzero(self.discs.species == species):
            mass = float(self.discs.mass[k])
            for t in temperatures:
                law: distributions.Law = distributions.EnergyLaw(t, dof)
                if quantity != "energy":
                    law = (distributions.SpeedLaw if quantity == "speed" else distributions.ComponentLaw)(t, mass, dof)
                laws[law] = laws.get(law, 0.0) + float(self.discs.number[k])
        return next(iter(laws)) if len(laws) == 1 else distributions.MeanLaw(tuple(laws), tuple(laws.values()))


def equilibrium(scene: Scene, gas: Gas, spin_energy: float) -> Ensemble | None:
    """Return the ensemble of a gas; None if its energy is neither conserved nor set by a single temperature.

    The result is also None for a single disc with conserved momentum, because none of its energy is heat, and for a
    single disc whose spin contains some of the energy.

    Args:
        scene: scene of the gas.
        gas: initial state of the gas.
        spin_energy: initial energy of the spins of all discs, energy.
    """
    properties = scene.properties
    if not properties.conserves_energy or properties.varies or len(properties.temperatures) > 1:
        return None
    dof, energy = _shared(scene, gas, spin_energy)
    if dof == 0 or (len(gas) == 1 and properties.isolated and properties.spins):
        return None
    if properties.temperatures:  # a heat bath does not fix the energy
        return ensemble_at(scene, gas, min(properties.temperatures), math.inf)
    return ensemble_at(scene, gas, 2 * energy / dof, dof)


def ensemble_at(scene: Scene, gas: Gas, temperature: float, dof: float) -> Ensemble:
    """Return the ensemble of a gas of known temperature T (energy) and known number of degrees of freedom."""
    discs, kept = composition(gas), conserved.conserved_momentum(scene)
    fixed = conserved.are_fixed(discs.mass) & (scene.properties.bath is None)  # a heat bath heats fixed discs too
    share_of_others = discs.mass_share_of_others[:, None]
    share = np.where(kept, share_of_others, 1.0)
    share[fixed] = np.where(
        kept & (discs.number[fixed].sum() == 1), share_of_others[fixed], 0.0
    )  # a single fixed disc recoils
    return Ensemble(conserved.centre_of_mass_velocity(scene, gas), dof, temperature, classes(gas), temperature * share)


def column_temperature(scene: Scene, gas: Gas, spin_energy: float, axis: int) -> float | None:
    """Return the equilibrium temperature (energy, k_B = 1) of a gas under gravity along `axis`, 0 for x or 1 for y.

    It is the temperature of thermal walls or of a thermostat. Without them, it is the temperature at which a dilute gas
    with the barometric distribution has the conserved initial energy (translation, spin and gravity). The result is
    None if other effects make the temperature unpredictable, and for discs that cannot share their energy.
    """
    properties = scene.properties
    if (
        any(properties.free_fall_axes)
        or not properties.fixed_walls
        or not properties.collisions_conserve_energy
        or properties.varies
    ):
        return None
    if len(gas) == 1 or not properties.shares_energy:
        return None
    if baths := properties.temperatures:
        return min(baths) if len(baths) == 1 else None
    column = _column(scene, gas, spin_energy, axis)
    return barometric_temperature(*column) if column[0] > 0 else None


def column_profiles(scene: Scene, gas: Gas, spin_energy: float, axis: int) -> list[ColumnProfile]:
    """Return the density and temperature profiles of each species of an isolated column."""
    return fixed_energy_column(*_column(scene, gas, spin_energy, axis))


def _column(
    scene: Scene, gas: Gas, spin_energy: float, axis: int
) -> tuple[float, int, np.ndarray, np.ndarray, float, np.ndarray]:
    """Return the arguments of `barometric_temperature` for a gas under gravity along `axis`."""
    dof, energy = _shared(scene, gas, spin_energy)
    g, place = scene.properties.acceleration[axis], gas.position[:, axis]
    above = place if g < 0 else gas.box[axis] - place
    energy += abs(g) * float(gas.mass @ (above - gas.radius))
    _, radius, mass, number, _ = classes(gas)
    return energy, dof, mass, number, abs(g), gas.box[axis] - 2 * radius


def _shared(scene: Scene, gas: Gas, spin_energy: float) -> tuple[int, float]:
    """Return the number D of degrees of freedom that share the energy of translation and spin, and this energy."""
    dof = conserved.degrees_of_freedom(scene, gas)
    frame = conserved.centre_of_mass_velocity(scene, gas)
    energy = float(gas.mass @ ((gas.velocity - frame) ** 2).sum(axis=1)) / 2
    if scene.properties.spins:
        return dof + int((~conserved.are_fixed(gas.mass)).sum()), energy + spin_energy
    return dof, energy
