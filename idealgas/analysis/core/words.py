"""Numbers of results in sentences."""

import math

from idealgas.analysis.core.statistics import Estimate


def format_estimate(found: Estimate) -> str:
    """An estimate with as many digits as its standard error allows, and its theory, such as "1.02 ± 0.03, theory 1"."""
    error = found.standard_error
    known = math.isfinite(error) and error > 0
    digits = max(1 - math.floor(math.log10(error)), 0) if known else None
    text = f"{found.value:.6g}" if digits is None else f"{found.value:.{digits}f} ± {error:.{digits}f}"
    return text if found.theory is None else f"{text}, theory {found.theory:.6g}"
