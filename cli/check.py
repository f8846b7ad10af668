"""Command `idealgas check`: report the errors in a scene, and estimate the size of its run."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from ._options import json_option, scene_argument
from ._tables import print_tables, shown
from ._terminal import data, echo

if TYPE_CHECKING:
    from idealgas.presentation.tables import Number, Table
    from idealgas.scene import RestingDisc, Scene
    from idealgas.scene.lattice import TriangularLattice
    from idealgas.theory.forecast import Forecast

LEAST_STRAIN = 1e-9
"""Lattice strains smaller than this are attributed to rounding of the numbers in a scene."""

MANY_HITS = 100.0
"""Largest number of hits of a resting disc per mean free time of the gas without a warning from `check`."""

ROUGH_REST = (
    "Rough collisions dissipate kinetic energy; discs that a force presses together then collide ever more often, "
    "and no contact duration limits their collision rate. The run may end in an inelastic collapse before `run.until`."
)
"""Warning for rough discs under a constant force."""


@click.command(epilog="Example: idealgas check gas.toml --set species.count=500")
@scene_argument
@json_option
def check(path: str, overrides: tuple[str, ...], as_json: bool) -> None:
    """Check a scene, and show it in full with the rates and the size of the run predicted by kinetic theory."""
    from idealgas.scene import load_scene
    from idealgas.toml.dump import dump_document

    scene = load_scene(path, overrides)
    from idealgas.initial.build import make_gas
    from idealgas.run.simulate import threads_of
    from idealgas.theory.forecast import forecast

    gas = make_gas(scene)
    expected, threads, lattice = forecast(scene, gas), threads_of(scene, gas), scene.lattice
    if as_json:
        tables = scene.model_dump(mode="json", by_alias=True, exclude_none=True)
        effects = {"effects": scene.effects, "compiled_out": _absent(scene)}
        sharing = {"threads": threads.number, "threads_reason": threads.reason}
        shape = None if lattice is None else {"strain": lattice.strain, "unstrained": lattice.unstrained}
        notes = {"lattice": shape, "warning": ROUGH_REST if scene.collapse_risk else None}
        data(json.dumps({"scene": tables, **effects, **sharing, **notes, **asdict(expected)}, indent=2))
        return
    echo(dump_document(scene))
    print_tables([_species_table(expected), _walls_table(scene), _gas_table(expected, scene.run.until)])
    if lattice is not None:
        echo(_lattice_line(lattice))
    if expected.rough:
        echo(f"about: {expected.rough}")
    for sentence in expected.caveats:
        echo(f"caveat: {sentence}")
    if expected.beyond:
        what = "not known" if expected.temperature is None else "rates not known"
        echo(f"{what}: the theory of a uniform gas does not cover {', '.join(expected.beyond)}")
    if expected.rest:
        echo("\n".join(_rest_lines(expected.rest, expected.number)))
    if scene.collapse_risk:
        echo(f"warning: {ROUGH_REST}")
    echo(f"threads: {threads.number} ({threads.reason})")
    echo(f"effects: {', '.join(scene.effects) or 'none (elastic discs in a reflecting box)'}")
    echo(f"compiled out: {', '.join(_absent(scene)) or 'none'}")


def _lattice_line(lattice: "TriangularLattice") -> str:
    """Return a line about the initial lattice: its rows, its strain, and a box size for which there is no strain."""
    shape = f"lattice: {lattice.rows} rows along {'xy'[lattice.axis]} of {lattice.columns} discs"
    if abs(lattice.strain) < LEAST_STRAIN:
        return f"{shape}, without strain"
    return f"{shape}, strain {lattice.strain:+.3g} across them; without strain: box.size = {list(lattice.unstrained)}"


def _rest_lines(resting: "RestingDisc", number: int) -> Iterator[str]:
    """Yield lines about how discs at rest keep bouncing, with a warning if their hits dominate the run."""
    least, most = resting.hits
    if most is None or resting.per_free_time is None:
        yield "warning: With a restitution of 0, a resting disc collides infinitely often at one instant."
        return
    yield (
        f"at rest: a disc keeps bouncing, with {least:.4g} to {most:.4g} hits per unit time, up to a height of "
        f"{resting.height:.3g} and an energy of {resting.energy:.3g} times its mass"
    )
    if resting.per_free_time > MANY_HITS:
        yield (
            f"warning: A disc at rest has up to {resting.per_free_time:.3g} times as many events as a disc of the "
            f"initial gas, and all {number} discs together have {number * most:.3g} per unit time; a longer contact "
            "duration reduces them."
        )


def _absent(scene: "Scene") -> tuple[str, ...]:
    from idealgas.effects import EFFECT_NAMES

    return tuple(name for name in EFFECT_NAMES if name not in scene.effects)


def _number(value: float | None, digits: str = ".5g", rough: str = "") -> "Number":
    return shown("not known" if value is None else f"{'about ' * bool(rough)}{value:{digits}}")


def _species_table(expected: "Forecast") -> "Table":
    from idealgas.presentation.tables import Cell, Number, Table

    spread = any(s.polydispersity for s in expected.species)
    rows: list[Sequence[Cell]] = [
        [
            s.name,
            Number(s.number, "d"),
            _number(s.radius),
            *([_number(s.polydispersity)] if spread else []),
            *map(_number, (s.mass, s.packing_fraction, s.temperature)),
            _number(s.collision_rate, rough=expected.rough),
        ]
        for s in expected.species
    ]
    radius = ("mean radius", "s.d./mean") if spread else ("radius",)
    heads = ("species", "N", *radius, "mass", "φ", "temperature", "collisions per disc and time")
    return Table("Discs at the start", heads, rows)


def _walls_table(scene: "Scene") -> "Table":
    from idealgas.presentation.tables import Cell, Table
    from idealgas.scene.walls import number_walls

    rows: list[Sequence[Cell]] = [
        (str(k), wall.name, *(shown(f"({x:.6g}, {y:.6g})") for x, y in (wall.start, wall.end)), wall.action)
        for k, wall in enumerate(number_walls(scene))
    ]
    return Table("Walls", ("wall", "name", "from", "to", "action"), rows)


def _gas_table(expected: "Forecast", until: float | None) -> "Table":
    from rich.filesize import decimal

    from idealgas.presentation.tables import Number, Table

    rough, ends = expected.rough, "" if expected.duration == until else expected.rough
    size = "not known" if expected.bytes is None else f"{'about ' * bool(rough)}{decimal(int(expected.bytes))}"
    rows = [
        ("discs N", Number(expected.number, "d")),
        ("packing fraction φ", _number(expected.packing_fraction)),
        ("temperature T", _number(expected.temperature, rough=rough if expected.collision_rate is None else "")),
        ("collisions per disc and time Γ", _number(expected.collision_rate, rough=rough)),
        ("pair collisions per time", _number(expected.pair_collision_rate, rough=rough)),
        ("wall hits per time", _number(expected.wall_hit_rate, rough=rough)),
        *(
            [("thermostat collisions per time", _number(expected.thermostat_collision_rate))]
            if expected.thermostat_collision_rate
            else []
        ),
        ("end of the run, time", _number(expected.duration, rough=ends)),
        ("events", _number(expected.events, ",.0f", rough)),
        ("rows in the log", _number(expected.rows, ",.0f", rough)),
        ("size of the log", shown(size)),
    ]
    return Table("Expected in equilibrium", ("", ""), rows)
