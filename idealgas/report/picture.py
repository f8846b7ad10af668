"""Pictures of a report as SVG in the page: each panel apart, in the colours of the page, with what its axes show."""

import html
import io
import json
import re
from dataclasses import asdict
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from idealgas.analysis.core.style import BLACK, COLOURS, GREY, GRID, Panel, disable_mathtext
from idealgas.analysis.core.tables import escape

POINT = 72
"""Units of an SVG on an inch."""

MARGIN = 0.06
"""Free margin above and below a panel, inches."""

NAMES = {colour.lower(): f"--c{k}" for k, colour in enumerate(COLOURS)} | {
    BLACK: "--ink",
    GREY.lower(): "--soft",
    GRID: "--line",
}
"""Variables of the page's style for the colours of pictures."""


def html_pictures(figure: Figure, caption: str, key: str) -> str:
    """A figure as HTML: an SVG for each panel and the caption below; key: a name of its own on the page."""
    disable_mathtext(figure)
    if (engine := figure.get_layout_engine()) is not None:
        engine.execute(figure)
    panels = [ax for ax in figure.axes if isinstance(ax, Panel)]
    with rc_context({"figure.autolayout": False, "figure.constrained_layout.use": False}):
        figure.set_layout_engine(None)  # "none" leaves one in its place, for which every picture is drawn twice
        pictures = [_picture(figure, panel, panels, f"{key}-{k}") for k, panel in enumerate(panels)]
    return f"<figure>{''.join(pictures)}<figcaption>{escape(caption)}</figcaption></figure>"


def _picture(figure: Figure, panel: Panel, panels: list[Panel], key: str) -> str:
    """SVG of one panel of a figure; its ids are its own, and its numbers are the same for the same log."""
    frame = _frame(figure, panel, panels)
    for other in panels:
        other.set_visible(other is panel)
    file = io.StringIO()
    with rc_context({"svg.hashsalt": key, "svg.fonttype": "none"}):
        figure.savefig(file, format="svg", metadata={"Date": None}, bbox_inches=frame, transparent=True)
    for other in panels:
        other.set_visible(True)
    _, _, drawing = file.getvalue().partition("</metadata>")
    drawing = re.sub(r"<style.*?</style>", "", drawing, flags=re.DOTALL)
    drawing = re.sub(r"<!--.*?-->\n?", "", drawing, flags=re.DOTALL)
    drawing = re.sub(r'<g id="[^"]*"', "<g", drawing).replace("xlink:href", "href")
    drawing = re.sub(r" ?font-family: [^;\"]*;?", "", drawing)
    drawing = re.sub(r"#[0-9a-f]{6}\b", lambda found: _colour(found[0]), drawing)
    drawing = re.sub(r"\n\s*", "\n", drawing)
    size = f"0 0 {frame.width * POINT:.6g} {frame.height * POINT:.6g}"
    words = escape(f"{panel.get_ylabel()} against {panel.get_xlabel()}")
    shown = html.escape(json.dumps(_axes(panel, frame), allow_nan=False))
    return f'<svg viewBox="{size}" role="img" aria-label="{words}" data-axes="{shown}">{drawing}'


def _colour(colour: str) -> str:
    return f"var({NAMES[colour]})" if colour in NAMES else colour


def _frame(figure: Figure, panel: Panel, panels: list[Panel]) -> Bbox:
    """Part of a figure that a panel takes, inches: all of it, or the width of its column and its own height."""
    width, height = figure.get_size_inches()
    spec = panel.get_subplotspec()
    if len(panels) == 1 or spec is None:
        return Bbox.from_extents(0, 0, width, height)
    columns = spec.get_gridspec().ncols
    own = panel.get_tightbbox()
    assert own is not None
    low, high = own.y0 / figure.dpi - MARGIN, own.y1 / figure.dpi + MARGIN
    return Bbox.from_extents(spec.colspan.start / columns * width, low, spec.colspan.stop / columns * width, high)


def _axes(panel: Panel, frame: Bbox) -> dict[str, Any]:
    """Where the axes of a panel are in its picture, and what they show: limits of both, and what an instant shows."""
    box = panel.get_window_extent().transformed(panel.figure.dpi_scale_trans.inverted())
    left, right = (POINT * (x - frame.x0) for x in (box.x0, box.x1))
    bottom, top = (POINT * (frame.y1 - y) for y in (box.y0, box.y1))
    return {
        "place": [left, right, bottom, top],
        "x": list(map(float, panel.get_xlim())),
        "y": list(map(float, panel.get_ylim())),
        "logarithmic": panel.get_yscale() == "log",
        "time": panel.in_time,
        "strips": asdict(panel.strips) if panel.strips else None,
    }
