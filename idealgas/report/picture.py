"""Put figures into a report as SVG: each panel separately, in the colours of the page, with the scales of its axes."""

import html
import io
import json
import re
from dataclasses import asdict

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from idealgas.presentation.style import Panel, disable_mathtext
from idealgas.presentation.tables import escape
from idealgas.report.drawing import NAMES, POINT, Frame, draw, is_drawable

MARGIN = 0.06
"""Free margin above and below a panel, inches."""


def html_pictures(figure: Figure, caption: str, key: str) -> str:
    """Return a figure as HTML: an SVG for each panel, and the caption below them.

    Args:
        figure: the figure.
        caption: text of the caption.
        key: name of the figure, which must be unique on the page.
    """
    panels = [ax for ax in figure.axes if isinstance(ax, Panel)]
    with rc_context({"figure.autolayout": False, "figure.constrained_layout.use": False}):
        drawn = _drawn(figure, panels, key) if is_drawable(figure) else _drawn_by_matplotlib(figure, panels, key)
    pictures = (_svg(panel, *drawing) for panel, drawing in zip(panels, drawn, strict=True))
    return f"<figure>{''.join(pictures)}<figcaption>{escape(caption)}</figcaption></figure>"


def _svg(panel: Panel, drawing: str, frame: Frame) -> str:
    """Return the SVG of a panel, with the data from which the page marks the instant that the player shows.

    These data are the position and the limits of the axes, and whether the panel shows time or strips of the box.
    """
    axes = {
        "place": frame[2:],
        "x": list(map(float, panel.get_xlim())),
        "y": list(map(float, panel.get_ylim())),
        "logarithmic": panel.get_yscale() == "log",
        "time": panel.in_time,
        "strips": asdict(panel.strips) if panel.strips else None,
    }
    words = escape(f"{panel.get_ylabel()} against {panel.get_xlabel()}")
    shown = html.escape(json.dumps(axes, allow_nan=False))
    size = f"0 0 {frame.width:.6g} {frame.height:.6g}"
    return f'<svg viewBox="{size}" role="img" aria-label="{words}" data-axes="{shown}">{drawing}</svg>'


def _drawn(figure: Figure, panels: list[Panel], key: str) -> list[tuple[str, Frame]]:
    """Return the drawing and the position of the axes of each panel in a figure."""
    width, height = POINT * figure.get_size_inches()
    figure.set_layout_engine(None)
    grids = [spec.get_gridspec() for panel in panels if (spec := panel.get_subplotspec())]
    return [
        draw(figure, panel, (width / grid.ncols, height / grid.nrows), f"{key}-{k}")
        for k, (panel, grid) in enumerate(zip(panels, grids, strict=True))
    ]


# ── figures drawn by matplotlib ──


def _drawn_by_matplotlib(figure: Figure, panels: list[Panel], key: str) -> list[tuple[str, Frame]]:
    """Return the drawing and the position of the axes of each panel in a figure that contains images or text."""
    disable_mathtext(figure)
    if (engine := figure.get_layout_engine()) is not None:
        engine.execute(figure)
    figure.set_layout_engine(None)  # "none" would leave a placeholder engine, which draws every figure twice
    return [_picture(figure, panel, panels, f"{key}-{k}") for k, panel in enumerate(panels)]


def _picture(figure: Figure, panel: Panel, panels: list[Panel], key: str) -> tuple[str, Frame]:
    """Return the drawing of a panel and the position of its axes.

    Its ids are unique on the page, and its numbers are the same whenever the log is the same.
    """
    part = _part(figure, panel, panels)
    for each in panels:
        each.set_visible(each is panel)
    file = io.StringIO()
    with rc_context({"svg.hashsalt": key, "svg.fonttype": "none"}):
        figure.savefig(file, format="svg", metadata={"Date": None}, bbox_inches=part, transparent=True)
    for each in panels:
        each.set_visible(True)
    _, _, drawing = file.getvalue().partition("</metadata>")
    drawing = re.sub(r"<style.*?</style>", "", drawing, flags=re.DOTALL)
    drawing = re.sub(r"<!--.*?-->\n?", "", drawing, flags=re.DOTALL)
    drawing = re.sub(r'<g id="[^"]*"', "<g", drawing).replace("xlink:href", "href")
    drawing = re.sub(r" ?font-family: [^;\"]*;?", "", drawing)
    drawing = re.sub(r"#[0-9a-f]{6}\b", lambda match: _colour(match[0]), drawing)
    drawing = re.sub(r"\n\s*", "\n", drawing).rpartition("</svg>")[0]
    box = panel.get_window_extent().transformed(figure.dpi_scale_trans.inverted())
    left, right = (POINT * (x - part.x0) for x in (box.x0, box.x1))
    bottom, top = (POINT * (part.y1 - y) for y in (box.y0, box.y1))
    return drawing, Frame(POINT * part.width, POINT * part.height, left, right, bottom, top)


def _colour(colour: str) -> str:
    return f"var({NAMES[colour]})" if colour in NAMES else colour


def _part(figure: Figure, panel: Panel, panels: list[Panel]) -> Bbox:
    """Return the area of a figure that belongs to a panel, inches.

    It is the whole figure if there is only one panel; otherwise it has the width of the panel's column and the height
    of the panel with its text.
    """
    width, height = figure.get_size_inches()
    spec = panel.get_subplotspec()
    if len(panels) == 1 or spec is None:
        return Bbox.from_extents(0, 0, width, height)
    columns = spec.get_gridspec().ncols
    extent = panel.get_tightbbox()
    assert extent is not None
    low, high = extent.y0 / figure.dpi - MARGIN, extent.y1 / figure.dpi + MARGIN
    return Bbox.from_extents(spec.colspan.start / columns * width, low, spec.colspan.stop / columns * width, high)
