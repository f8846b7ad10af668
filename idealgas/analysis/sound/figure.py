"""Picture of sound."""

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis.core.style import COLOURS, GREY, panels
from idealgas.analysis.sound.measure import Sound


def sound_figure(result: Sound) -> Figure:
    """Picture of the correlation of each wave in time, with its fit and, dashed, hydrodynamics by theory."""
    figure, axes = panels(len(result.waves))
    for ax, wave in zip(axes, result.waves, strict=True):
        every = max(len(wave.lag) // 60, 1)
        lag, found, error = (values[::every] for values in (wave.lag, wave.correlation, wave.error))
        ax.errorbar(lag, found, error, fmt="o", ms=3, color=COLOURS[0], capsize=2, label="measured")
        fine = np.linspace(0, wave.lag[-1], 500)
        ax.plot(fine, wave.fitted.at(fine), color=COLOURS[1], linewidth=1.2, label="fit: heat and sound")
        if wave.theory is not None:
            ax.plot(fine, wave.theory.at(fine), "--", color=GREY, label="hydrodynamics by theory")
        ax.axhline(0, color="#bbbbbb", linewidth=0.8, zorder=1)
        ax.set_xlabel("t (time)")
        wave_in_words = f"waves along {wave.axes}, {wave.wavelength:.4g} long: c = {wave.speed.value:.4g}"
        ax.set_ylabel(f"⟨ρ(t) ρ*(0)⟩/N (no unit), {wave_in_words}")
        ax.legend()
    return figure
