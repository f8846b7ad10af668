"""Table of the flux of gases through a slit."""

from idealgas.analysis.core.tables import Table, estimates
from idealgas.analysis.effusion.combine import Effusions


def effusion_tables(found: Effusions) -> list[Table]:
    """Table of the flux over density of each gas, length/time."""
    return [estimates("Flux over density (length/time), theory ⟨v⟩/π", found.together.items())]
