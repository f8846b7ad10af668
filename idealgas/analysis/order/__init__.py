"""Measure the order of the discs: ψ₆ of neighbours, its correlation g₆(r) and the structure factor S(k).

ψ₆ tells how well the neighbours of a disc stand at the corners of a hexagon; its mean over all discs is 1 in a
crystal and of the order of 1/√N in a fluid. S(k), in a periodic box only, tells how well the discs stand in rows;
theory knows its limit at small k, the compressibility of the fluid. A run without events is measured at its
checkpoints.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Section
from idealgas.analysis.order.measure import Order, order
from idealgas.analysis.order.tables import order_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class OrderAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `order`."""

    position = 80
    results = (Order,)
    sections = (
        Section(
            "Order",
            "Hexagonal order against time and its correlation against distance; in a periodic box the structure factor",
        ),
    )
    reads = "frames"

    measure = staticmethod(order)
    tables = staticmethod(order_tables)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.order.figure import order_figure

        return order_figure(result)
