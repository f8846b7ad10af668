"""Frames of a film: the discs in their box, and beside them their speed distribution with Maxwell-Boltzmann's curve.

What never changes is drawn once; a frame restores it and draws only discs, walls, bars, curve and title over it.
"""

from itertools import compress
from typing import Any, Literal, NamedTuple

import numpy as np
from matplotlib import colormaps, rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch
from matplotlib.patheffects import Normal, Stroke
from matplotlib.text import Annotation
from matplotlib.ticker import MaxNLocator

from idealgas.analysis.core.bond_order import bond_order
from idealgas.analysis.core.style import COLOURS, GRID, disable_mathtext
from idealgas.analysis.theory.conserved import centre_of_mass_velocity
from idealgas.analysis.theory.distributions import SpeedLaw
from idealgas.analysis.theory.ensemble import composition
from idealgas.log import LogState
from idealgas.movie.order_colours import order_colours
from idealgas.movie.piston_track import PistonTrack
from idealgas.scene import Scene
from idealgas.scene.walls import walls_inside
from idealgas.state import Gas

COLOUR_MAP = "cividis"
"""Colour map of speeds, readable for colour-blind viewers: Nuñez, Anderton & Renslow, PLoS ONE 13, e0199239 (2018)."""

DPI = 100
USUAL, LEAST_ZOOM = (960, 540), 0.5
"""Frame size in pixels at which text and margins have their usual size, and smallest factor of that size."""

SHADES = 64
PALEST, DARKEST = 0.93, 0.3
"""Parts of the colour map that are used: up to the first on white, from the second on on black."""

EDGE = 0.55
"""Brightness of the edge of a disc on white, relative to the disc: fast discs are seen as well."""

PAPER, INK = "#14161a", "#e6e6e6"
DARK: dict[Any, Any] = {
    "figure.facecolor": PAPER,
    "axes.facecolor": PAPER,
    "grid.color": "#363b43",
    **dict.fromkeys(("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color"), INK),
}
"""Settings of matplotlib for pictures on a dark background."""

BINS = 36
SMALLEST = 3.0
"""Smallest diameter in pixels with which a disc is drawn."""

STRIP = 9  # pixels, height of the strip with the colours

CROSSING = 5.0
"""Default seconds of film in which a disc of typical speed crosses the box."""

FASTEST, BRIGHTEST = 3.2, 2.0
"""End of the speed axis and of the colour scale, in units of the root-mean-square speed."""


BEYOND = 1.25
"""Length of the shown room along the way of a piston, relative to the largest one of the gas."""

LEFT, RIGHT, BOTTOM, TOP = 64, 22, 58, 42  # margins, pixels of the usual size
SPEEDS = 0.3
"""Smallest share of a frame for the speed distribution beside or below the box."""

Rectangle = tuple[float, float, float, float]

Colouring = Literal["speed", "species", "order"]
"""What the colour of a disc shows: its speed, its species, or the order ψ₆ of its neighbours."""


class Layout(NamedTuple):
    """Rectangles (left, bottom, width, height) of box and speeds in pixels, and scale in pixels per unit of length."""

    box: Rectangle
    speeds: Rectangle
    scale: float


def layout(size: tuple[float, float], box: tuple[float, float]) -> Layout:
    """Layout with the speeds beside the box, or below it if the box is larger then."""
    width, height = size[0] - LEFT - RIGHT, size[1] - TOP - BOTTOM
    aside, below = SPEEDS * size[0], SPEEDS * size[1]
    beside = min((width - LEFT - aside) / box[0], height / box[1])
    above = min(width / box[0], (height - BOTTOM - below) / box[1])
    scale = max(beside, above)
    w, h = scale * box[0], scale * box[1]
    if beside >= above:
        speeds = (2 * LEFT + w, BOTTOM, width - LEFT - w, height)
        return Layout((LEFT, BOTTOM + (height - h) / 2, w, h), speeds, scale)
    speeds = (LEFT, BOTTOM, width, height - BOTTOM - h)
    return Layout((LEFT + (width - w) / 2, size[1] - TOP - h, w, h), speeds, scale)


def view(box: tuple[float, float], piston: PistonTrack | None) -> tuple[tuple[float, float], tuple[float, float]]:
    """Shown part of a box along x and y, length: the box, but of the room beyond a piston only BEYOND the gas."""
    shown = [(0.0, box[0]), (0.0, box[1])]
    if piston is not None:
        low, high = shown[piston.axis]
        if piston.outward > 0:
            high = min(high, BEYOND * float(piston.place.max()))
        else:
            low = max(low, high - BEYOND * (high - float(piston.place.min())))
        shown[piston.axis] = low, high
    return shown[0], shown[1]


class Painter:
    """Painter of the states of one gas."""

    def __init__(
        self,
        scene: Scene,
        gas: Gas,
        piston: PistonTrack | None,
        size: tuple[int, int],
        rms_speed: float,
        colouring: Colouring = "speed",
        dark: bool = False,
    ) -> None:
        """Prepare what is the same in all frames.

        size: width and height of a frame, pixels. rms_speed: approximate largest root-mean-square speed of the film,
        length/time. colouring: what the colour of a disc shows. dark: whether the background is dark. Speeds are those
        relative to a conserved motion of the whole gas.
        """
        self._ink, self._line, self._edge = (INK, INK, 1.0) if dark else ("black", COLOURS[0], EDGE)
        self._flow = centre_of_mass_velocity(scene, gas)
        self._inside, self._gas, self._piston, self._colouring = walls_inside(scene), gas, piston, colouring
        self._periodic = np.array(scene.properties.periodic)
        self._species, self._kinds = composition(gas), np.array(COLOURS)[gas.species % len(COLOURS)]
        self._edges = np.linspace(0, FASTEST * rms_speed or 1.0, BINS + 1)
        self._shades = colormaps[COLOUR_MAP](np.linspace(DARKEST if dark else 0, 1 if dark else PALEST, SHADES))
        self._brightest = self._edges[-1] * BRIGHTEST / FASTEST
        with rc_context(DARK if dark else {"grid.color": GRID}):
            self._draw_still(size)

    def _draw_still(self, size: tuple[int, int]) -> None:
        """Draw what is the same in all frames, and prepare the parts that are drawn over it."""
        zoom = max(min(size[0] / USUAL[0], size[1] / USUAL[1]), LEAST_ZOOM)
        page = size[0] / zoom, size[1] / zoom
        self._figure = Figure(figsize=(page[0] / DPI, page[1] / DPI), dpi=DPI * zoom)
        self._canvas = FigureCanvasAgg(self._figure)
        self._view = view(self._gas.box, self._piston)
        place = layout(page, (self._view[0][1] - self._view[0][0], self._view[1][1] - self._view[1][0]))
        self._diameter = np.maximum(2 * self._gas.radius, SMALLEST / (place.scale * min(zoom, 1)))
        self._title = self._figure.text(LEFT / page[0], 1 - 0.65 * TOP / page[1], "", animated=True)
        self._draw_box(self._add_axes(place.box, page))
        self._draw_speeds(self._add_axes(place.speeds, page))
        disable_mathtext(self._figure)
        self._canvas.draw()
        self._still = self._canvas.copy_from_bbox(self._figure.bbox)

    def paint(self, state: LogState) -> np.ndarray:
        """Paint a state: frame (height, width, 4) uint8, valid until the next call."""
        speed = np.hypot(*(state.velocity - self._flow).T)
        energy = float(self._gas.mass @ (state.velocity**2).sum(axis=1)) / 2
        self._place(state.position, speed)
        density = np.histogram(speed, self._edges)[0] / (len(speed) * self._edges[1])
        self._bars.set_data(density)
        self._curve.set_ydata(self._law(float(self._gas.mass @ speed**2) / 2 / len(speed)))
        self._title.set_text(f"t = {state.time:<10.4g}  kinetic energy {energy:.6g}")
        self._canvas.restore_region(self._still)
        for artist in (self._discs, *self._walls_at(state.time), self._bars, self._curve, self._title):
            self._figure.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())

    def _add_axes(self, place: Rectangle, page: tuple[float, float]) -> Axes:
        return self._figure.add_axes((place[0] / page[0], place[1] / page[1], place[2] / page[0], place[3] / page[1]))

    def _draw_box(self, axes: Axes) -> None:
        axes.set(xlim=self._view[0], ylim=self._view[1], xlabel="x (length)", ylabel="y (length)")
        for axis, pixels in ((axes.xaxis, axes.bbox.width), (axes.yaxis, axes.bbox.height)):
            nbins = 1 + int(pixels * DPI / self._figure.dpi) // 60
            axis.set_major_locator(MaxNLocator(nbins, steps=(1, 2, 5, 10), min_n_ticks=2))
        self._discs = EllipseCollection(
            [], [], [], units="xy", offset_transform=axes.transData, linewidths=0.4, animated=True
        )
        axes.add_collection(self._discs)
        self._walls: list[Artist] = []
        self._names: list[Artist] = []
        for wall in self._inside:
            (line,) = axes.plot(*zip(wall.start, wall.end, strict=True), color=self._ink, linewidth=1.5, animated=True)
            self._walls.append(line)
            self._names.append(self._name(axes, wall.name, max(wall.start, wall.end, key=lambda end: end[1])))
        if self._piston is not None:
            draw = axes.axhline if self._piston.axis else axes.axvline
            self._piston_line = draw(0, color=COLOURS[1], linewidth=3, animated=True)
            self._piston_name = self._name(axes, self._piston.name, (0.0, self._view[1][1]))

    def _name(self, axes: Axes, name: str, place: tuple[float, float]) -> Annotation:
        """Name of a wall beside a place of it, on the side with more room, legible on discs."""
        low, high = self._view[0]
        right = place[0] < (low + high) / 2 or (self._piston is not None and self._piston.axis == 0)
        around = [Stroke(linewidth=3, foreground=axes.get_facecolor()), Normal()]
        return axes.annotate(
            name, place, (6 if right else -6, -6), textcoords="offset points", ha="left" if right else "right",
            va="top", fontsize="small", path_effects=around, animated=True, annotation_clip=False,
        )  # fmt: skip

    def _draw_speeds(self, axes: Axes) -> None:
        """Draw the axes of the speed distribution, with the colours of the discs along the x axis."""
        top = self._edges[-1]
        self._speeds = np.linspace(0, top, 200)
        highest = 1.8 * self._law((top / FASTEST) ** 2 * float(self._gas.mass.mean()) / 2).max()
        axes.set(xlim=(0, top), ylim=(0, highest or 1.0), ylabel="density (time/length)")
        axes.set_xlabel("speed (length/time)" if not self._flow.any() else "speed relative to the gas (length/time)")
        axes.grid(linewidth=0.6)
        axes.set_axisbelow(True)
        self._bars = StepPatch(np.zeros(BINS), self._edges, color=COLOURS[5], alpha=0.6, fill=True, animated=True)
        axes.add_patch(self._bars)
        (self._curve,) = axes.plot(self._speeds, self._law(1.0), color=self._line, animated=True)
        handles = [Line2D([], [], color=self._line, label="Maxwell-Boltzmann")]
        if self._colouring == "speed":
            high = STRIP / (axes.bbox.height * DPI / self._figure.dpi)
            strip = axes.inset_axes((0, -high, 1, high))
            shown = np.minimum(np.linspace(0, FASTEST / BRIGHTEST, 200), 1) * (SHADES - 1)
            strip.imshow(self._shades[shown.astype(int)][None], aspect="auto")
            strip.set_axis_off()
            axes.tick_params(axis="x", pad=12, length=0)
        kinds = [Line2D([], [], marker="o", linestyle="", color=colour, label=name) for name, colour in self._key()]
        axes.legend(handles=[*handles, *kinds], frameon=False, loc="upper right")

    def _key(self) -> list[tuple[str, Any]]:
        """What colours stand for, where the axis of speeds does not tell it."""
        if self._colouring == "species":
            return list(zip(self._species.name, np.resize(COLOURS, len(self._species.name)), strict=True))
        if self._colouring == "order":
            angles = {"ψ₆ at 0°": 1, "ψ₆ at 120°": np.exp(2j * np.pi / 3), "ψ₆ at 240°": np.exp(-2j * np.pi / 3)}
            return list(zip([*angles, "no order"], order_colours(np.array([*angles.values(), 0])), strict=True))
        return []

    def _colours(self, position: np.ndarray, speed: np.ndarray) -> np.ndarray:
        """Colours (N, 4) of the discs."""
        if self._colouring == "species":
            return to_rgba_array(self._kinds)
        if self._colouring == "order":
            return order_colours(bond_order(position, self._gas.box, tuple(self._periodic)).value)
        return self._shades[np.minimum(speed / self._brightest * SHADES, SHADES - 1).astype(int)]

    def _place(self, position: np.ndarray, speed: np.ndarray) -> None:
        """Draw the discs at their positions, and their periodic images at periodic sides."""
        colours = self._colours(position, speed)
        radius, box = self._gas.radius, np.array(self._gas.box)
        which = np.arange(len(radius))
        for axis in np.flatnonzero(self._periodic):
            for side in (-1, 1):
                reach = (
                    position[:, axis] < radius[which] if side == 1 else position[:, axis] > box[axis] - radius[which]
                )
                position = np.concatenate((position, position[reach] + side * box * (np.arange(2) == axis)))
                which = np.concatenate((which, which[reach]))
        diameter = self._diameter[which]
        self._discs.set(widths=diameter, heights=diameter, angles=np.zeros(len(which)), offsets=position)
        self._discs.set(facecolors=colours[which], edgecolors=colours[which] * (*[self._edge] * 3, 1.0))

    def _walls_at(self, time: float) -> list[Artist]:
        """Draw the walls that are present at a time, as gates may be open, and the piston."""
        there = [wall.is_there(time) for wall in self._inside]
        drawn = list(compress((*self._walls, *self._names), there * 2))
        if self._piston is None:
            return drawn
        place = self._piston.at(time)
        self._piston_line.set(**{"ydata" if self._piston.axis else "xdata": [place] * 2})
        self._piston_name.xy = (self._view[0][0], place) if self._piston.axis else (place, self._view[1][1])
        return [*drawn, self._piston_line, self._piston_name]

    def _law(self, temperature: float) -> np.ndarray:
        """Probability density of the speeds of all discs in equilibrium at a temperature, time/length."""
        if not temperature > 0:
            return np.zeros_like(self._speeds)
        shares = self._species.number / self._species.number.sum()
        kinds = zip(shares, self._species.mass.tolist(), strict=True)
        return sum((share * SpeedLaw(temperature, mass).pdf(self._speeds) for share, mass in kinds), np.zeros(1))
