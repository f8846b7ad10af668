"""The effects of a scene in a run: their states at time 0."""

import numpy as np

from idealgas.effects import EFFECTS
from idealgas.effects.bundle import Effects, inner_energy, present
from idealgas.effects.effect import Start
from idealgas.run.sums import with_sums
from idealgas.scene import Scene
from idealgas.state import Gas


def make_effects(scene: Scene, gas: Gas) -> Effects:
    """Effects of a scene at time 0, None for absent ones; gas: its discs at time 0."""
    scene = scene.resolved()
    start = Start(gas, scene.scene.seed, scene.properties.acceleration, *_spins(scene))
    effects = Effects(**{effect.field: effect.make(scene.tables_of(effect), start) for effect in EFFECTS})
    gives = any(effect.gives_energy(state) for effect, state in present(effects))
    loses = any(effect.loses_energy(state) for effect, state in present(effects))
    inner = inner_energy(effects, gas)
    return with_sums(effects, scene, gas, gives_energy=gives, loses_energy=loses, inner_energy=inner)


def _spins(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Angular velocity (N,), 1/time, and temperature of the spins (N,), energy, of each disc; 0 where not given."""
    count = [1] * len(scene.disc) + [s.count for s in scene.species]
    velocity = [d.angular_velocity or 0.0 for d in scene.disc] + [s.angular_velocity or 0.0 for s in scene.species]
    temperature = [0.0] * len(scene.disc) + [s.spin_temperature or 0.0 for s in scene.species]
    return np.repeat(velocity, count), np.repeat(temperature, count)
