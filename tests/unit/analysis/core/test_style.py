"""What curves of a picture look like."""

from idealgas.analysis.core.style import COLOURS, LINES, look


def test_no_two_curves_look_the_same():
    looks = [look(k) for k in range(len(COLOURS) * len(LINES))]
    assert len(set(looks)) == len({(colour, line) for colour, line, _ in looks}) == len(looks)
    assert len({(colour, marker) for colour, _, marker in looks}) == len(looks)
    assert [colour for colour, _, _ in looks[: len(COLOURS)]] == list(COLOURS)
