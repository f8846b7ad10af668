"""Draw panels of lines, markers, error bars, bands and steps as SVG, from the objects of a matplotlib figure.

matplotlib determines the limits, the ticks and their labels, but does not draw: it would create an object for every
tick and measure every text several times, which would take most of the time needed for a report.
"""

import re
from collections.abc import Iterator, Sequence
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axis import Axis
from matplotlib.collections import Collection, LineCollection, PolyCollection
from matplotlib.colors import to_hex, to_rgba
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.patches import Patch
from matplotlib.path import Path
from matplotlib.transforms import Affine2D, Transform

from idealgas.errors import plain
from idealgas.presentation.style import BLACK, COLOURS, GREY, GRID, LABEL_CHARACTERS, Panel
from idealgas.presentation.tables import escape

POINT = 72
"""SVG units per inch."""

NAMES = {colour.lower(): f"--c{k}" for k, colour in enumerate(COLOURS)} | {
    BLACK: "--ink",
    GREY.lower(): "--soft",
    GRID: "--line",
}
"""Style-sheet variables of the page for the colours of figures."""

SIZE, LEGEND_SIZE, LINE = 10.0, 9.0, 13.0
"""Font sizes of text and of the legend, and distance between lines of text, points."""

CHARACTER = 0.62
"""Assumed width of a character relative to the font size, slightly more than the width of most characters."""

LEAST_HEIGHT = 100.0
"""Smallest height between the axes, even with a long legend, points."""

SWATCH = 20.0
"""Length of the lines in a legend, points."""

DASHES: dict[Any, tuple[float, ...]] = {"--": (3.7, 1.6), "-.": (6.4, 1.6, 1, 1.6), ":": (1, 1.65)}
"""Dashes and gaps of lines in units of the line width, as in matplotlib."""

COMMANDS: dict[Any, str] = {1: "M", 2: "L", 3: "Q", 4: "C"}
"""SVG commands by matplotlib path code; any other code closes a path."""

SUPERSCRIPTS = str.maketrans("0123456789-−", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻")


class Frame(NamedTuple):
    """Size of a picture, and edges of the rectangle between its axes, in points from the upper left corner."""

    width: float
    height: float
    left: float
    right: float
    bottom: float
    top: float


def is_drawable(figure: Figure) -> bool:
    """Return whether this module can draw everything in a figure."""
    extras = [part for ax in figure.axes for part in (*ax.texts, *ax.images, *ax.tables, *ax.artists, *ax.child_axes)]
    collections = (part for ax in figure.axes for part in ax.collections)
    supported = all(isinstance(part, LineCollection | PolyCollection) for part in collections)
    return supported and not extras and all(isinstance(ax, Panel) for ax in figure.axes)


def draw(figure: Figure, panel: Panel, size: tuple[float, float], key: str) -> tuple[str, Frame]:
    """Draw a panel of a drawable figure.

    Args:
        figure: the figure, which is resized to the size of the picture.
        panel: the panel.
        size: width and height of the picture, points; the height is increased for a long legend.
        key: name of the panel, which must be unique on the page.

    Returns:
        Content of the panel's SVG element, and the position of its axes.
    """
    entries = list(_legend(figure, panel))
    frame = _frame(figure, panel, size, sum(row for *_, row in entries))
    down = Affine2D().scale(1, -1).translate(0, frame.height)
    x, y, w, h = map(_number, (frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top))
    parts = sorted((*panel.patches, *panel.collections, *panel.lines), key=lambda part: part.get_zorder())
    drawn = "".join(text for part in parts if part.get_visible() for text in _drawn(part, down, frame))
    svg = (
        f'<clipPath id="{key}"><rect x="{x}" y="{y}" width="{w}" height="{h}"/></clipPath>{_axes(panel, frame, down)}'
        f'<g clip-path="url(#{key})">{drawn}</g>{"".join(_drawn_legend(entries, frame))}'
    )
    return svg, frame


def _frame(figure: Figure, panel: Panel, size: tuple[float, float], legend: float) -> Frame:
    """Place a panel in its figure, with space for the text on the vertical axis and for the legend below.

    Args:
        figure: the figure, whose size is set.
        panel: the panel.
        size: width and smallest height of the figure, points.
        legend: height of the legend, points.
    """
    width, top, below = size[0], 1.8 * LINE, 2.8 * LINE + legend
    height = max(size[1], top + LEAST_HEIGHT + below)
    figure.set_dpi(POINT)
    figure.set_size_inches(width / POINT, height / POINT)
    left = LINE
    for _ in range(2):  # twice is enough, because the number of ticks depends only on the height
        frame = Frame(width, height, left, width - 1.2 * LINE, height - below, top)
        place = frame.left, below, frame.right - frame.left, frame.bottom - frame.top
        panel.set_position((place[0] / width, place[1] / height, place[2] / width, place[3] / height))
        labels = [label for _, label in _ticks(panel.yaxis)]
        left = min(0.8 * LINE + CHARACTER * SIZE * max(map(len, labels), default=0), width / 2)
    return frame


# ── axes ──


def _ticks(axis: Axis) -> list[tuple[float, str]]:
    """Return the ticks within the limits of an axis as pairs (position, label); minor ticks rarely have labels."""
    low, high = sorted(axis.get_view_interval())
    margin = 1e-9 * (high - low)
    ticks = []
    for places, formatter in (
        (axis.get_majorticklocs(), axis.get_major_formatter()),
        (axis.get_minorticklocs(), axis.get_minor_formatter()),
    ):
        labels = [_label(text) for text in formatter.format_ticks(places.tolist())]
        ticks += [(x, text) for x, text in zip(places, labels, strict=True) if low - margin <= x <= high + margin]
    return ticks


def _label(text: str) -> str:
    """Return the label of a tick, with superscripts for powers in place of matplotlib markup."""
    text = re.sub(r"\^\{(.*?)\}", lambda power: power[1].translate(SUPERSCRIPTS), text)
    return re.sub(r"\\mathdefault\{(.*?)\}|[$]", r"\1", text).replace(r"\times", "×").replace(r"\cdot", "·")


def _axes(panel: Panel, frame: Frame, down: Transform) -> str:
    """Return the SVG of the axes of a panel, with ticks, grid and labels."""
    left, right, bottom, top = frame[2:]
    grid, ticks, texts = "", f"M{_number(left)} {_number(top)}V{_number(bottom)}H{_number(right)}", []
    major = set(panel.xaxis.get_majorticklocs()), set(panel.yaxis.get_majorticklocs())
    for value, label in _ticks(panel.xaxis):
        x, _ = (panel.get_xaxis_transform() + down).transform((value, 0))
        grid += f"M{_number(x)} {_number(top)}V{_number(bottom)}" if value in major[0] else ""
        ticks += f"M{_number(x)} {_number(bottom)}v{3.5 if value in major[0] else 2}"
        texts.append((x, bottom + LINE, "middle", label))
    for value, label in _ticks(panel.yaxis):
        _, y = (panel.get_yaxis_transform() + down).transform((0, value))
        grid += f"M{_number(left)} {_number(y)}H{_number(right)}" if value in major[1] else ""
        ticks += f"M{_number(left)} {_number(y)}h{-3.5 if value in major[1] else -2}"
        texts.append((left - 6, y + 0.35 * SIZE, "end", label))
    texts.append(((left + right) / 2, bottom + 2.1 * LINE, "middle", panel.get_xlabel()))
    texts.append((left, top - 0.6 * LINE, "start", panel.get_ylabel()))
    for axis, x, y, anchor in (
        (panel.xaxis, right, bottom + 2.1 * LINE, "end"),
        (panel.yaxis, left - 6, top - 0.6 * LINE, "end"),
    ):
        texts.append((x, y, anchor, _label(axis.get_major_formatter().get_offset())))
    return (
        f'<path d="{grid}" style="fill:none;stroke:var(--line);stroke-width:.6"/>'
        f'<path d="{ticks}" style="fill:none;stroke:var(--ink);stroke-width:.8"/>'
        + "".join(_text(*text) for text in texts if text[-1])
    )


def _text(x: float, y: float, anchor: str, text: str, size: float = SIZE) -> str:
    """Return a line of text that starts, is centred or ends at (x, y), depending on `anchor`."""
    place = f'x="{_number(x)}" y="{_number(y)}" font-size="{size:g}" text-anchor="{anchor}"'
    return f"<text {place}>{escape(plain(text))}</text>"


# ── between the axes ──


def _drawn(part: Any, down: Transform, frame: Frame) -> Iterator[str]:
    """Yield the SVG elements of a line, a patch or a collection."""
    transform = part.get_transform() + down
    if isinstance(part, Line2D):
        if part.get_linestyle() != "None":
            clip = -LINE, -LINE, frame.width + LINE, frame.height + LINE
            yield _path(_commands(part.get_path(), transform, clip), _stroke(part))
        if part.get_marker() not in ("", " ", "None", None):
            places = transform.transform(part.get_xydata())
            yield _markers(part, places[np.isfinite(places).all(axis=1)])
    else:
        paths = part.get_paths() if isinstance(part, Collection) else [part.get_path()]
        yield _path("".join(_commands(path, transform) for path in paths), _fill(part))


def _commands(path: Path, transform: Transform, clip: tuple[float, float, float, float] | None = None) -> str:
    """Return a path as SVG commands."""
    return "".join(
        f"{COMMANDS[code]}{' '.join(map(_number, vertices))}" if code in COMMANDS else "Z"
        for vertices, code in transform.transform_path(path).iter_segments(clip=clip)
    )


def _path(commands: str, style: str) -> str:
    return f'<path d="{commands}" style="{style}"/>' if commands else ""


def _number(value: float) -> str:
    """Return a length in points with one decimal; the rounding is invisible on most screens."""
    return f"{value:.1f}".removesuffix(".0")


def _stroke(line: Line2D) -> str:
    """Return the style of a line."""
    width = line.get_linewidth()
    dashes = " ".join(f"{width * dash:.3g}" for dash in DASHES.get(line.get_linestyle(), ()))
    pattern = f";stroke-dasharray:{dashes}" if dashes else ""
    return f"fill:none;{_paint('stroke', line.get_color(), line.get_alpha())};stroke-width:{width:g}{pattern}"


def _fill(part: Any) -> str:
    """Return the style of a patch or a collection."""
    getters = part.get_facecolor, part.get_edgecolor, part.get_linewidth
    faces, edges, widths = (np.atleast_2d(get()) for get in getters)
    filled = faces.size and not (isinstance(part, Patch) and not part.get_fill())
    style = _paint("fill", faces[0]) if filled else "fill:none"
    if edges.size and widths[0, 0]:
        style += f";{_paint('stroke', edges[0])};stroke-width:{widths[0, 0]:g}"
    return style


def _paint(kind: str, colour: Any, alpha: float | None = None) -> str:
    """Return a style that sets a colour, through its style-sheet variable if there is one, and its opacity."""
    opacity, colour = to_rgba(colour, alpha)[3], to_hex(colour)
    if not opacity:
        return f"{kind}:none"
    name = f"var({NAMES[colour]})" if colour in NAMES else colour
    return f"{kind}:{name}" if opacity == 1 else f"{kind}:{name};{kind}-opacity:{opacity:g}"


def _markers(line: Line2D, places: np.ndarray) -> str:
    """Return the markers of a line at positions (n, 2) as a single path.

    Filled circles are drawn as the round caps of lines of zero length.
    """
    marker, edge = MarkerStyle(line.get_marker(), line.get_fillstyle()), line.get_markeredgewidth()
    size, face, border = line.get_markersize(), line.get_markerfacecolor(), line.get_markeredgecolor()
    if marker.get_marker() in ("o", ".") and to_hex(face) == to_hex(border) and to_rgba(face)[3]:
        width = size * (0.5 if marker.get_marker() == "." else 1) + edge
        points = "".join(f"M{_number(x)} {_number(y)}h0" for x, y in places)
        style = f"{_paint('stroke', face, line.get_alpha())};stroke-width:{width:g};stroke-linecap:round"
        return _path(points, style)
    shape = Affine2D(marker.get_transform().get_matrix()).scale(size, -size)
    commands = (_commands(marker.get_path(), shape + Affine2D().translate(x, y)) for x, y in places)
    filled = _paint("fill", face, line.get_alpha()) if marker.is_filled() else "fill:none"
    return _path("".join(commands), f"{filled};{_paint('stroke', border, line.get_alpha())};stroke-width:{edge:g}")


# ── the legend ──


def _legend(figure: Figure, panel: Panel) -> Iterator[tuple[float, float, Any, Sequence[str], float]]:
    """Yield the entries in the legend of a panel.

    Yields:
        Horizontal position as a fraction of the width, vertical position in points, handle, lines of text, and the
            height in points that the entry adds to the legend.
    """
    if panel.get_legend() is None and not figure.legends:
        return
    entries, columns = panel.entries()
    rows = -(-len(entries) // columns)
    lines = [wrap(label, LABEL_CHARACTERS) for label in entries]
    heights = [LINE * max(map(len, lines[row::rows])) for row in range(rows)]
    for k, (handle, text) in enumerate(zip(entries.values(), lines, strict=True)):
        column, row = divmod(k, rows)
        yield column / columns, sum(heights[:row]), handle, text, heights[row] if column == 0 else 0.0


def _drawn_legend(entries: Sequence[tuple[float, float, Any, Sequence[str], float]], frame: Frame) -> Iterator[str]:
    """Yield the SVG elements of the legend entries, below the axis."""
    for share, below, handle, lines, _ in entries:
        x, y = LINE / 2 + share * (frame.width - LINE), frame.bottom + 3.2 * LINE + below
        middle = y - 0.35 * LEGEND_SIZE
        if isinstance(handle, ErrorbarContainer):
            handle, _, (bar, *_) = handle.lines
            style = f"{_paint('stroke', bar.get_color()[0])};stroke-width:{np.atleast_1d(bar.get_linewidth())[0]:g}"
            yield _path(f"M{_number(x + SWATCH / 2)} {_number(middle - 5)}v10", style)
        if isinstance(handle, Line2D):
            if handle.get_linestyle() != "None":
                yield _path(f"M{_number(x)} {_number(middle)}h{SWATCH:g}", _stroke(handle))
            if handle.get_marker() not in ("", " ", "None", None):
                yield _markers(handle, np.array([[x + SWATCH / 2, middle]]))
        elif isinstance(handle, Patch) and not handle.get_fill():
            yield _path(f"M{_number(x)} {_number(middle)}h{SWATCH:g}", _fill(handle))
        elif handle is not None:
            yield _path(f"M{_number(x)} {_number(middle - 3.5)}h{SWATCH:g}v7h{-SWATCH:g}Z", _fill(handle))
        for k, text in enumerate(lines):
            yield _text(x + SWATCH + 6, y + k * LINE, "start", text, LEGEND_SIZE)
