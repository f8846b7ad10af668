"""Checks of measurement against theory, with one chance of a false alarm whatever the number of samples."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any

from idealgas.analysis.core.fields import Key, as_dict, reported
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.tables import Number, Table
from idealgas.errors import UserError

FALSE_ALARM = math.erfc(4.0 / math.sqrt(2.0))
"""Chance that a row of a correct gas fails a check, 6.3e-5: that of four standard errors of a normal distribution."""

POWER = 0.95
"""Chance that a check finds the smallest deviation that it reports as detectable."""


@dataclass(frozen=True)
class Comparison:
    """One row of a check: a measured quantity with its theory, all in the unit of the quantity.

    name: of the quantity. source: which theory. estimate: measurement and theory.
    """

    name: str
    source: str
    estimate: Estimate

    @property
    @reported
    def difference(self) -> float:
        """Measurement less theory."""
        assert self.estimate.theory is not None
        return self.estimate.value - self.estimate.theory

    @property
    @reported
    def allowed(self) -> float:
        """Largest difference without an alarm, which a correct gas exceeds with a probability of FALSE_ALARM.

        The root of the sum of two squares, by Student's t for the standard error and normal for the error of theory:
        exact for either alone, and exceeded less often in between.
        """
        from scipy import special

        return math.hypot(self._by_student, special.ndtri(1 - FALSE_ALARM / 2) * self.estimate.theory_error)

    @property
    @reported
    def detectable(self) -> float:
        """Smallest error of the measurement that the check finds, with a probability of POWER.

        By the normal approximation of noncentral t: Johnson & Welch, Biometrika 31, 362 (1940).
        """
        from scipy import special

        found = self.estimate
        of_allowed = self._by_student / math.sqrt(2 * self._freedom)
        spread = math.hypot(found.standard_error, found.theory_error, of_allowed)
        return self.allowed + float(special.ndtri(POWER)) * spread

    @property
    def _freedom(self) -> float:
        return max(self.estimate.independent_samples - 1, 1.0)

    @property
    def _by_student(self) -> float:
        from scipy import special

        return float(special.stdtrit(self._freedom, 1 - FALSE_ALARM / 2)) * self.estimate.standard_error


@dataclass(frozen=True)
class CheckResult:
    """Result of a check of measurement against theory.

    compared: what was compared with what. why_not: why theory has no value, as part of a sentence.
    """

    compared: tuple[Comparison, ...] = ()
    why_not: Annotated[str | None, Key("no_theory")] = None

    @property
    @reported
    def agrees(self) -> bool | None:
        """Whether measurement and theory agree in every row; None if theory has no value."""
        return all(abs(row.difference) <= row.allowed for row in self.compared) if self.compared else None

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return as_dict(self)

    def tables(self) -> list[Table]:
        """Table of what was compared with what; none without a theory."""
        heads = ("", "compared with", "difference", "allowed ±", "detectable")
        rows = [
            (
                row.name,
                f"{row.estimate.theory:.6g}: {row.source}",
                Number(row.difference, "+.2g"),
                Number(row.allowed, ".2g"),
                Number(row.detectable, ".2g"),
            )
            for row in self.compared
        ]
        return [Table("Check: difference between measurement and theory", heads, rows)] if rows else []

    def __str__(self) -> str:
        """Sentences for people."""
        if self.agrees is None:
            return f"No theory here: {self.why_not}."
        failed = [row.name for row in self.compared if not abs(row.difference) <= row.allowed]
        result = f"do not agree in {'; '.join(failed)}" if failed else "agree"
        return (
            f"Measurement and theory {result}. In each row a correct gas exceeds what is allowed with a probability of "
            f"{FALSE_ALARM:.1g}, and an error of the detectable size is found with {POWER:.0%}."
        )


def check_theory(found: Iterable[tuple[str, str | None, Estimate]], why_not: str | None = None) -> CheckResult:
    """Check that every estimate with a theory agrees with it.

    Args:
        found: estimates, each with its name and that of its theory.
        why_not: why theory has no value, for the case that no estimate has one.

    Raises:
        UserError: if an estimate with a theory has no error bar.
    """
    compared = tuple(Comparison(name, source or "theory", one) for name, source, one in found if one.theory is not None)
    if any(one.estimate.deviation is None or not math.isfinite(one.estimate.deviation) for one in compared):
        raise UserError("nothing to check: too few events for an error bar")
    return CheckResult(compared, None if compared else why_not)


def agreement(found: Iterable[tuple[str, Estimate]], theory: str = "theory", why_not: str | None = None) -> str:
    """Whether estimates agree with theory, by the rule of checks, as the predicate of a sentence on them.

    Args:
        found: estimates by name; of several the one that deviates most is named.
        theory: name of the theory.
        why_not: why theory has no value, as part of a sentence.
    """
    known = [Comparison(name, theory, one) for name, one in found if one.theory is not None]
    if not known:
        return f"no theory here: {why_not}" if why_not else "no theory here"
    rows = [row for row in known if row.estimate.deviation is not None]
    if not rows:
        return f"{theory} has {known[0].estimate.theory:.6g}, but there is no error bar"
    failed = [row for row in rows if not abs(row.difference) <= row.allowed]
    worst = max(failed or rows, key=lambda row: abs(row.estimate.deviation or 0.0))
    sigma = f"{worst.estimate.deviation:+.1f}σ".replace("-", "−")
    if len(rows) == 1:
        value = f"{worst.estimate.theory:.5g}, {sigma}"
        return f"differs from {theory} ({value})" if failed else f"agrees with {theory} ({value})"
    most = f"largest deviation {sigma}, {worst.name}"
    if failed:
        return f"{len(failed)} of {len(rows)} differ from {theory} ({most})"
    return f"{'both' if len(rows) == 2 else f'all {len(rows)}'} agree with {theory} ({most})"
