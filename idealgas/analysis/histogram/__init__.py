"""Distributions of speeds, energies, free flights and waits, beside their laws."""

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
"""What there are distributions of, and its unit."""


def _section(title: str, quantity: str) -> Section:
    caption = f"Density of {title.lower()}: measured with its standard errors, and its laws as lines"
    return Section(title, caption, {"quantity": quantity})


ANALYSIS = Analysis(
    __name__,
    help="""Measure a distribution and test it against its laws.

    Velocities count with the time spent at them; waits are those between successive events of the gas. The
    Kolmogorov-Smirnov tests take decorrelated samples.
    """,
    options=(Option("quantity", str, "What of.", default="speed", choices=tuple(QUANTITIES)),),
    sections=(
        _section("Speeds", "speed"),
        _section("Velocities along x", "vx"),
        _section("Energies", "energy"),
        _section("Free paths", "free-path"),
        _section("Free times", "free-time"),
        _section("Waits between events", "wait"),
    ),
)
