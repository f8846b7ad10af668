"""Pictures of a report."""

import pytest
from matplotlib import rc_context

from idealgas.analysis.core.style import panels
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
