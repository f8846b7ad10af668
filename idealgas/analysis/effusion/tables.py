"""The table of gases that leave through a slit."""

from idealgas.analysis.core.tables import Table, estimates
from idealgas.analysis.effusion.combine import Effusions


def effusion_tables(found: Effusions) -> list[Table]:
    """The flux of each gas."""
    return [estimates("Flux over density (length/time), theory ⟨v⟩/π", found.together.items())]
