"""Values rounded by their standard errors."""

import math


def with_last_digits(value: float, error: float) -> str:
    """Return a value with its standard error in units of the last digit, such as "1.1099(3)" for 1.1099 ± 0.0003.

    The error has one digit, or two if the first is 1; a value without an error has six digits.
    """
    if not (math.isfinite(value) and math.isfinite(error) and error > 0):
        return f"{value:.6g}"
    power = math.floor(math.log10(max(abs(value), error)))
    if power not in range(-4, 6):
        return f"{with_last_digits(value * 10.0**-power, error * 10.0**-power)}e{power}"
    one_digit = f"{error:.0e}"
    last = int(one_digit[2:]) - (one_digit[0] == "1")  # power of ten of the last digit
    digits = max(-last, 0)
    rounded = round(error, -last)
    shown = f"{rounded:.{digits}f}" if rounded >= 1 else f"{rounded * 10**digits:.0f}"
    return f"{round(value, -last):.{digits}f}({shown})"
