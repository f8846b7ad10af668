"""Names of the components of event columns and observables."""

from collections.abc import Mapping, Sequence

from idealgas.columns import EVENT_COLUMNS, face_names

VECTORS: dict[str, Sequence[str]] = {
    **{column.name: column.parts for column in EVENT_COLUMNS if column.parts},
    "momentum": ("momentum_x", "momentum_y"),
    "kinetic_flow": tuple(f"kinetic_flow_{part}" for part in ("xx", "xy", "yy")),
    **{name: (f"{name}_x", f"{name}_y") for name in ("kinetic_heat_flow", "collision_heat_flow")},
    "collision_flow": tuple(f"collision_flow_{part}" for part in ("xx", "xy", "yy", "yx")),
}
"""Component names that do not depend on the walls."""


def components(walls: Sequence[str]) -> Mapping[str, Sequence[str]]:
    """Component names of event columns and observables. walls: names of the walls of a log."""
    faces = {
        name: [f"{name}_{face}" for face in face_names(walls)]
        for name in ("face_normal_impulse", "face_tangential_impulse", "face_hits")
    }
    given = [f"wall_energy_{name}" for name in walls]
    lost = [f"dissipated_energy_{name}" for name in ("discs", *walls)]
    return {**VECTORS, **faces, "wall_energy": given, "dissipated_energy": lost}
