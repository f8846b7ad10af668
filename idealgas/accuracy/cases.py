"""Cases whose accuracy is compared: methods, time steps and precisions, and how a gas is run in each case."""

import copy
import time
from dataclasses import dataclass

import numpy as np

from idealgas.effects.bundle import Effects
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.multiprecision import PreciseBruteForce
from idealgas.engine.simulation import Method, Simulation, Stop
from idealgas.engine.time_driven import TimeDriven
from idealgas.initial.build import make_gas
from idealgas.run.effects import make_effects
from idealgas.scene import Scene, parse_scene
from idealgas.state import Gas
from idealgas.toml.dump import dump_document

FIRST_STEP = 0.5  # distance that a disc of root-mean-square speed moves in the longest step, diameters
STEPS = 8  # number of time steps, each half as long as the previous one
PRECISIONS = ("float32", "float64", "double-double")
EQUILIBRATION = 10.0  # collisions per disc after which a gas is considered equilibrated


@dataclass(frozen=True)
class Case:
    """A case in the comparison: a way to run a scene.

    Attributes:
        method: name of the method.
        dt: time step of the time-driven method, time.
        precision: arithmetic of the brute-force method.
    """

    method: str
    dt: float | None = None
    precision: str | None = None

    @property
    def name(self) -> str:
        """Name of the case in tables and figures."""
        return f"dt = {self.dt:.3g}" if self.dt is not None else self.precision or "event-driven"

    def make(self) -> Method:
        """Return a new method object for this case."""
        if self.dt is not None:
            return TimeDriven(self.dt)
        return PreciseBruteForce(self.precision) if self.precision else EventDriven()

    def scene(self, scene: Scene, until: float) -> Scene:
        """Return the scene for a run of this case until a given time, without other stop conditions.

        Raises:
            SceneError: if the scene cannot be run with this method.
        """
        ends = (f"run.until={until!r}", "run.events=", "run.collisions_per_disc=", "run.dt=", "run.precision=")
        settings = [f'run.method="{self.method}"', *ends, "log.events=true", "log.snapshot_every="]
        if self.dt is not None:
            settings.append(f"run.dt={self.dt!r}")
        if self.precision is not None:
            settings.append(f'run.precision="{self.precision}"')
        return parse_scene(dump_document(scene), f"{scene.scene.title or 'scene'}, {self.name}", settings)


@dataclass(frozen=True)
class EquilibratedStart:
    """Equilibrated gas with its effects, from which all cases start."""

    gas: Gas
    effects: Effects

    def simulation(self, method: Method) -> Simulation:
        """Return a simulation from this start with the given method and a copy of the effects."""
        return Simulation(self.gas, method, copy.deepcopy(self.effects))


def compared_cases(gas: Gas, precise: bool) -> list[Case]:
    """Return the cases for a gas: event-driven, time steps from long to short, and brute force in all precisions.

    Args:
        gas: the gas.
        precise: whether to include brute force.
    """
    speed = float(np.sqrt((gas.velocity**2).sum(axis=1).mean()))
    first = FIRST_STEP * 2 * float(gas.radius.min()) / speed
    steps = [Case("time_driven", dt=float(f"{first / 2**k:.3g}")) for k in range(STEPS)]
    return [
        Case("event_driven"),
        *steps,
        *(Case("brute_force", precision=precision) for precision in PRECISIONS if precise),
    ]


def equilibrated(scene: Scene) -> EquilibratedStart:
    """Return the gas of a scene after EQUILIBRATION collisions per disc with the event-driven method."""
    gas = make_gas(scene)
    simulation = Simulation(gas, EventDriven(), make_effects(scene, gas))
    stop = Stop(disc_collisions=round(EQUILIBRATION * len(gas) / 2), events=round(20 * EQUILIBRATION * len(gas)))
    simulation.run(stop)
    gas, effects = simulation.state()
    return EquilibratedStart(gas, effects)


def cpu_seconds(simulation: Simulation, until: float) -> float:
    """Run a simulation until a given time and return the CPU time of this thread, s."""
    started = time.thread_time()
    simulation.run(pause=until)
    return time.thread_time() - started
