"""GIF writer that works frame by frame in bounded memory; Pillow's own writer would keep all frames until the end."""

from typing import IO

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_rgb
from PIL import GifImagePlugin, Image

from idealgas.presentation.style import COLOURS, GREY

COLOUR_MAP = "cividis"
SAME = 255
"""Palette index of pixels that have not changed since the previous frame; long runs of it compress well."""


class GifWriter:
    """Writer of a GIF whose frames have the same size and palette, with the colours of the project's figures."""

    def __init__(self, file: IO[bytes], width: int, height: int, delay: int) -> None:
        """Start a GIF. width, height: size in pixels; delay: time between frames in hundredths of a second."""
        self._file, self._delay = file, delay
        self._palette = make_palette()
        self._nearest = nearest_colours(self._palette)
        self._before = np.full((height, width), SAME, np.uint8)
        head, _ = GifImagePlugin.getheader(self._image(self._before), info={"loop": 0, "background": 0})
        for block in head:
            file.write(block)

    def write(self, frame: np.ndarray) -> None:
        """Append a frame of shape (height, width, 3 or 4) and type uint8."""
        red, green, blue = (frame[..., k].astype(np.uint16) >> 3 for k in range(3))
        now = self._nearest[red << 10 | green << 5 | blue]
        image = self._image(np.where(now == self._before, np.uint8(SAME), now))
        self._before = now
        for block in GifImagePlugin.getdata(
            image, duration=10 * self._delay, transparency=SAME, disposal=1, include_color_table=False
        ):
            self._file.write(block)

    def close(self) -> None:
        """Write the end of the file, after the last frame."""
        self._file.write(b";")

    def _image(self, indices: np.ndarray) -> Image.Image:
        image = Image.fromarray(indices)
        image.putpalette(self._palette.tobytes())
        return image


def make_palette() -> np.ndarray:
    """Return the palette (256, 3) uint8: greys, the colour map and the project's colours.

    Lighter shades are included for anti-aliased edges.
    """
    greys = np.linspace(0, 1, 40)[:, None] * np.ones(3)
    shades = colormaps[COLOUR_MAP](np.linspace(0, 1, 32))[:, :3]
    kinds = np.array([to_rgb(colour) for colour in (*COLOURS, GREY)])
    fading = [
        1 - share * (1 - base)
        for base, shares in ((shades, (1, 0.8, 0.6, 0.4, 0.2)), (kinds, (1, 0.75, 0.5, 0.25)))
        for share in shares
    ]
    colours = np.concatenate([greys, *fading])
    palette = np.zeros((256, 3), np.uint8)
    palette[: len(colours)] = np.round(255 * colours)
    assert len(colours) <= SAME
    return palette


def nearest_colours(palette: np.ndarray) -> np.ndarray:
    """Return the index (32768,) uint8 of the nearest palette colour for each colour with 5 bits per channel."""
    levels = np.arange(32) * 8 + 4.0
    colours = np.stack(np.meshgrid(levels, levels, levels, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    used = palette[:SAME].astype(float)
    return np.concatenate([((part - used) ** 2).sum(axis=2).argmin(axis=1) for part in np.split(colours, 64)]).astype(
        np.uint8
    )
