"""Histograms in characters, for terminals."""

from collections.abc import Sequence

WIDTH = 50


def bars(lows: Sequence[float], density: Sequence[float], law: Sequence[float] | None) -> str:
    """A line for each bin: its lower edge, a bar as long as its density, and a mark at the density of a law, if any.

    lows: lower edges of the bins. density: of each bin, 1/unit. law: the same by a law.
    """
    highest = max(*density, *(law or ())) or 1.0
    names = _aligned([f"{low:.3g}" for low in lows])
    widest = max(map(len, names))
    lines = []
    for k, name in enumerate(names):
        bar = list(("█" * round(WIDTH * density[k] / highest)).ljust(WIDTH + 1))
        if law is not None:
            bar[round(WIDTH * law[k] / highest)] = "│"
        lines.append(f"{name:>{widest}} {''.join(bar).rstrip()}")
    return "\n".join(lines)


def _aligned(numbers: list[str]) -> list[str]:
    """Numbers with as many decimals as the one that has most, unless some have a power of ten."""
    decimals = max(len(number.partition(".")[2]) for number in numbers)
    return numbers if any("e" in number for number in numbers) else [f"{float(one):.{decimals}f}" for one in numbers]
