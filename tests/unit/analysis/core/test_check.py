"""Checks against theory: the chance of a false alarm, and of finding an error, by quadrature and by closed forms."""

import math

import numpy as np
import pytest
from scipy import stats

from idealgas.analysis.core.check import FALSE_ALARM, POWER, Comparison, agreement, check_theory
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.tables import as_text, format_estimate
from idealgas.errors import UserError


def chance_of_alarm(freedom, theory_error, shift=0.0):
    """Probability that |difference| > allowed, over the scatter of a true standard error of 1 as it is estimated."""
    share = np.concatenate((np.logspace(-14, -2, 2000), np.linspace(0.01, 1, 4000)[1:-1]))  # of the distribution
    errors = np.sqrt(stats.chi2(freedom).ppf(share) / freedom)
    rows = (Comparison("", "", Estimate(0.0, float(error), freedom + 1.0, 0.0, theory_error)) for error in errors)
    allowed, whole = np.array([row.allowed for row in rows]), math.hypot(1.0, theory_error)
    missed = stats.norm.sf((allowed - shift) / whole) + stats.norm.cdf((-allowed - shift) / whole)
    return float(np.trapezoid(missed, share) + missed[0] * share[0])


@pytest.mark.parametrize("freedom", [1, 2, 5, 20, 200])
def test_the_chance_of_a_false_alarm_does_not_depend_on_the_samples(freedom):
    assert pytest.approx(2 * stats.norm.sf(4)) == FALSE_ALARM
    assert chance_of_alarm(freedom, 0.0) == pytest.approx(FALSE_ALARM, rel=0.01)
    assert all(chance_of_alarm(freedom, error) <= 1.01 * FALSE_ALARM for error in (0.1, 0.3, 1.0, 3.0))
    assert chance_of_alarm(freedom, 1e6) == pytest.approx(FALSE_ALARM, rel=0.05)


def test_quantiles_of_one_and_two_degrees_of_freedom():
    """Student's quantile is tan(π(q - 1/2)) for one, and (2q - 1)/√(2q(1 - q)) for two degrees of freedom."""
    q = 1 - FALSE_ALARM / 2
    one, two = (Comparison("", "", Estimate(1.0, 0.1, samples, 1.0)) for samples in (2.0, 3.0))
    assert one.allowed == pytest.approx(0.1 * math.tan(math.pi * (q - 0.5)))
    assert two.allowed == pytest.approx(0.1 * (2 * q - 1) / math.sqrt(2 * q * (1 - q)))
    known = Comparison("", "", Estimate(1.0, 0.1, math.inf, 1.0, 0.2))
    assert known.allowed == pytest.approx(4 * math.hypot(0.1, 0.2))
    assert known.detectable == pytest.approx((4 + stats.norm.ppf(POWER)) * math.hypot(0.1, 0.2))


@pytest.mark.parametrize("freedom", [2, 5, 20, 200])
def test_a_detectable_error_is_found(freedom):
    """With 95 %, up to 2 % by the normal approximation."""
    detectable = Comparison("", "", Estimate(0.0, 1.0, freedom + 1.0, 0.0)).detectable
    assert chance_of_alarm(freedom, 0.0, detectable) == pytest.approx(POWER, abs=0.02)


def test_a_check_reports_what_it_compares():
    few = Estimate(1.5, 0.1, 6.0, 1.0)  # five standard errors by five degrees of freedom
    checked = check_theory([("few", "law", few), ("none", None, Estimate(1.0, 0.1, 10.0))])
    assert [row.name for row in checked.compared] == ["few"]  # the other has no theory
    assert checked.agrees is True
    many = check_theory([("few", "law", few), ("many", "law", Estimate(1.5, 0.1, 600.0, 1.0))])
    assert many.agrees is False
    assert str(many).startswith("Measurement and theory do not agree in many. In each row a correct gas exceeds")
    (row,) = check_theory([("few", "law", few)]).as_dict()["compared"]
    assert (row["name"], row["source"], row["difference"]) == ("few", "law", 0.5)
    assert row["allowed"] == pytest.approx(0.1 * stats.t.isf(FALSE_ALARM / 2, 5))
    assert as_text(checked.tables()).splitlines()[-1].split() == ["few", "1:", "law", "+0.5", "1.2", "1.9"]
    assert str(check_theory([("a", None, Estimate(1.0, 0.1, 10.0))], "why")) == "No theory here: why."
    with pytest.raises(UserError, match="nothing to check"):
        check_theory([("a", "law", Estimate(1.0, math.nan, 0.0, 1.0))])


@pytest.mark.parametrize(
    ("found", "said"),
    [
        ([Estimate(1.02, 0.02, math.inf, 1.0)], "agrees with the law (1, +1.0σ)"),
        ([Estimate(0.92, 0.03, math.inf, 1.0, 0.04)], "agrees with the law (1, −1.6σ)"),
        ([Estimate(1.1, 0.02, math.inf, 1.0)], "differs from the law (1, +5.0σ)"),
        ([Estimate(1.1, 0.02, 5.0, 1.0)], "agrees with the law (1, +5.0σ)"),  # Student's t of 4: up to 17σ
        ([Estimate(1.0, math.nan, 0.0, 2.0)], "the law has 2, but there is no error bar"),
        ([Estimate(1.0, 0.1, 9.0)], "no theory here: why"),
        ([Estimate(1.0, 0.1, 99.0, z) for z in (1.1, 1.2)], "both agree with the law (largest deviation −2.0σ, 1)"),
        ([Estimate(1.0, 0.1, 99.0, z) for z in (1, 3, 2)], "2 of 3 differ from the law (largest deviation −20.0σ, 1)"),
    ],
)
def test_agreement_is_that_of_checks_in_words(found, said):
    rows = [(str(k), one) for k, one in enumerate(found)]
    assert agreement(rows, "the law", "why") == said
    if rows[0][1].theory and rows[0][1].standard_error > 0:
        checked = check_theory((name, None, one) for name, one in rows)
        assert ("agree" in said) == checked.agrees


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1.10986, 0.00029, "1.1099(3)"),  # CODATA's notation: the error in units of the last digit
        (1.10986, 0.00013, "1.10986(13)"),
        (16.23, 4.1, "16(4)"),
        (16.23, 1.33, "16.2(1.3)"),
        (16.23, 0.97, "16.2(1.0)"),
        (0.998, 0.098, "1.00(10)"),
        (-0.0123, 0.004, "-0.012(4)"),
        (1.2345e-9, 3e-12, "1.234(3)e-9"),
        (6.02e23, 4e21, "6.02(4)e23"),
        (1234.5, 56.0, "1230(60)"),
        (0.5, 0.0, "0.5"),
        (0.5, math.nan, "0.5"),
    ],
)
def test_an_estimate_has_as_many_digits_as_its_error_tells(value, error, text):
    assert format_estimate(Estimate(value, error, 10.0)) == text
