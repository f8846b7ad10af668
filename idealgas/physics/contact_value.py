"""Contact value of the pair distribution of equal hard discs: how much oftener they touch than in a dilute gas."""


def contact_value(packing_fraction):
    """χ = (1 - 7φ/16)/(1 - φ)², for a packing fraction or an array of them: Henderson, Mol. Phys. 30, 971 (1975)."""
    return (1.0 - 7.0 * packing_fraction / 16.0) / (1.0 - packing_fraction) ** 2
