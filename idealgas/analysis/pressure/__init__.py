"""Pressure from the walls and from the virial; from several logs the equation of state."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure the pressure from the walls and from the virial, and compare Z = PA/NT with 1 and with hard discs.

    Collision rates and mean free paths come from the same events. Several logs, or the folder of a sweep with the
    analysis "pressure", give the equation of state: Z against the packing fraction, and the virial coefficients in it.
    Under gravity, with a piston or walls inside, losses or heat of several temperatures there is no such Z: it is then
    the mechanical pressure of every wall, the momentum that discs give to it per time and length.
    """,
    worded=True,
    sections=(
        Section(
            "Pressure", "Z by every route with standard errors, theory as lines; without one the pressure of walls"
        ),
    ),
    several=True,
    averages=True,
    folders=True,
    checked=True,
)
