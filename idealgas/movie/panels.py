"""Panels beside the discs of a film: their speeds, their density, or the fraction of discs on the right-hand side."""

from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch

from idealgas.log import LogState
from idealgas.presentation.style import COLOURS
from idealgas.scene import Scene
from idealgas.scene.walls import walls_inside
from idealgas.state import Gas
from idealgas.theory.distributions import SpeedLaw
from idealgas.theory.ensemble import classes

BINS = 36

FASTEST, BRIGHTEST = 3.2, 2.0
"""Upper ends of the speed axis and of the colour scale, in units of the root-mean-square speed."""

STRIP = 9  # height of the strip with the colours, pixels


class FilmPanel(Protocol):
    """Panel of a film. handles: entries for its legend."""

    handles: list[Line2D]

    def update(self, state: LogState, speed: np.ndarray) -> Iterable[Artist]:
        """Return the artists to be drawn for a state. speed: (N,), speeds of the discs."""


class SpeedPanel:
    """Distribution of speeds, with the Maxwell-Boltzmann distribution if the gas tends to it."""

    def __init__(self, axes: Axes, gas: Gas, rms_speed: float, line: str | None, shades: np.ndarray | None) -> None:
        """Draw the axes.

        rms_speed: largest root-mean-square speed, length/time. line: colour of the Maxwell-Boltzmann curve; None for no
        curve. shades: (n, 4), colours along the axis of speeds; None if the colours of the discs do not show speeds.
        """
        self._gas, self._classes = gas, classes(gas)
        top = FASTEST * rms_speed or 1.0
        self._edges, self._speeds = np.linspace(0, top, BINS + 1), np.linspace(0, top, 200)
        temperature = (top / FASTEST) ** 2 / 2 / float((1 / gas.mass).mean())  # ⟨v²⟩ over all discs is 2T ⟨1/m⟩
        highest = 1.8 * self._density(temperature).max()
        axes.set(xlim=(0, top), ylim=(0, highest or 1.0), ylabel="density (time/length)", xlabel="speed (length/time)")
        self._bars = _bars(axes, self._edges)
        self._curves = axes.plot(self._speeds, self._density(1.0), color=line, animated=True) if line else []
        self.handles = [Line2D([], [], color=line, label="Maxwell-Boltzmann")] if line else []
        if shades is not None:
            high = STRIP / (axes.bbox.height * 100 / axes.figure.dpi)
            strip = axes.inset_axes((0, -high, 1, high))
            shown = np.minimum(np.linspace(0, FASTEST / BRIGHTEST, 200), 1) * (len(shades) - 1)
            strip.imshow(shades[shown.astype(int)][None], aspect="auto")
            strip.set_axis_off()
            axes.tick_params(axis="x", pad=12, length=0)

    def update(self, state: LogState, speed: np.ndarray) -> Iterable[Artist]:
        """Update the bars, and the curve for the temperature of the state."""
        here = speed[state.inside]
        self._bars.set_data(np.histogram(here, self._edges)[0] / (max(len(here), 1) * self._edges[1]))
        for curve in self._curves:
            curve.set_ydata(self._density(state.mean(self._gas.mass * speed**2) / 2))
        return self._bars, *self._curves

    def _density(self, temperature: float) -> np.ndarray:
        """Return the probability density of the speeds of all discs in equilibrium at a temperature, time/length."""
        if not temperature > 0:
            return np.zeros_like(self._speeds)
        shares = self._classes.number / self._classes.number.sum()
        kinds = zip(shares, self._classes.mass.tolist(), strict=True)
        return sum((share * SpeedLaw(temperature, mass).pdf(self._speeds) for share, mass in kinds), np.zeros(1))


class DensityPanel:
    """Number density in strips along the direction of gravity or, without gravity, along the longer side of the box."""

    def __init__(self, axes: Axes, scene: Scene, gas: Gas, line: str, sample: Sequence[LogState]) -> None:
        """Draw the axes. line: colour of the mean density; sample: states that determine the range of densities."""
        falls = np.array(scene.properties.strongest_pull) != 0
        self._axis = int(falls[1] if falls.any() else gas.box[1] > gas.box[0])
        length = gas.box[self._axis]
        self._edges = np.linspace(0, length, BINS + 1)
        self._area = gas.area / BINS
        mean = len(gas) / gas.area
        positions = [gas.position, *(state.position[state.inside] for state in sample)]
        highest = max(float(self._density(position).max()) for position in positions)
        axes.set(xlim=(0, length), ylim=(0, 1.1 * max(highest, 2 * mean)), ylabel="density (discs/length²)")
        axes.set_xlabel(f"{'xy'[self._axis]} (length)")
        self._bars = _bars(axes, self._edges)
        axes.axhline(mean, ls="--", color=line)
        self.handles = [Line2D([], [], ls="--", color=line, label="mean")]

    def update(self, state: LogState, speed: np.ndarray) -> Iterable[Artist]:
        """Update the bars."""
        self._bars.set_data(self._density(state.position[state.inside]))
        return (self._bars,)

    def _density(self, position: np.ndarray) -> np.ndarray:
        return np.histogram(position[:, self._axis], self._edges)[0] / self._area


class SidesPanel:
    """Fraction of the discs to the right of the first gate or permeable wall, or of the middle, against time."""

    def __init__(self, axes: Axes, scene: Scene, gas: Gas, line: str, times: tuple[float, float]) -> None:
        """Draw the axes. line: colour of the fraction at equal density. times: start and end of the film."""
        passable = (wall for wall in walls_inside(scene) if wall.is_passable and wall.is_straight)
        upright = (wall.start[0] for wall in passable if wall.start[0] == wall.end[0])
        self._middle = next(upright, gas.box[0] / 2)
        self._points: list[tuple[float, float]] = []
        axes.set(xlim=times, ylim=(0, 1), xlabel="t (time)", ylabel=f"fraction right of x = {self._middle:g} (no unit)")
        axes.axhline(1 - self._middle / gas.box[0], ls="--", color=line)
        (self._curve,) = axes.plot([], [], "-", color=COLOURS[0], animated=True)
        (self._now,) = axes.plot([], [], "o", color=COLOURS[0], ms=4, animated=True)
        self.handles = [Line2D([], [], ls="--", color=line, label="equal density")]

    def update(self, state: LogState, speed: np.ndarray) -> Iterable[Artist]:
        """Extend the curve to this state."""
        self._points.append((state.time, state.mean(state.position[:, 0] > self._middle)))
        self._curve.set_data(*zip(*self._points, strict=True))
        self._now.set_data(*zip(self._points[-1], strict=True))
        return self._curve, self._now


def _bars(axes: Axes, edges: np.ndarray) -> StepPatch:
    bars = StepPatch(np.zeros(BINS), edges, color=COLOURS[5], alpha=0.6, fill=True, animated=True)
    axes.add_patch(bars)
    return bars
