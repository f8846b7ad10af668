"""Pictures of a report."""

import html
import json
import re

import numpy as np
import pytest
from matplotlib import rc_context

from idealgas.presentation.style import panels
from idealgas.report.picture import html_pictures


def pictures() -> str:
    figure, (above, below) = panels(2)
    for ax in (above, below):
        ax.plot([0.0, 1.0], [1.0, 1e6], label="gas")
        ax.set_ylabel("pressure (energy/length²)")
        ax.set_xlabel("t (time)")
        ax.legend()
    return html_pictures(figure, "Pressure against time", "p0")


@pytest.mark.parametrize("own", ["figure.constrained_layout.use", "figure.autolayout"])
def test_people_may_have_a_layout_for_pictures_of_their_own(own):
    usual = pictures()
    assert usual.count("<svg") == 2
    with rc_context({own: True}):
        assert pictures() == usual


def svg(draw, **limits) -> tuple[dict, str]:
    """What the axes of a panel show, and its SVG."""
    figure, (ax,) = panels(1)
    draw(ax)
    ax.set(xlabel="t (time)", ylabel="x (length)", **limits)
    text = html_pictures(figure, "", "p0")
    return json.loads(html.unescape(re.search('data-axes="(.*?)"', text)[1])), text


def places(commands: str) -> np.ndarray:
    """Places (n, 2) in a path."""
    return np.array(re.findall(r"[ML](-?[0-9.]+) (-?[0-9.]+)", commands), float)


@pytest.mark.parametrize("scale", ["linear", "log"])
def test_a_line_goes_through_its_points(scale):
    x, y = np.array([1.0, 3.0, 4.0]), np.array([1.0, 100.0, 1000.0])
    axes, text = svg(lambda ax: ax.plot(x, y, color="#D55E00"), yscale=scale, xlim=(0, 5), ylim=(1, 2000))
    left, right, bottom, top = axes["place"]
    (drawn,) = re.findall('<path d="([^"]*)" style="fill:none;stroke:var\\(--c1\\);stroke-width:1.5"/>', text)
    share = (y - 1) / 1999 if scale == "linear" else np.log(y) / np.log(2000)
    expected = np.transpose((left + (right - left) * x / 5, bottom + (top - bottom) * share))
    assert np.abs(places(drawn) - expected).max() < 0.051  # one decimal


def test_a_bar_is_as_long_as_its_error():
    axes, text = svg(lambda ax: ax.errorbar([1], [2], [0.5], fmt="none"), xlim=(0, 2), ylim=(0, 4))
    _, _, bottom, top = axes["place"]
    (low, high) = places(re.findall(r'<path d="(M[^"HZv]*)"', text.partition("clip-path")[2])[0])[:, 1]
    assert abs(abs(high - low) - (bottom - top) / 4) < 0.11


def test_ticks_have_numbers_and_powers():
    _, linear = svg(lambda ax: ax.plot([0, 1], [-1, 1]), xlim=(0, 1))
    assert {"0.0", "0.2", "1.0", "−1.00", "0.50"} <= set(re.findall("<text[^>]*>(.*?)</text>", linear))
    _, logarithmic = svg(lambda ax: ax.plot([0, 1], [1e-3, 10]), yscale="log")
    assert {"10⁻³", "10⁰", "10¹"} <= set(re.findall("<text[^>]*>(.*?)</text>", logarithmic))


def test_labels_are_shown_as_they_are():
    def draw(ax):
        ax.plot([0, 1], [0, 1], label="cost $a$ & <b>")
        ax.fill_between([0, 1], [0, 0], [1, 1], label="band", alpha=0.2)
        ax.legend()

    _, text = svg(draw)
    assert re.findall("<text[^>]*>(.*?)</text>", text)[-2:] == ["cost $a$ &amp; &lt;b&gt;", "band"]


def test_matplotlib_draws_what_the_page_cannot():
    _, text = svg(lambda ax: ax.text(0.5, 0.5, "here"))
    assert ">here</text>" in text
    assert 'clip-path="url(#p0-0)"' not in text
