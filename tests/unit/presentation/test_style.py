"""What curves of a picture look like."""

import numpy as np
import pytest
from helpers.logs import raised
from matplotlib.collections import PolyCollection

from idealgas.errors import OutputError
from idealgas.presentation.style import COLOURS, LEGEND_ROWS, LINES, curve_style, panels, save
from idealgas.statistics.estimates import Estimate


def test_no_two_curves_look_the_same():
    looks = [curve_style(k) for k in range(len(COLOURS) * len(LINES))]
    assert len(set(looks)) == len({(colour, line) for colour, line, _ in looks}) == len(looks)
    assert len({(colour, marker) for colour, _, marker in looks}) == len(looks)
    assert [colour for colour, _, _ in looks[: len(COLOURS)]] == list(COLOURS)


def test_a_legend_has_each_label_once_and_leaves_room_for_the_panel():
    figure, (ax,) = panels(1)
    for k in range(100):
        ax.plot([0, 1], [0, k], label=f"gas {k // 2}")
    names = [text.get_text() for text in ax.legend().get_texts()]
    assert names == [*(f"gas {k}" for k in range(2 * LEGEND_ROWS - 1)), f"and {50 - 2 * LEGEND_ROWS + 1} more"]
    figure.draw_without_rendering()
    assert ax.get_position().height > 0.2


def test_numbers_of_an_axis_are_whole():
    """Not what has to be added to a number in a corner."""
    figure, (ax,) = panels(1)
    ax.plot([0, 1], [1.00001, 1.00002])
    figure.draw_without_rendering()
    assert ax.yaxis.get_offset_text().get_text() == ""


def test_a_theory_is_a_line_in_a_band_of_its_error():
    """For all places, along a curve, and in a row of a list."""
    _, (everywhere, along, row) = panels(3)
    everywhere.theory(None, 2.0, 0.5)
    (band,) = everywhere.patches
    assert (band.get_y(), band.get_height()) == (1.5, 1.0)
    along.theory([0, 1], np.array([1.0, 3.0]), np.array([0.0, 0.5]))
    (band,) = along.collections
    assert band.get_paths()[0].vertices[:, 1].max() == 3.5
    row.theory_of_row(4, Estimate(1.0, 0.1, 9.0, theory=2.0, theory_error=0.25))
    row.theory_of_row(5, Estimate(1.0, 0.1, 9.0))
    (band,) = row.collections
    assert isinstance(band, PolyCollection)
    assert band.get_paths()[0].get_extents().extents.tolist() == pytest.approx([1.75, 3.65, 2.25, 4.35])
    along.theory([0, 1], [1.0, 1.0], 0.0)
    assert (len(along.collections), len(row.lines)) == (1, 1)


def test_pictures_are_written_or_refused(tmp_path):
    figure, _ = panels(1)
    save(figure, tmp_path / "temperature.png")
    assert (tmp_path / "temperature.png").read_bytes().startswith(b"\x89PNG")
    raised("no folder", save, figure, tmp_path / "no such folder" / "temperature.png", error=OutputError)
