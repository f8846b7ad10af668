"""Tables of sound."""

from dataclasses import replace

from idealgas.analysis.core.tables import Table, describe, estimates
from idealgas.analysis.sound.measure import Sound


def sound_tables(result: Sound) -> list[Table]:
    """Table of each wave: speed and damping of sound, thermal diffusivity and adiabatic exponent."""
    tables = [
        estimates(
            f"Waves along {wave.axes}, {wave.wavelength:.4g} long",
            [
                ("speed of sound (length/time)", wave.speed),
                ("damping of sound Γ (length²/time)", wave.damping),
                ("thermal diffusivity (length²/time)", wave.spreading),
                ("adiabatic exponent γ (no unit)", wave.exponent),
            ],
        )
        for wave in result.waves
    ]
    notes = (
        f"{describe(result.window)}, {result.frames} instants",
        "theory: speed by the virial series; damping and diffusivity by Enskog's viscosities and thermal conductivity",
    )
    return [replace(tables[0], notes=notes), *tables[1:]]
