"""Frames of a film: the discs in their box, and beside them their speeds with Maxwell and Boltzmann's curve.

What never changes is drawn once; a frame restores it and draws only discs, walls, bars, curve and title over it.
"""

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch

from idealgas.analysis.composition import composition
from idealgas.analysis.figures import COLOURS
from idealgas.analysis.laws import SpeedLaw
from idealgas.gas import Gas
from idealgas.log import LogState
from idealgas.scene import Scene

COLOUR_MAP = "cividis"
"""Of speeds; even to colour-blind eyes: Nuñez, Anderton & Renslow, PLoS ONE 13, e0199239 (2018)."""

DPI = 100
SHADES = 64
BINS = 36
CROSSING = 5.0
"""Seconds in which a disc of typical speed crosses the box, unless a speed is asked for."""

FASTEST, BRIGHTEST = 3.2, 2.0
"""Where the axis of speeds ends, and where their colours do, in units of the root mean square."""


class Painter:
    """Paints the states of one gas."""

    def __init__(self, scene: Scene, gas: Gas, size: tuple[int, int], rms_speed: float, by_species: bool) -> None:
        """size: width and height of a frame, pixels. rms_speed: about the largest that will be shown.

        by_species: what the colour of a disc says, its species or its speed.
        """
        self._scene, self._gas, self._by_species = scene, gas, by_species
        self._joined = np.array(scene.box.joined)
        self._species, self._kinds = composition(gas), np.array(COLOURS)[gas.species % len(COLOURS)]
        self._edges = np.linspace(0, FASTEST * rms_speed or 1.0, BINS + 1)
        self._shades = colormaps[COLOUR_MAP](np.linspace(0, 1, SHADES))
        self._brightest = self._edges[-1] * BRIGHTEST / FASTEST
        self._figure = Figure(figsize=(size[0] / DPI, size[1] / DPI), dpi=DPI)
        self._canvas = FigureCanvasAgg(self._figure)
        self._title = self._figure.text(0.06, 0.935, "", animated=True)
        self._draw_box(self._figure.add_axes((0.06, 0.15, 0.5, 0.75)))
        self._draw_speeds(self._figure.add_axes((0.66, 0.15, 0.31, 0.75)))
        self._canvas.draw()
        self._still = self._canvas.copy_from_bbox(self._figure.bbox)

    def paint(self, state: LogState) -> np.ndarray:
        """(height, width, 4) u1 of a state; good until the next call."""
        speed = np.hypot(*state.velocity.T)
        energy = float(self._gas.mass @ speed**2) / 2
        self._place(state.position, speed)
        density = np.histogram(speed, self._edges)[0] / (len(speed) * self._edges[1])
        self._bars.set_data(density)
        self._curve.set_ydata(self._law(energy / len(speed)))
        self._title.set_text(f"t = {state.time:<10.4g}  kinetic energy {energy:.6g}")
        self._canvas.restore_region(self._still)
        for artist in (self._discs, *self._walls_at(state.time), self._bars, self._curve, self._title):
            self._figure.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())

    def _draw_box(self, axes: Axes) -> None:
        axes.set(xlim=(0, self._gas.box[0]), ylim=(0, self._gas.box[1]), aspect="equal")
        axes.set(xlabel="x (length)", ylabel="y (length)")
        self._discs = EllipseCollection(
            [], [], [], units="xy", offset_transform=axes.transData, linewidths=0, animated=True
        )
        axes.add_collection(self._discs)
        self._walls: list[Artist] = []
        for wall in self._scene.wall:
            (line,) = axes.plot(*zip(wall.start, wall.end, strict=True), color="black", linewidth=1.5, animated=True)
            self._walls.append(line)

    def _draw_speeds(self, axes: Axes) -> None:
        """With the colours of the discs along the x axis."""
        top = self._edges[-1]
        self._speeds = np.linspace(0, top, 200)
        highest = 1.8 * self._law((top / FASTEST) ** 2 * float(self._gas.mass.mean()) / 2).max()
        axes.set(xlim=(0, top), ylim=(0, highest or 1.0), ylabel="density (time/length)")
        axes.set_xlabel("speed (length/time)")
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        self._bars = StepPatch(np.zeros(BINS), self._edges, color=COLOURS[5], alpha=0.6, fill=True, animated=True)
        axes.add_patch(self._bars)
        (self._curve,) = axes.plot(self._speeds, self._law(1.0), color=COLOURS[0], animated=True)
        handles = [Line2D([], [], color=COLOURS[0], label="Maxwell-Boltzmann")]
        if self._by_species:
            kinds = zip(self._species.name, np.resize(COLOURS, len(self._species.name)), strict=True)
            handles += [Line2D([], [], marker="o", linestyle="", color=colour, label=name) for name, colour in kinds]
        else:
            strip = axes.inset_axes((0, -0.03, 1, 0.03))
            strip.imshow(np.linspace(0, FASTEST, 200)[None], cmap=COLOUR_MAP, aspect="auto", vmax=BRIGHTEST)
            strip.set_axis_off()
            axes.tick_params(axis="x", pad=12, length=0)
        axes.legend(handles=handles, frameon=False, loc="upper right")

    def _place(self, position: np.ndarray, speed: np.ndarray) -> None:
        """Put the discs where they are, and their images at joined sides."""
        if self._by_species:
            colours = to_rgba_array(self._kinds)
        else:
            shade = np.minimum(speed / self._brightest * SHADES, SHADES - 1).astype(int)
            colours = self._shades[shade]
        radius, box = self._gas.radius, np.array(self._gas.box)
        which = np.arange(len(radius))
        for axis in np.flatnonzero(self._joined):
            for side in (-1, 1):
                reach = (
                    position[:, axis] < radius[which] if side == 1 else position[:, axis] > box[axis] - radius[which]
                )
                position = np.concatenate((position, position[reach] + side * box * (np.arange(2) == axis)))
                which = np.concatenate((which, which[reach]))
        diameter = 2 * radius[which]
        self._discs.set(widths=diameter, heights=diameter, angles=np.zeros(len(which)), offsets=position)
        self._discs.set(facecolors=colours[which])

    def _walls_at(self, time: float) -> list[Artist]:
        """Segments that are there: gates may be open."""
        there = (not (opens <= time < closes) for opens, closes in (wall.absence for wall in self._scene.wall))
        return [line for line, shown in zip(self._walls, there, strict=True) if shown]

    def _law(self, temperature: float) -> np.ndarray:
        """Density of speeds in equilibrium at a temperature, all species together."""
        if not temperature > 0:
            return np.zeros_like(self._speeds)
        shares = self._species.number / self._species.number.sum()
        kinds = zip(shares, self._species.mass.tolist(), strict=True)
        return sum((share * SpeedLaw(temperature, mass).pdf(self._speeds) for share, mass in kinds), np.zeros(1))
