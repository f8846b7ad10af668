"""Colours of discs by the order ψ₆ of their neighbours: the hue is its angle, and discs without order are grey."""

import numpy as np
from matplotlib import colormaps

HUES = "hsv"
"""A colour map that ends where it begins, as angles do."""

GREY = 0.72
"""Brightness of discs without order."""


def order_colours(order: np.ndarray) -> np.ndarray:
    """Colours (N, 4) of discs of a complex local order (N,): grey at size 0, the full hue of its angle at size 1."""
    hue = colormaps[HUES](np.angle(order) / (2 * np.pi) % 1)
    share = np.minimum(np.abs(order), 1)[:, None]
    colours = share * hue + (1 - share) * GREY
    colours[:, 3] = 1
    return colours
