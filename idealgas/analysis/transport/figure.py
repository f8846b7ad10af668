"""Panels of the figures of transport in a gas."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from idealgas.analysis.transport.coefficients import SYMBOLS, Collective
from idealgas.analysis.transport.diffusion import Diffusion
from idealgas.analysis.transport.pair_distribution import Contact, PairDistribution
from idealgas.presentation.style import BAND, COLOURS, GREY, Panel, curve_style
from idealgas.theory import hard_discs

FAINTEST = 1e-4
"""Smallest velocity correlation that is shown."""

THIN = 0.12
"""Largest packing fraction at which the first-order theory of g(r) beyond contact is drawn."""


def draw_diffusion(correlation: Panel, displacement: Panel, diffusion: Sequence[Diffusion], free_time: float) -> None:
    """Draw the velocity correlation and the mean square displacement of each species, with theory.

    For the velocity correlation exp(-t/τ) the mean square displacement is 4D [t - τ(1 - exp(-t/τ))]: Fürth, Z. Phys. 2,
    244 (1920). The long-time tail of the correlation is drawn after five mean free times.
    """
    for k, entry in enumerate(diffusion):
        _curve(correlation, entry.lag, entry.correlation, entry.correlation_error, k, entry.species)
        lag, memory = entry.lag, entry.velocity_correlation_time
        if memory is not None and memory.theory:
            decay = np.exp(-lag / memory.theory)
            error = decay * lag / memory.theory * memory.theory_error / memory.theory
            correlation.theory(lag, decay, error, "exp(-t/τ), τ = mD/T by Enskog", curve_style(k)[0])
        if entry.tail is not None:
            late = lag > 5 * free_time
            correlation.plot(lag[late], entry.tail[late], ":", color=COLOURS[1], label="tail 1/(8πn(D + ν)t)")
        name = f"{entry.species}, measured"
        _curve(displacement, lag, entry.displacement, entry.displacement_error, k, name)
        if entry.coefficient and memory:
            d, tau = entry.coefficient.value, memory.value
            law = 4 * d * (lag - tau * (1 - np.exp(-lag / tau)))
            displacement.plot(lag, law, "--", color=GREY, label=f"4D[t - τ(1 - exp(-t/τ))], D = {d:.4g}")
    if all((entry.correlation > -3 * entry.correlation_error).all() for entry in diffusion):
        correlation.set(yscale="log", ylim=(FAINTEST, 1.5))  # no value is significantly negative
    correlation.set(xlabel="t (time)", ylabel="⟨v(0)·v(t)⟩/⟨v²⟩ (no unit)")
    displacement.set(xlabel="t (time)", ylabel="mean square displacement (length²)")


def _curve(ax: Axes, lag: np.ndarray, value: np.ndarray, error: np.ndarray, k: int, label: str) -> None:
    """Draw a curve in style number k, with a band of its standard error."""
    colour, line, _ = curve_style(k)
    ax.plot(lag, value, line, color=colour, label=label)
    draw_band(ax, lag, value, error, colour)


def draw_band(ax: Axes, x: Sequence[float] | np.ndarray, value: np.ndarray, error: np.ndarray, colour: str) -> None:
    """Draw a band of errors around a curve."""
    ax.fill_between(x, value - error, value + error, color=colour, alpha=BAND, linewidth=0)


def draw_pairs(
    ax: Axes, pairs: Sequence[PairDistribution], contacts: Sequence[Contact], packing_fraction: float
) -> None:
    """Draw the pair distribution of each pair of species, with the contact value from collision rates."""
    for k, pair in enumerate(pairs):
        colour, _, marker = curve_style(k)
        middle = (pair.edges[1:] + pair.edges[:-1]) / 2
        label = f"{pair.species} and {pair.other}"
        ax.errorbar(middle, pair.value, pair.error, fmt=marker, ms=2, color=colour, label=label)
        for contact in contacts:
            if (contact.species, contact.other) == (pair.species, pair.other):
                ax.plot(pair.contact, contact.value.value, "D", color=colour, label=f"{label}: by collisions")
                if (theory := contact.value.theory) is not None:
                    off, label = contact.value.theory_error, "theory at contact"
                    ax.errorbar(pair.contact, theory, off, fmt="+", ms=12, color=GREY, label=label)
        diameter = pair.edges[0]
        if len(pairs) == 1 and pair.contact == diameter and packing_fraction <= THIN:
            density = 4 * packing_fraction / (math.pi * diameter**2)
            curve = hard_discs.thin_pair_distribution(middle, diameter, density)
            ax.plot(middle, curve, "--", color=GREY, linewidth=0.9, label="first order in φ")
    ax.axhline(1.0, color=GREY, linewidth=0.8)
    ax.set(xlabel="r (length)", ylabel="g(r) (no unit)")


def draw_coefficients(ax: Panel, diffusion: Sequence[Diffusion], collective: Collective | None) -> None:
    """Draw D(t), η(t), λ(t) and ζ(t) with the plateau, in units of Enskog's values or else of the results."""
    whole = collective.coefficients if collective else {}
    curves = [
        (f"D, {entry.species}", entry.lag, entry.running, entry.running_error, entry.coefficient) for entry in diffusion
    ] + [
        (SYMBOLS[name], coefficient.times, coefficient.running, coefficient.running_error, coefficient.value)
        for name, coefficient in whole.items()
    ]
    values = [value for *_, value in curves if value]
    by_theory = all(value.theory for value in values)
    for k, (name, times, running, error, value) in enumerate(curves):
        unit = (by_theory and value.theory) or value.value if value else running.max()
        _curve(ax, times, running / unit, error / unit, k, name if value else f"{name}: no plateau")
        if by_theory and value:
            ax.theory(None, 1.0, value.theory_error / unit, None, curve_style(k)[0])
    plateaus = [collective.plateau] if collective else [entry.plateau for entry in diffusion]
    for first, last in filter(None, plateaus[:1]):
        ax.axvspan(first, last, color=GREY, alpha=0.12, linewidth=0, label="plateau")
    ax.axhline(1.0, color=GREY, linewidth=0.8, label="Enskog's, bands: its errors" if by_theory and values else None)
    ax.set_ylim(0.0, 1.6)
    over = "its maximum" if not values else "Enskog's" if by_theory else "its mean in the plateau"
    ax.set(xlabel="t (time)", ylabel=f"coefficient at time t over {over}")
