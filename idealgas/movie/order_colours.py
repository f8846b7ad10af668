"""Colours of discs by local order ψ₆: the hue shows the angle of ψ₆, and discs without order are grey."""

import numpy as np
from matplotlib import colormaps

HUES = "hsv"
"""A cyclic colour map, as required for angles."""

GREY = 0.72
"""Brightness of discs without order."""


def order_colours(order: np.ndarray) -> np.ndarray:
    """Return the colours (N, 4) of discs with complex local order (N,): grey at |ψ₆| = 0, fully saturated at 1."""
    hue = colormaps[HUES](np.angle(order) / (2 * np.pi) % 1)
    share = np.minimum(np.abs(order), 1)[:, None]
    colours = share * hue + (1 - share) * GREY
    colours[:, 3] = 1
    return colours
