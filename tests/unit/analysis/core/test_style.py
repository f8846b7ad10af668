"""What curves of a picture look like."""

from idealgas.analysis.core.style import COLOURS, LEGEND_ROWS, LINES, curve_style, panels


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
