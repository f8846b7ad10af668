"""Contact value of the pair distribution of equal hard discs: their collision rate relative to a dilute gas."""


def contact_value(packing_fraction):
    """Contact value χ = (1 - 7φ/16)/(1 - φ)² of hard discs, for a packing fraction φ or an array of them; no unit.

    Source: Henderson, Mol. Phys. 30, 971 (1975).
    """
    return (1.0 - 7.0 * packing_fraction / 16.0) / (1.0 - packing_fraction) ** 2
