"""Paint the frames of a film: the discs in their box, and a panel, for example with the distribution of their speeds.

The background, which never changes, is drawn once. Each frame restores it and draws only the discs, walls, panel and
title on top.
"""

import math
from collections.abc import Sequence
from itertools import compress, product
from typing import Any, Literal, TypedDict, Unpack

import numpy as np
from matplotlib import colormaps, rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, PatchCollection
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.patheffects import Normal, Stroke
from matplotlib.text import Annotation
from matplotlib.ticker import MaxNLocator

from idealgas.errors import UserError
from idealgas.log import LogState
from idealgas.movie.layout import LEFT, LETTER, TOP, Rectangle, frame_size, layout, lengths, view
from idealgas.movie.order_colours import order_colours
from idealgas.movie.panels import BRIGHTEST, FASTEST, DensityPanel, FilmPanel, SidesPanel, SpeedPanel
from idealgas.movie.piston_track import PistonTrack
from idealgas.presentation.style import COLOURS, GRID, disable_mathtext
from idealgas.scene import Scene
from idealgas.scene.walls import walls_inside
from idealgas.state import Gas
from idealgas.tallies.bond_order import bond_order
from idealgas.theory.conserved import centre_of_mass_velocity

COLOUR_MAP = "cividis"
"""Colour map for speeds, readable for colour-blind viewers: Nuñez, Anderton & Renslow, PLoS ONE 13, e0199239 (2018)."""

DPI = 100
USUAL, NARROWEST, LEAST_ZOOM = (960, 540), 400, 0.5
"""Limits for the size of text and margins.

They are the frame size at which text and margins have their usual size, the width or height below which they are
reduced (both in pixels), and the smallest factor by which they are reduced.
"""

SHADES = 64
PALEST, DARKEST = 0.93, 0.3
"""End of the range of the colour map that is used on a white background, and start of the range used on a dark one."""

EDGE, EDGED = 0.55, 8.0
"""Brightness of the edge of a disc on white relative to the disc, and diameter above which it is drawn, pixels."""

PAPER, INK = "#14161a", "#e6e6e6"
DARK: dict[Any, Any] = {
    "figure.facecolor": PAPER,
    "axes.facecolor": PAPER,
    "grid.color": "#363b43",
    **dict.fromkeys(("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color"), INK),
}
"""Matplotlib settings for pictures on a dark background."""

SMALLEST = 4.0
"""Smallest diameter at which a disc is drawn, pixels."""

CROSSING = 5.0
"""Time in which a disc of typical speed crosses the box at the default playback speed, seconds of film."""

Colouring = Literal["speed", "species", "order"]
"""Property that is shown by the colour of a disc: its speed, its species, or its local order ψ₆."""

Shown = Literal["speeds", "density", "left-right", "none"]
"""Content of the panel beside the discs."""


class Look(TypedDict, total=False):
    """Appearance of a film.

    Attributes:
        size: width and height of a frame in pixels, rounded down to even numbers in films; by default the entry in
            SIZES that best suits the shape of the box.
        colouring: property that is shown by the colours of the discs; by default the speed.
        panel: content of the panel beside the discs; by default the distribution of the speeds.
        trails: ids of discs whose paths are drawn.
        dark: whether the background is dark; by default it is light.
    """

    size: tuple[int, int] | None
    colouring: Colouring
    panel: Shown
    trails: Sequence[int]
    dark: bool


class Painter:
    """Painter of the states of a gas."""

    def __init__(
        self,
        scene: Scene,
        gas: Gas,
        pistons: Sequence[PistonTrack],
        rms_speed: float,
        times: tuple[float, float] = (0.0, 1.0),
        sample: Sequence[LogState] = (),
        maxwell: bool = True,
        **look: Unpack[Look],
    ) -> None:
        """Prepare what is the same in all frames.

        Args:
            scene: the scene.
            gas: the initial state of the discs.
            pistons: tracks of the pistons and of vibrating sides.
            rms_speed: approximate largest root-mean-square speed in the film, length/time. Speeds are relative to a
                conserved motion of the gas as a whole.
            times: start and end of the film.
            sample: states in the film, from which the range of the density panel is determined.
            maxwell: whether to compare the speeds with the Maxwell-Boltzmann distribution.
            look: appearance of the film.

        Raises:
            UserError: if a disc with a trail does not exist.
        """
        trails, panel, dark = look.get("trails", ()), look.get("panel", "speeds"), look.get("dark", False)
        if unknown := [disc for disc in trails if not 0 <= disc < len(gas)]:
            raise UserError(f"trail: no disc {unknown[0]} (allowed 0 to {len(gas) - 1})")
        self._ink, self._line = (INK, INK) if dark else ("black", COLOURS[0])
        self._dark = dark
        self._flow = centre_of_mass_velocity(scene, gas)
        self._scene, self._inside, self._gas, self._pistons = scene, walls_inside(scene), gas, pistons
        self._colouring, self._shows, self._maxwell = look.get("colouring", "speed"), panel, maxwell
        self._panel: FilmPanel | None = None
        self._view = view(gas.box, pistons)
        self.size = look.get("size") or frame_size(self._view, panel != "none")
        self._paths: dict[int, list[np.ndarray]] = {disc: [] for disc in trails}
        self._periodic = np.array(scene.properties.periodic)
        self._kinds = np.array(COLOURS)[gas.species % len(COLOURS)]
        self._shades = colormaps[COLOUR_MAP](np.linspace(DARKEST if dark else 0, 1 if dark else PALEST, SHADES))
        self._brightest = BRIGHTEST * rms_speed or BRIGHTEST / FASTEST
        with rc_context(DARK if dark else {"grid.color": GRID}):
            self._draw_still(rms_speed, times, sample)

    def _draw_still(self, rms_speed: float, times: tuple[float, float], states: Sequence[LogState]) -> None:
        """Draw what is the same in all frames, and prepare the artists that are drawn on top."""
        size = self.size
        usual = math.sqrt(size[0] * size[1] / math.prod(USUAL)), min(size) / NARROWEST
        zoom = max(min(usual), LEAST_ZOOM)
        page = size[0] / zoom, size[1] / zoom
        self._figure = Figure(figsize=(page[0] / DPI, page[1] / DPI), dpi=DPI * zoom)
        self._canvas = FigureCanvasAgg(self._figure)
        place = layout(page, lengths(self._view), self._shows != "none")
        self._diameter = np.maximum(2 * self._gas.radius, SMALLEST / (place.scale * min(zoom, 1)))
        has_edge = self._diameter * place.scale * zoom > EDGED
        self._edge = np.where(has_edge & (not self._dark), EDGE, 1.0)[:, None]
        self._figure.text(LEFT / page[0], 1 - 0.4 * TOP / page[1], self._scene.scene.title, weight="bold")
        self._title = self._figure.text(LEFT / page[0], 1 - 0.85 * TOP / page[1], "", animated=True)
        self._draw_box(self._add_axes(place.box, page))
        if place.panel is not None:
            self._draw_panel(self._add_axes(place.panel, page), rms_speed, times, states)
        disable_mathtext(self._figure)
        self._canvas.draw()
        self._still = self._canvas.copy_from_bbox(self._figure.bbox)

    def paint(self, state: LogState) -> np.ndarray:
        """Paint a state and return the frame (height, width, 4) uint8, which is valid until the next call."""
        speed = np.hypot(*(state.velocity - self._flow).T)
        self._place(state, speed, np.flatnonzero(state.inside))
        beside = () if self._panel is None else self._panel.update(state, speed)
        energy = np.nansum(self._gas.mass * (state.velocity**2).sum(axis=1)) / 2
        self._title.set_text(f"t = {state.time:<10.4g}  kinetic energy {energy:.6g}")
        self._canvas.restore_region(self._still)
        for artist in (
            self._discs,
            *self._trails_to(state.position),
            *self._walls_at(state.time),
            *beside,
            self._title,
        ):
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
        self._trails = [axes.plot([], [], lw=1.5, color=self._ink, animated=True)[0] for _ in self._paths]
        self._walls: list[Artist] = []
        self._names: list[Artist] = []
        for wall in self._inside:
            if wall.radius:
                shifts = ((-1, 0, 1) if periodic else (0,) for periodic in self._periodic)
                (x, y), (width, height) = wall.start, self._gas.box
                images = [Circle((x + i * width, y + j * height), wall.radius) for i, j in product(*shifts)]
                discs = PatchCollection(images, facecolor=self._ink, edgecolor="none", animated=True)
                self._walls.append(axes.add_collection(discs))
                self._names.append(self._name(axes, "", wall.start))
                continue
            line_of, dash = zip(*wall.points, strict=True), "--" if wall.is_permeable else "-"
            (line,) = axes.plot(*line_of, dash, color=self._ink, linewidth=1.5, animated=True)
            self._walls.append(line)
            self._names.append(self._name(axes, wall.label, max(wall.start, wall.end, key=lambda end: end[1])))
        self._piston_lines: list[tuple[Line2D, Annotation]] = []
        for piston in self._pistons:
            line = (axes.axhline if piston.axis else axes.axvline)(0, color=COLOURS[1], linewidth=3, animated=True)
            farthest = float(piston.place.max()) * (piston.axis == 0)
            self._piston_lines.append((line, self._name(axes, piston.name, (farthest, self._view[1][1]))))

    def _name(self, axes: Axes, name: str, place: tuple[float, float]) -> Annotation:
        """Write the name of a wall beside a point on the wall, on the side with more space, legible on top of discs."""
        beyond = (self._figure.bbox.width - axes.transData.transform(place)[0]) * DPI / self._figure.dpi
        crossed = any(piston.axis == 0 for piston in self._pistons)
        right = place[0] < sum(self._view[0]) / 2 or (crossed and beyond > LETTER * len(name))
        halo = [Stroke(linewidth=3, foreground=axes.get_facecolor()), Normal()]
        return axes.annotate(
            name, place, (6 if right else -6, -6), textcoords="offset points", ha="left" if right else "right",
            va="top", fontsize="small", path_effects=halo, animated=True, annotation_clip=False,
        )  # fmt: skip

    def _draw_panel(self, axes: Axes, rms_speed: float, times: tuple[float, float], states: Sequence[LogState]) -> None:
        """Draw the part of the panel that is the same in all frames."""
        gas, line = self._gas, self._line
        if self._shows == "density":
            self._panel = DensityPanel(axes, self._scene, gas, line, states)
        elif self._shows == "left-right":
            self._panel = SidesPanel(axes, self._scene, gas, line, times)
        else:
            shades = self._shades if self._colouring == "speed" else None
            self._panel = SpeedPanel(axes, gas, rms_speed, line if self._maxwell else None, shades)
            if self._flow.any():
                axes.set_xlabel("speed relative to the gas (length/time)")
        axes.grid(linewidth=0.6)
        axes.set_axisbelow(True)
        kinds = [Line2D([], [], marker="o", linestyle="", color=colour, label=name) for name, colour in self._key()]
        axes.legend(handles=[*self._panel.handles, *kinds], frameon=False, loc="upper right")

    def _key(self) -> list[tuple[str, Any]]:
        """Return the legend of the colours, unless the axis of speeds shows their meaning."""
        if self._colouring == "species":
            return list(zip(self._gas.species_names, np.resize(COLOURS, len(self._gas.species_names)), strict=True))
        if self._colouring == "order":
            angles = {"ψ₆ at 0°": 1, "ψ₆ at 120°": np.exp(2j * np.pi / 3), "ψ₆ at 240°": np.exp(-2j * np.pi / 3)}
            return list(zip([*angles, "no order"], order_colours(np.array([*angles.values(), 0])), strict=True))
        return []

    def _colours(self, position: np.ndarray, speed: np.ndarray) -> np.ndarray:
        """Return the colours (N, 4) of the discs."""
        if self._colouring == "species":
            return to_rgba_array(self._kinds)
        if self._colouring == "order":
            return order_colours(bond_order(position, self._gas.box, tuple(self._periodic)).value)
        return self._shades[np.minimum(speed / self._brightest * SHADES, SHADES - 1).astype(int)]

    def _place(self, state: LogState, speed: np.ndarray, which: np.ndarray) -> None:
        """Draw the discs `which` (n,) at their positions, and their periodic images."""
        colours = self._colours(state.position, np.nan_to_num(speed))
        radius, box, position = self._gas.radius, np.array(self._gas.box), state.position[which]
        ahead = self._scene.properties.shear * box[1] * state.time  # shift of the periodic images beyond sheared sides
        for axis in np.flatnonzero(self._periodic)[::-1]:
            for side in (-1, 1):
                reach = (
                    position[:, axis] < radius[which] if side == 1 else position[:, axis] > box[axis] - radius[which]
                )
                images = position[reach] + side * box * (np.arange(2) == axis)
                if axis and ahead:
                    images[:, 0] = np.remainder(images[:, 0] + side * ahead, box[0])
                position = np.concatenate((position, images))
                which = np.concatenate((which, which[reach]))
        diameter = self._diameter[which]
        self._discs.set(widths=diameter, heights=diameter, angles=np.zeros(len(which)), offsets=position)
        edges = colours[which]
        edges[:, :3] *= self._edge[which]
        self._discs.set(facecolors=colours[which], edgecolors=edges)

    def _trails_to(self, position: np.ndarray) -> list[Line2D]:
        """Return the paths of the chosen discs up to this position, with gaps where they cross periodic sides."""
        for (disc, path), line in zip(self._paths.items(), self._trails, strict=True):
            if path and (np.abs(position[disc] - path[-1]) > np.array(self._gas.box) / 2).any():
                path.append(np.full(2, np.nan))
            path.append(position[disc].copy())
            line.set_data(*np.array(path).T)
        return self._trails

    def _walls_at(self, time: float) -> list[Artist]:
        """Return the walls that are present at a time (gates may be open), and the pistons at their positions."""
        drawn = list(compress((*self._walls, *self._names), [wall.is_present(time) for wall in self._inside] * 2))
        for piston, (line, name) in zip(self._pistons, self._piston_lines, strict=True):
            place = piston.at(time)
            line.set(**{"ydata" if piston.axis else "xdata": [place] * 2})
            name.xy = (self._view[0][0], place) if piston.axis else (place, self._view[1][1])
            drawn += [line, name]
        return drawn
