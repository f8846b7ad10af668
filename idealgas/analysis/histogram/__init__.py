"""Distributions of speeds, energies, free flights and waiting times, compared with theory."""

from idealgas.analysis.core.declaration import Analysis, Option, Section

QUANTITIES = {
    "speed": "length/time",
    "vx": "length/time",
    "vy": "length/time",
    "energy": "energy",
    "free-path": "length",
    "free-time": "time",
    "wait": "time",
}
"""Quantities whose distribution can be measured, with their units."""


def _section(title: str, quantity: str) -> Section:
    caption = f"Density of {title.lower()}: measured with its standard errors, and its laws as lines"
    return Section(title, caption, {"quantity": quantity})


ANALYSIS = Analysis(
    __name__,
    help="""Measure the distribution of a quantity and test it against theory.

    Velocities and energies are weighted with the time that discs spend at them. A wait is the time between successive
    events of the whole gas. The Kolmogorov-Smirnov tests use decorrelated samples.
    """,
    in_text=True,
    options=(
        Option("quantity", str, "Quantity whose distribution is measured.", default="speed", choices=tuple(QUANTITIES)),
    ),
    sections=(
        _section("Speeds", "speed"),
        _section("Velocities along x", "vx"),
        _section("Energies", "energy"),
        _section("Free paths", "free-path"),
        _section("Free times", "free-time"),
        _section("Waits between events", "wait"),
    ),
)
