"""Whether measurement and theory agree: the chance of a false alarm, and of finding an error, and the words for it."""

import math

import numpy as np
import pytest
from scipy import stats

from idealgas.analysis.check import FALSE_ALARM, POWER, Comparison, PValue, agreement, check_theory
from idealgas.presentation.tables import as_text, format_estimate
from idealgas.statistics.estimates import Estimate


def chance_of_alarm(freedom, theory_error, shift=0.0, compared=1):
    """Probability that |difference| > allowed, over the scatter of a true standard error of 1 as it is estimated."""
    share = np.concatenate((np.logspace(-14, -2, 2000), np.linspace(0.01, 1, 4000)[1:-1]))  # of the distribution
    errors = np.sqrt(stats.chi2(freedom).ppf(share) / freedom)
    rows = (
        Comparison("", "", Estimate(0.0, float(error), freedom + 1.0, 0.0, theory_error), compared) for error in errors
    )
    allowed, whole = np.array([row.allowed for row in rows]), math.hypot(1.0, theory_error)
    missed = stats.norm.sf((allowed - shift) / whole) + stats.norm.cdf((-allowed - shift) / whole)
    return float(np.trapezoid(missed, share) + missed[0] * share[0])


@pytest.mark.parametrize("freedom", [1, 2, 5, 20, 200])
def test_the_chance_of_a_false_alarm_does_not_depend_on_the_samples(freedom):
    assert chance_of_alarm(freedom, 0.0) == pytest.approx(FALSE_ALARM, rel=0.01)
    assert all(chance_of_alarm(freedom, error) <= 1.01 * FALSE_ALARM for error in (0.1, 0.3, 1.0, 3.0))
    assert chance_of_alarm(freedom, 1e6) == pytest.approx(FALSE_ALARM, rel=0.05)


@pytest.mark.parametrize("freedom", [2, 20])
def test_the_chance_of_a_false_alarm_does_not_depend_on_the_rows(freedom):
    """Of 40 rows each has a fortieth of it: Bonferroni."""
    assert chance_of_alarm(freedom, 0.0, compared=40) == pytest.approx(FALSE_ALARM / 40, rel=0.02)


def test_quantiles_of_one_and_two_degrees_of_freedom():
    """Student's quantile is tan(π(q - 1/2)) for one, and (2q - 1)/√(2q(1 - q)) for two degrees of freedom."""
    q = 1 - FALSE_ALARM / 2
    result, two = (Comparison("", "", Estimate(1.0, 0.1, samples, 1.0)) for samples in (2.0, 3.0))
    assert result.allowed == pytest.approx(0.1 * math.tan(math.pi * (q - 0.5)))
    assert two.allowed == pytest.approx(0.1 * (2 * q - 1) / math.sqrt(2 * q * (1 - q)))
    known = Comparison("", "", Estimate(1.0, 0.1, math.inf, 1.0, 0.2))
    assert known.allowed == pytest.approx(3.2905 * math.hypot(0.1, 0.2), rel=1e-4)  # of a normal distribution
    assert known.detectable == pytest.approx((3.2905 + 1.6449) * math.hypot(0.1, 0.2), rel=1e-4)


@pytest.mark.parametrize("freedom", [2, 5, 20, 200])
def test_a_detectable_error_is_found(freedom):
    """With 95 %, up to 2 % by the normal approximation."""
    detectable = Comparison("", "", Estimate(0.0, 1.0, freedom + 1.0, 0.0)).detectable
    assert chance_of_alarm(freedom, 0.0, detectable) == pytest.approx(POWER, abs=0.02)


def test_a_check_reports_what_it_compares():
    few = Estimate(1.4, 0.08, 6.0, 1.0)  # five standard errors by five degrees of freedom
    checked = check_theory([("few", "law", few), ("none", None, Estimate(1.0, 0.1, 10.0))])
    assert [row.name for row in checked.compared] == ["few"]  # the other has no theory
    assert checked.agrees is True
    many = check_theory([("few", "law", few), ("many", "law", Estimate(1.4, 0.08, 600.0, 1.0))])
    assert many.agrees is False
    assert str(many).startswith("Measurement and theory do not agree in many. A correct gas fails this check with a ")
    (row,) = check_theory([("few", "law", few)]).as_dict()["compared"]
    assert (row["name"], row["source"], row["difference"], row["agrees"]) == ("few", "law", pytest.approx(0.4), True)
    assert row["allowed"] == pytest.approx(0.08 * stats.t.isf(FALSE_ALARM / 2, 5))
    rows = [line.split() for line in as_text(many.tables()).splitlines()[-2:]]
    assert [(row[0], row[-1]) for row in rows] == [("few", "agrees"), ("many", "differs")]
    assert str(check_theory([("a", None, Estimate(1.0, 0.1, 10.0))], "why")) == "Theory is not available: why."


@pytest.mark.parametrize(
    "undecided",
    [
        Estimate(1.0, math.nan, 0.0, 1.0),  # without an error bar
        Estimate(0.3, 0.2, 3.0, 1.0),  # −3.5σ, and Student's t of two degrees of freedom allows 32σ
        Estimate(1.3, 0.4, 50.0, 1.0),  # it would not show an error of 100 %
        Estimate(0.0, 0.1, 4.0, 0.0),
    ],
)
def test_samples_that_could_not_have_shown_otherwise_do_not_agree(undecided):
    checked = check_theory([("a", "law", undecided)])
    assert checked.agrees is None
    assert str(checked).startswith("Too few samples to tell whether measurement and theory agree.")
    assert as_text(checked.tables()).splitlines()[-1].endswith("too few samples")
    beside = check_theory([("a", "law", undecided), ("b", "law", Estimate(1.0, 0.01, 50.0, 1.0))])
    assert (beside.agrees, [row.agrees for row in beside.compared]) == (True, [None, True])


def test_rows_are_counted():
    """3.5 standard errors of one quantity are too many, and those of one among eight are not."""
    off, right = Estimate(1.035, 0.01, math.inf, 1.0), Estimate(1.0, 0.01, math.inf, 1.0)
    assert check_theory([("off", "law", off)]).agrees is False
    assert check_theory([("off", "law", off), *[("right", "law", right)] * 7]).agrees is True
    assert [PValue(5e-4, 100).agrees(rows) for rows in (1, 2, 3)] == [False, True, True]
    assert [PValue(p, 29).agrees(1) for p in (0.9, 0.001, 0.0009)] == [None, None, False]
    assert PValue(0.0011, 30).agrees(1) is True


@pytest.mark.parametrize(
    ("found", "said"),
    [
        ([Estimate(1.02, 0.02, math.inf, 1.0)], "agrees with the law (1, +1.0σ)"),
        ([Estimate(0.92, 0.03, math.inf, 1.0, 0.04)], "agrees with the law (1, −1.6σ)"),
        ([Estimate(1.1, 0.02, math.inf, 1.0)], "differs from the law (1, +5.0σ)"),
        ([Estimate(1.1, 0.02, 5.0, 1.0)], "agrees with the law (1, +5.0σ of 5 samples)"),  # up to 8.6σ
        ([Estimate(1.0, math.nan, 0.0, 2.0)], "no error bar to compare it with the law (2)"),
        ([Estimate(1.0, 0.1, 9.0)], "theory is not available: why"),
        ([Estimate(5, 2, 3.0, 12)], "too few samples to tell whether it agrees with the law (12, −3.5σ of 3 samples)"),
        ([Estimate(1.0, 0.1, 99.0, z) for z in (1.1, 1.2)], "both agree with the law (largest deviation −2.0σ, 1)"),
        ([Estimate(1.0, 0.1, 99.0, z) for z in (1, 3, 2)], "2 of 3 differ from the law (largest deviation −20.0σ, 1)"),
        (
            [Estimate(1.0, 0.1, 99.0, 1.1), Estimate(1.0, 0.5, 2.0, 1.5)],
            "1 of 2 agrees with the law (largest deviation −1.0σ, 0), too few samples for a verdict on 1",
        ),
        ([Estimate(1.0, 0.5, 2.0, 1.5)] * 2, "too few samples to tell whether they agree with the law"),
        (
            [Estimate(1.0, 0.1, 99.0, 1.1), PValue(1e-9, 80)],
            "1 of 2 differs from the law (largest deviation p = 1e-09, 1)",
        ),
    ],
)  # fmt: skip
def test_agreement_is_that_of_checks_in_words(found, said):
    rows = [(str(k), each) for k, each in enumerate(found)]
    assert agreement(rows, "the law", "why") == said
    if all(isinstance(each, Estimate) and each.theory for each in found):
        checked = check_theory((name, None, each) for name, each in rows).agrees
        assert checked is (False if "differ" in said else None if said[:2] in ("to", "no") else True)


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
        (123456.0, 56.0, "123460(60)"),
        (1234567.0, 560.0, "1.2346(6)e6"),
        (0.5, 0.0, "0.5"),
        (0.5, math.nan, "0.5"),
    ],
)
def test_an_estimate_has_as_many_digits_as_its_error_tells(value, error, text):
    assert format_estimate(Estimate(value, error, 10.0)) == text
