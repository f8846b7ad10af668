"""Geometry of contacts between discs and walls: the normal at each hit and its curvature."""

import itertools

import numpy as np

from idealgas.columns import FIRST_SEGMENT, OUTWARD, Kind
from idealgas.log import Flights, Log
from idealgas.scene.walls import number_walls


class WallNormals:
    """Unit normals of W walls at the positions of hits.

    Attributes:
        first: (W, 2), unit normal of the first face of each wall; the normal of a side of the box points into the box.
            For an arc, this is the normal of its chord.
        has_arcs: whether any wall is an arc, so that normals depend on the positions of the discs.
    """

    def __init__(self, log: Log) -> None:
        """Set up the walls of a log."""
        walls = number_walls(log.scene)
        along = np.array([np.subtract(wall.end, wall.start) for wall in walls[FIRST_SEGMENT:]]).reshape(-1, 2)
        along[~along.any(axis=1), 0] = 1.0  # fixed discs and circles
        along /= np.hypot(*along.T)[:, None]
        self.first = np.concatenate((-np.array(OUTWARD), np.column_stack((-along[:, 1], along[:, 0]))))
        self._turn = np.array([wall.arc.turn if wall.arc else 0.0 for wall in walls])
        self.has_arcs = bool(self._turn.any())
        self._ends = np.array([(wall.start, wall.end) for wall in walls])
        self._centres = np.array([np.add(wall.start, wall.arc[:2]) if wall.arc else wall.start for wall in walls])
        self._size = np.array([wall.arc.radius if wall.arc else wall.radius for wall in walls])
        self._radius = log.discs.radius
        shifts = ((-length, 0.0, length) if on else (0.0,) for length, on in zip(log.box, log.periodic, strict=True))
        self._images = np.array(list(itertools.product(*shifts)))

    def at(self, flights: Flights, hits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the unit normals (H, 2) and the curvatures (H,) of walls where flights end by hitting them.

        A disc that touches an arc, a fixed disc or the end of a wall is at a fixed distance from a centre, and the
        normal is along the line from the centre to the disc: away from the centre for fixed discs, ends and arcs that
        turn right, and towards the centre for arcs that turn left. The curvature is the derivative of the normal with
        respect to tangential displacements of the disc, 1/length; it is 0 at flat walls.

        Args:
            flights: flights with the columns `disc`, `kind`, `partner` and, for all but flat walls, `end_position`.
            hits: (H,), indices of flights that end with a wall hit.
        """
        wall, kind = -1 - flights.partner[hits], flights.kind[hits]
        normals, curvature = self.first[wall], np.zeros(len(hits))
        at_end = kind == Kind.WALL_END
        curved = np.flatnonzero(at_end | (self._size[wall] > 0))
        if curved.size:
            assert flights.end_position is not None
            wall, at_end, rows = wall[curved], at_end[curved], hits[curved]
            centres = np.where(at_end[:, None, None], self._ends[wall], self._centres[wall, None])
            away = (flights.end_position[rows, None] - centres)[:, :, None] + self._images
            away = away.reshape(len(rows), -1, 2)
            size = np.where(at_end, 0.0, self._size[wall])[:, None]
            gaps = np.abs(np.hypot(*away.transpose(2, 0, 1)) - size) - self._radius[flights.disc[rows], None]
            away = away[
                np.arange(len(rows)), np.abs(gaps).argmin(axis=1)
            ]  # the end and the image that the disc touches
            sign = np.where(at_end | (self._turn[wall] == 0), 1.0, -self._turn[wall])
            curvature[curved] = sign / np.hypot(*away.T)
            normals[curved] = away * curvature[curved, None]
        return normals, curvature
