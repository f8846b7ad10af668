"""Gases that never come to a stationary state, and those that come to one without a law of equilibrium."""

from idealgas.log import Log


def why_never_stationary(log: Log) -> str:
    """Why a gas never comes to a stationary state, as part of a sentence; empty if nothing is known to prevent it.

    Such a gas is driven by a moving wall, or loses energy that no wall gives back.
    """
    scene, properties = log.scene, log.scene.properties
    if properties.driven:
        return f"the gas is driven ({', '.join(scene.lacking('fixed_walls'))})"
    if not properties.lossless and properties.isolated:
        return f"the gas loses energy ({', '.join(scene.lacking('lossless'))})"
    return ""


def why_no_equilibrium(log: Log) -> str:
    """Why a gas never comes to equilibrium, as part of a sentence; empty if nothing is known to prevent it."""
    if why := why_never_stationary(log):
        return why
    scene, properties = log.scene, log.scene.properties
    if len(properties.temperatures) > 1:
        sources = "walls" if properties.bath is None else "walls and heat bath"
        return f"{sources} have {len(properties.temperatures)} temperatures"
    if not properties.lossless:
        return f"the gas loses energy ({', '.join(scene.lacking('lossless'))})"
    return ""
