"""Agreement between measurement and theory: one rule for headlines, checks, JSON and reports.

A measurement differs from theory if their difference exceeds the limit from Student's t, which takes the number of
compared rows into account. Otherwise they agree if there are enough samples to reveal a difference; if there are not,
no verdict is given.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from idealgas.fields import OMITTED, Key, as_dict, reported
from idealgas.presentation.tables import Cell, Number, Table
from idealgas.statistics.estimates import Estimate

FALSE_ALARM = 1e-3
"""Probability that a correct gas fails a comparison with theory, whatever the number of rows."""

POWER = 0.95
"""Probability with which a comparison reveals the smallest error that it reports as detectable."""

FEWEST = 5.0
"""Smallest number of independent samples for which an estimate can be said to agree with theory."""

FEWEST_OF_LAW = 30.0
"""Smallest number of independent samples that can agree with a law.

For 30 samples of the law itself, the Kolmogorov-Smirnov distance exceeds 0.24 with a probability of 5 %.
"""

ROUGH = 20.0
"""Number of independent samples below which a deviation is printed with this number.

Student's t distribution then differs noticeably from the normal distribution.
"""

NAMED = 3
"""Largest number of rows with too few samples that are listed by name."""

VERDICTS = {True: "agrees", False: "differs", None: "too few samples"}


class PValue(NamedTuple):
    """p-value of a test of samples against a law, and the number of independent samples."""

    value: float
    samples: float

    def agrees(self, rows: int) -> bool | None:
        """Return whether the samples agree with the law in a comparison of `rows` rows; None with too few samples."""
        if self.value < FALSE_ALARM / rows:
            return False
        return True if self.samples >= FEWEST_OF_LAW else None


@dataclass(frozen=True)
class Comparison:
    """One row of a comparison: a measured and a theoretical value, in the unit of the quantity.

    Attributes:
        name: name of the quantity.
        source: name of the theory.
        estimate: measured and theoretical values.
        rows: number of rows in the whole comparison.
    """

    name: str
    source: str
    estimate: Estimate
    rows: Annotated[int, OMITTED] = 1

    @property
    @reported
    def difference(self) -> float:
        """Measured value minus theoretical value."""
        assert self.estimate.theory is not None
        return self.estimate.value - self.estimate.theory

    @property
    @reported
    def allowed(self) -> float:
        """Largest allowed difference, which a correct gas exceeds with a probability of FALSE_ALARM / rows.

        It is the root of the sum of the squares of two limits: that of Student's t for the standard error, and that of
        the normal distribution for the error of theory. The probability is exact if only one of the two errors is
        present, and smaller if both are.
        """
        from scipy import special

        return math.hypot(self._by_student, special.ndtri(1 - self._false_alarm / 2) * self.estimate.theory_error)

    @property
    @reported
    def detectable(self) -> float:
        """Smallest error of the measurement that the comparison reveals with a probability of POWER.

        It follows from the normal approximation to the noncentral t distribution (Johnson & Welch, Biometrika 31, 362
        (1940)).
        """
        return self.allowed + self._margin(self.estimate.theory_error)

    @property
    @reported
    def agrees(self) -> bool | None:
        """Whether measurement and theory agree; None if there are too few samples for a verdict.

        There are too few samples if there is no error bar, if there are fewer than FEWEST independent samples, or if
        the comparison could not reveal an error as large as the theoretical value, unless this value is zero.
        """
        deviation, theory = self.estimate.deviation, self.estimate.theory
        if deviation is None or not math.isfinite(deviation):
            return None
        if abs(self.difference) > self.allowed:
            return False
        resolved = not theory or self._by_student + self._margin(0.0) <= abs(theory)
        return True if resolved and self.estimate.independent_samples >= FEWEST else None

    @property
    def _false_alarm(self) -> float:
        return FALSE_ALARM / self.rows

    @property
    def _freedom(self) -> float:
        return max(self.estimate.independent_samples - 1, 1.0)

    @property
    def _by_student(self) -> float:
        from scipy import special

        return float(special.stdtrit(self._freedom, 1 - self._false_alarm / 2)) * self.estimate.standard_error

    def _margin(self, theory_error: float) -> float:
        """Return by how much an error must exceed the allowed difference to be revealed with a probability of POWER."""
        from scipy import special

        of_allowed = self._by_student / math.sqrt(2 * self._freedom)
        return float(special.ndtri(POWER)) * math.hypot(self.estimate.standard_error, theory_error, of_allowed)


@dataclass(frozen=True)
class CheckResult:
    """Result of a check of measurement against theory.

    Attributes:
        compared: compared rows.
        reason: why theory is not available, as part of a sentence; None if theory is available.
    """

    compared: tuple[Comparison, ...] = ()
    reason: Annotated[str | None, Key("no_theory")] = None

    @property
    @reported
    def agrees(self) -> bool | None:
        """Whether measurement and theory agree in all rows with enough samples; None if there are no such rows."""
        verdicts = {row.agrees for row in self.compared}
        return False if False in verdicts else True if True in verdicts else None

    def as_dict(self) -> dict[str, Any]:
        """Return plain values by name, ready for JSON."""
        return as_dict(self)

    def tables(self) -> list[Table]:
        """Return the table of comparisons; an empty list without theory."""
        heads = ("", "compared with", "difference", "allowed ±", "detectable", "verdict")
        rows: list[Sequence[Cell]] = []
        for row in self.compared:
            compared = f"{row.estimate.theory:.6g}: {row.source}", Number(row.difference, "+.2g")
            limits = (Number(x if math.isfinite(x) else None, ".2g") for x in (row.allowed, row.detectable))
            rows.append((row.name, *compared, *limits, VERDICTS[row.agrees]))
        return [Table("Check: difference between measurement and theory", heads, rows)] if rows else []

    def __str__(self) -> str:
        """Return the verdict in sentences."""
        if not self.compared:
            return f"Theory is not available: {self.reason}."
        failed = [row.name for row in self.compared if row.agrees is False]
        if self.agrees is None:
            verdict = "Too few samples to tell whether measurement and theory agree"
        else:
            verdict = "Measurement and theory " + (f"do not agree in {'; '.join(failed)}" if failed else "agree")
        return (
            f"{verdict}. A correct gas fails this check with a probability of {FALSE_ALARM:g}; an error of the "
            f"detectable size is found with a probability of {POWER:.0%}."
        )


def check_theory(rows: Iterable[tuple[str, str | None, Estimate]], reason: str | None = None) -> CheckResult:
    """Compare each estimate that has a theoretical value with this value.

    Args:
        rows: for each estimate, its name, the name of the theory (None for "theory"), and the estimate.
        reason: why theory is not available, as part of a sentence; used if no estimate has a theoretical value.
    """
    known = [(name, source or "theory", value) for name, source, value in rows if value.theory is not None]
    compared = tuple(Comparison(name, source, value, len(known)) for name, source, value in known)
    return CheckResult(compared, None if compared else reason)


def agreement(
    results: Iterable[tuple[str, Estimate | PValue]], theory: str = "theory", reason: str | None = None
) -> str:
    """Return a predicate that states whether estimates agree with theory, by the same rule as checks.

    Args:
        results: names with estimates or tests of laws; if there are several, the one that deviates most is named.
        theory: name of the theory.
        reason: why theory is not available, as part of a sentence.
    """
    known = [(name, item) for name, item in results if isinstance(item, PValue) or item.theory is not None]
    if not known:
        return f"theory is not available: {reason}" if reason else "theory is not available"
    rows = [_row(name, theory, item, len(known)) for name, item in known]
    rows = [row for row in rows if row.shown] or rows
    differing, agreeing, few = ([row for row in rows if row.agrees is verdict] for verdict in (False, True, None))
    if len(rows) == 1:
        ((_, agrees, _, shown, value),) = rows
        beside = ", ".join(filter(None, (value, shown)))
        if not shown:
            return f"no error bar to compare it with {theory} ({value})"
        if agrees is None:
            return f"too few samples to tell whether it agrees with {theory} ({beside})"
        return f"{'agrees with' if agrees else 'differs from'} {theory} ({beside})"
    if not differing and not agreeing:
        return f"too few samples to tell whether they agree with {theory}"
    worst = max(differing or agreeing, key=lambda row: row.size)
    most = f"largest deviation {worst.shown}, {worst.name}"
    if differing:
        return (
            f"{len(differing)} of {len(rows)} {'differs' if len(differing) == 1 else 'differ'} from {theory} ({most})"
        )
    if not few:
        return f"{'both' if len(rows) == 2 else f'all {len(rows)}'} agree with {theory} ({most})"
    undecided = ", ".join(row.name for row in few) if len(few) <= NAMED else f"{len(few)} of them"
    number = f"{len(agreeing)} of {len(rows)} {'agrees' if len(agreeing) == 1 else 'agree'}"
    return f"{number} with {theory} ({most}), too few samples for a verdict on {undecided}"


class _Row(NamedTuple):
    """Verdict on a row.

    Attributes:
        name: name of the row.
        agrees: whether measurement and theory agree; None if there are too few samples.
        size: absolute deviation, in standard errors.
        shown: the deviation as printed; empty without an error bar.
        value: the theoretical value as printed; empty for the test of a law.
    """

    name: str
    agrees: bool | None
    size: float
    shown: str
    value: str


def _row(name: str, theory: str, result: Estimate | PValue, rows: int) -> _Row:
    from scipy import special

    if isinstance(result, PValue):
        size = -float(special.ndtri(result.value / 2))
        return _Row(name, result.agrees(rows), size, f"p = {result.value:.2g}", "")
    agrees, deviation = Comparison(name, theory, result, rows).agrees, result.deviation
    value, samples = f"{result.theory:.5g}", result.independent_samples
    if deviation is None:
        return _Row(name, agrees, 0.0, "", value)
    few = f" of {samples:.0f} samples" if samples < ROUGH else ""
    return _Row(name, agrees, abs(deviation), f"{deviation:+.1f}σ{few}".replace("-", "−"), value)
