"""Every shipped scene shows what its description says: a command prints each claim, true within its errors.

`CLAIMS` has a line for each claim: the scene, its words in the description, the command that prints the number, and
what has to hold. Estimates are within 4 standard errors; their errors are bounded too, so that the claim can fail.
"""

import csv
import io
import json
import re
import tomllib
from collections import defaultdict
from collections.abc import Callable
from fnmatch import fnmatchcase
from typing import NamedTuple

import pytest
from helpers.support import ROOT, called, output_of

from idealgas import open_log
from idealgas.analysis import registry
from idealgas.scene import load_scene

SCENES = {path.stem: path for path in sorted(ROOT.glob("configs/*.toml"))}
SIGMAS = 4.0
QUICK = {"bounce", "corner", "three-discs", "wedge"}
"""Scenes of some discs, whose runs take a second."""


class Output:
    """What a command prints: its text, and its numbers by the names of quantities."""

    def __init__(self, path: str, command: str) -> None:
        self.path, self.words = path, command.split()

    @property
    def text(self) -> str:
        return called(self.words[0], self.path, *self.words[1:]).stdout

    def rows(self, quantity: str) -> list[dict[str, float]]:
        """Rows of the numbers whose names match, in order."""
        printed = called(self.words[0], self.path, *self.words[1:], "--csv").stdout
        lines = csv.DictReader(io.StringIO(printed))
        actual = [row for row in lines if fnmatchcase(row["quantity"], quantity) and row["value"]]
        assert actual, f"no {quantity} in `idealgas {' '.join(self.words)}`"
        numbers = ("value", "standard_error", "theory", "theory_error", "deviation")
        print(self.words, *actual, sep="\n")
        return [{name: float(row[name]) for name in numbers if row[name]} for row in actual]

    def values(self, quantity: str) -> list[float]:
        """Their values."""
        return [row["value"] for row in self.rows(quantity)]


Holds = Callable[[Output], bool]


def agrees(quantity: str, resolution: float) -> Holds:
    """All such estimates agree with theory, and their standard errors are small beside it."""
    return lambda output: all(
        row["standard_error"] <= resolution * abs(row["theory"]) and abs(row["deviation"]) <= SIGMAS
        for row in output.rows(quantity)
    )


def near(quantity: str, expected: float, resolution: float, own: float = 0.0) -> Holds:
    """All such estimates are that number within their errors, and `own`, what the description leaves out."""
    return lambda output: all(
        error <= resolution and abs(row["value"] - expected) <= SIGMAS * error + own
        for row in output.rows(quantity)
        for error in [row["standard_error"]]
    )


def between(quantity: str, low: float, high: float, entry: int = -1) -> Holds:
    """A number, of a series by default the last one, is between two others."""
    return lambda output: low <= output.values(quantity)[entry] <= high


def constant(quantity: str, relative: float = 1e-12) -> Holds:
    """A series does not change but for rounding."""
    return series(quantity, lambda values: max(values) - min(values) <= relative * max(map(abs, values)))


def prints(pattern: str) -> Holds:
    """The text of the command matches."""
    return lambda output: re.search(pattern, output.text, re.MULTILINE) is not None


def series(quantity: str, check: Callable[[list[float]], bool]) -> Holds:
    """A property of the whole series."""
    return lambda output: check(output.values(quantity))


def event(time: float, disc: int, x: float, y: float) -> Holds:
    """The event of a disc at a time has this place, to the last digit."""
    place = {"time": time, "disc": disc, "x": x, "y": y}
    return lambda output: any(place.items() <= json.loads(line).items() for line in output.text.splitlines())


def rows_of(output: Output) -> list[dict[str, float]]:
    """Rows of `idealgas events`."""
    return [json.loads(line) for line in output.text.splitlines()]


def velocities(number: int) -> Holds:
    """So many velocities occur, up to rounding."""
    return lambda output: len({(round(row["vx"], 9), round(row["vy"], 9)) for row in rows_of(output)}) == number


def passes(check: Callable[[dict[int, list[float]], set[int]], bool]) -> Holds:
    """Distances at which the path of each disc passes (5, 5), after each of its hits, and the discs that hit wall 5."""

    def holds(output: Output) -> bool:
        distances, meet = defaultdict(list), set()
        for row in rows_of(output):
            distances[row["disc"]].append(abs((row["x"] - 5) * row["vy"] - (row["y"] - 5) * row["vx"]))
            meet |= {row["disc"]} if row["partner"] == -6 else set()
        return check(distances, meet)

    return holds


class Claim(NamedTuple):
    """A claim. words: of the description. command: without the path of the log. holds: what its output has to be."""

    scene: str
    words: str
    command: str
    holds: Holds


T = "evolution.temperature"
BALANCE = between("evolution.end.balance", -1e-12, 1e-12)

CLAIMS = [
    Claim("adiabatic-piston", "until the pressures are equal", "evolution --from 50", agrees("evolution.rest", 0.2)),
    Claim("adiabatic-piston", "The temperatures are not equal yet", "evolution --from 50",
          between("evolution.chambers.left", 2.0, 3.0, 0)),
    Claim("adiabatic-piston", "until both gases have the same temperature", "evolution --from 50",
          series("evolution.chambers.left", lambda t: t[-1] < 1.75 < 2 < t[0])),
    Claim("adiabatic-piston", "`--from 50`, which starts from equal pressures, it compares them", "evolution --from 50",
          prints("law, left")),
    Claim("annulus", "its distance p from the centre of the circle is the same after every reflection", "events",
          passes(lambda p, meet: all(max(p[k]) - min(p[k]) < 1e-12 for k in p.keys() - meet))),
    Claim("annulus", "more than p = 2, the largest distance of a point of the inner circle, never meets", "events",
          passes(lambda p, meet: max(max(p[k]) for k in meet) <= 2 + 1e-12)),
    Claim("annulus", "Almost all other paths meet it sooner or later", "events",
          passes(lambda p, meet: sum(max(p[k]) < 2 for k in p.keys() - meet) < 0.02 * len(p))),
    Claim("annulus", "divided by the area between the circles, 0.4171", "events",
          passes(lambda p, meet: abs(sum(max(d) > 2 for d in p.values()) / 2000 - 0.4171) < SIGMAS * 0.011)),
    Claim("annulus", "divided by the area between the circles, 0.4171", "section --walls inner",
          near("section.never", 0.4171, 0.012, 0.012)),
    Claim("annulus", "the share of the discs that have never met the inner circle", "section --walls inner",
          near("section.never", 0.4171, 0.012, 0.01)),
    Claim("annulus", "π A/P = 1.5 π = 4.712", "billiard", near("billiard.path", 4.7124, 0.01, SIGMAS * 0.03)),
    Claim("atmosphere", "exp(-m g y/T), here by a factor e every 5", "profile",
          series("profile.species.air.density.[0-3]", lambda n: 1.5 < n[0] / n[1] < 2.1)),
    Claim("atmosphere", "the temperature is the same at all heights", "profile",
          agrees("profile.species.air.temperature.[0-5]", 0.05)),
    Claim("baffle", "every chamber holds a quarter of them", "profile --bins 4",
          near("profile.species.gas.density.*", 2.0, 0.25, 0.05)),
    Claim("baffle", "at the initial temperature", "evolution", constant(T)),
    Claim("bounce", "20     floor at (7, 0.5)", "events", event(20.0, 0, 7.0, 0.5)),
    Claim("bounce", "15     right side at (9.5, 8)", "events", event(15.0, 0, 9.5, 8.0)),
    Claim("brownian", "Enskog's friction", "transport", agrees("transport.collision_rates.grain_gas.rate", 0.05)),
    Claim("brownian", "it diffuses with D = T/Mγ", "transport", agrees("transport.diffusion.grain.coefficient", 0.2)),
    Claim("clustering", "does not stay uniform", "cooling", between("cooling.last_scatter", 4.0, 100.0)),
    Claim("clustering", "First they move together in vortices", "cooling", between("cooling.last_flow", 4.0, 100.0)),
    Claim("clustering", "it cools more slowly than Haff's law", "evolution", between(T, 5 * 3.3e-5, 1e-3)),
    Claim("compression", "so the temperature doubles", "evolution", between(T, 1.96, 2.08)),
    Claim("compression", "equals the energy gained by the gas, to rounding", "evolution", BALANCE),
    Claim("conduction", "right side takes the heat that the left side gives", "profile",
          series("profile.heat.*", lambda q: abs(q[0] + q[1]) < 0.4 < 1.4 < q[0])),
    Claim("conduction", "with a jump at each side", "profile",
          series("profile.species.gas.temperature.*", lambda t: t[0] < 1.97 and t[-1] > 1.03)),
    Claim("cooling", "A collision takes (1 - e²) T on average", "cooling", agrees("cooling.loss", 0.02)),
    Claim("cooling", "τ = 13.7 here", "cooling", near("cooling.haff", 13.7, 0.3)),
    Claim("cooling", "small enough for the gas to stay uniform", "cooling", between("cooling.last_scatter", 0.4, 1.2)),
    Claim("corner", "2 collisions, 6 wall hits", "info", prints(r"disc collisions: 2\b")),
    Claim("corner", "2.25   disc 4 turns at the right side", "events", event(2.25, 4, 7.5, 1.0)),
    Claim("crystal", "|Ψ₆| stays near 1", "order", between("order.whole", 0.9, 1.0)),
    Claim("crystal", "the cages that their six neighbours form", "order", near("order.hexagons", 1.0, 0.01, 0.001)),
    Claim("crystal", "S(k) has sharp peaks", "order", between("order.structure.positional_order_squared", 0.7, 1.0)),
    Claim("crystal", "the pressure is close to that of free-volume theory", "pressure",
          near("pressure.routes.pairs_virial.compressibility_factor", 16.45, 0.05, 0.8)),
    Claim("demon", "almost all discs are on the right", "evolution", between("evolution.beyond.gas", 0.95, 1.0)),
    Claim("demon", "at the initial temperature", "evolution", constant(T)),
    Claim("demon", "the entropy of the gas falls by N ln 2", "entropy",
          between("entropy.species.gas.positions", -0.69315, -0.55)),
    Claim("dense", "four times as hard as an ideal gas would", "pressure",
          near("pressure.routes.pairs_virial.compressibility_factor", 4.0, 0.02, 0.2)),
    Claim("dilute", "1 + 2φ = 1.02", "pressure",
          near("pressure.routes.pairs_virial.compressibility_factor", 1.02, 0.001, 0.001)),
    Claim("dilute", "about 1, which is fifty-five radii and a tenth of the box", "pressure",
          near("pressure.free_paths.gas.path", 1.0, 0.01, 0.05)),
    Claim("effusion", "n⟨v⟩/π arrive per length and time", "effusion", agrees("effusion.*", 0.1)),
    Claim("effusion", "about 435 of the 2000 are on the right", "evolution",
          between("evolution.beyond.gas", 395 / 2000, 475 / 2000)),
    Claim("escape", "the mean escape time is pi A/(l v) = 441.9", "escape", near("escape.mean_time", 441.9, 20.0)),
    Claim("free-expansion", "its energy stays the same to rounding", "evolution", constant(T)),
    Claim("free-expansion", "The pressure falls to half its value", "evolution",
          series("evolution.pressure.pressure.left_wall", lambda p: 0.35 < sum(p[-4:]) / 4 / p[0] < 0.65)),
    Claim("heat-bath", "Var(E) = C T², and C = N", "heat-capacity", agrees("heat_capacity.logs.*.routes.Var*", 0.1)),
    Claim("lorentz", "perimeter of the scatterers, 0.6213", "billiard", near("billiard.path", 0.6213, 0.005)),
    Claim("lorentz", "for which D would be 0.162", "transport",
          between("transport.diffusion.gas.coefficient", 0.17, 0.35)),
    Claim("loschmidt", "at t = 21 the gas is in the left half", "evolution", prints(r"At the end 0\.0 %")),
    Claim("loschmidt", "follows the fraction in the right half", "evolution",
          series("evolution.beyond.gas", lambda share: max(share) > 0.4 and share[-1] == 0)),
    Claim("melting", "|Ψ₆| falls from 1 to the value of a fluid", "order",
          series("order.series", lambda psi: psi[0] > 0.99 and psi[-1] < 0.3)),
    Claim("mixing", "until each fills the whole box", "evolution", between("evolution.beyond.blue", 0.37, 0.63)),
    Claim("mixing", "until each fills the whole box", "evolution", between("evolution.beyond.red", 0.37, 0.63)),
    Claim("mixing", "temperature and pressure do not change at all", "evolution", constant(T)),
    Claim("mixture", "until both have the same temperature", "temperature",
          agrees("temperature.species.*y.both", 0.02)),
    Claim("mixture", "half as fast as the light ones", "histogram",
          series("histogram.distributions.*.mean", lambda v: abs(v[0] / v[1] - 2) < 0.05)),
    Claim("mushroom", "divided by the area of the mushroom, π R²/2 + 2 r h, which makes 0.2646", "section --walls stem",
          near("section.never", 0.26464, 0.005, 0.0013)),
    Claim("mushroom", "The two kinds of motion exist beside each other", "section", near("section.share", 1.0, 0.002)),
    Claim("novak-bortz", "become Maxwell-Boltzmann distributed within a few collisions per molecule", "relaxation",
          between("relaxation.logs.*.relaxation_collisions_per_disc", 1.0, 6.0)),
    Claim("osmosis", "the pressure on the right is higher by the osmotic pressure Π", "pressure",
          near("pressure.walls.membrane_right.pressure", 1.0, 0.05, 0.05)),
    Claim("osmosis", "the pressure on the right is higher", "pressure",
          prints(r"^P = 2\.1\d*\(\d+\) on the left wall, 3\.1\d*\(\d+\) on the right wall,")),
    Claim("otto", "the energy account shows the work of the piston", "evolution",
          between("evolution.given.piston", -2500, -800)),
    Claim("otto", "and the heat from the left side", "evolution", between("evolution.given.left", 800, 2500)),
    Claim("periodic", "that of an endless gas, without the corrections", "pressure",
          agrees("pressure.collision_rates.gas_gas.rate", 0.02)),
    Claim("piston", "Its position fluctuates about the position where P A = N T", "evolution",
          agrees("evolution.rest", 0.01)),
    Claim("piston", "The sum of the energy of the discs, the energy of the piston and P A is conserved", "evolution",
          BALANCE),
    Claim("poiseuille", "the viscosity of kinetic theory and a slip", "profile",
          agrees("profile.species.gas.velocity.*", 0.3)),
    Claim("polydisperse", "The pressure agrees with the theory of mixtures", "pressure",
          agrees("pressure.routes.pairs_virial.compressibility_factor", 0.01)),
    Claim("polydisperse", "lower than that of equal discs at the same packing fraction", "pressure",
          between("pressure.routes.pairs_virial.compressibility_factor", 2.18, 2.23)),
    Claim("quench", "the temperature of the gas falls exponentially at first", "evolution",
          series(T, lambda t: abs(t[60] - 4) < 0.5 and t[90] < 2.5)),
    Claim("quench", "levels off at the temperature of the walls", "evolution", between(T, 0.8, 1.2)),
    Claim("quickstart", "their speeds follow the Maxwell-Boltzmann distribution", "histogram",
          near("histogram.distributions.gas.mean", 0.8862, 0.002)),
    Claim("quickstart", "the size of hard discs adds about 2φ = 10 %", "pressure",
          near("pressure.routes.pairs_virial.compressibility_factor", 1.10, 0.002, 0.012)),
    Claim("relaxation-100", "come to equilibrium in about 25 units of time", "relaxation",
          between("relaxation.logs.*.settled_time", 5.0, 45.0)),
    Claim("relaxation-500", "come to equilibrium in about five units of time", "relaxation",
          between("relaxation.logs.*.settled_time", 2.5, 7.5)),
    Claim("rough", "until all are at temperature 1", "temperature", near("temperature.species.gas.both", 1.0, 0.01)),
    Claim("rough", "the heat capacity is 3N/2, not N", "evolution", between("evolution.spin", 0.9, 1.1)),
    Claim("rough-cooling", "the ratio of the two temperatures tends to 0.71", "cooling",
          near("cooling.temperature_ratio", 0.71, 0.05)),
    Claim("separation", "its own density profile", "profile", agrees("profile.species.heavy.density.[0-4]", 0.03)),
    Claim("separation", "the heavy gas gathers at the bottom", "profile",
          series("profile.species.heavy.density.*", lambda n: n[0] > 10 * n[-1])),
    Claim("shear", "the viscosity times the shear rate", "shear", near("shear.viscosity", 0.571, 0.06)),
    Claim("sinai", "67.4214", "billiard", prints(r"67\.4214")),
    Claim("sinai", "55.0999", "billiard", prints(r"55\.0999")),
    Claim("sinai", "the mean free path is 3.8441", "billiard", near("billiard.path", 3.8441, 0.058)),
    Claim("sine-floor", "0.88493 after the start of each period", "events",
          prints(r'"time": 396\.88493.*"partner": -3,.*\n.*"time": 398\.88493')),
    Claim("sine-floor", "the energy that the impact dissipates", "evolution",
          series("evolution.given.bottom", lambda given: abs(given[-1]) < 0.1)),
    Claim("sine-floor", "loses energy at each impact", "evolution",
          series("evolution.dissipated.bottom", lambda lost: abs(lost[-1] - 200 * 2 / 9) < 0.05)),
    Claim("sound", "the equation of state (`idealgas pressure`) and the transport coefficients", "sound",
          agrees("sound.waves.*.speed", 0.05)),
    Claim("stadium", "4.3636", "billiard", near("billiard.path", 4.3636, 0.05)),
    Claim("szilard", "thus turns heat into the work T ln 2 = 0.693", "evolution",
          between("evolution.given.piston", -0.75, -0.6)),
    Claim("thermostat", "The energy reaches NT in a few times 1/rate", "evolution", between(T, 0.7, 1.3)),
    Claim("thermostat", "Var(E) = C T², and C = N", "heat-capacity", agrees("heat_capacity.logs.*.routes.Var*", 0.12)),
    Claim("three-discs", "with four collisions and six wall hits", "info", prints(r"disc collisions: 12\b")),
    Claim("three-discs", "with four collisions and six wall hits", "info", prints(r"wall hits: 18\b")),
    Claim("triangle", "The velocity takes only eight values", "events", velocities(8)),
    Claim("triangle", "consists of four straight lines for each wall", "section", between("section.share", 0.0, 0.2)),
    Claim("triangle", "which is 3.5235 here", "billiard", prints(r"3\.5235")),
    Claim("triangle", "l/(a + 2b) = 3.4389", "billiard", near("billiard.path", 3.4389, 0.0005)),
    Claim("two-pistons", "In equilibrium both gases have the external pressure", "pressure",
          near("pressure.walls.piston_left.pressure", 2.0, 0.01)),
    Claim("two-pistons", "for the motion of each piston", "evolution", BALANCE),
    Claim("vibrated-granular", "hottest at the floor", "profile",
          series("profile.species.gas.temperature.*", lambda t: t[0] > 0.9 > 0.7 > min(t[2:4]))),
    Claim("vibrated-granular", "falls to a minimum at a height of about 2.5 and rises again above", "profile",
          series("profile.species.gas.temperature.[0-7]", lambda t: min(t) in t[2:4] and t[6] > min(t))),
    Claim("wedge", "Hits of the left wall are equally spaced in time, 4 √2 apart", "events",
          prints(r'"time": 4\.2426406871.*"partner": -5,(.*\n)+.*"time": 9\.8994949366.*"partner": -5,')),
    Claim("wedge", "Hits of the right wall are 2 √2 apart", "events",
          prints(r'"time": 1\.4142135623.*"partner": -6,(.*\n)+.*"time": 4\.2426406871.*"partner": -6,')),
    Claim("work", "exp(-W/T) has the mean exp(-ΔF/T)", "work", agrees("work.processes.*.free_energy", 1.0)),
]  # fmt: skip


def words_of(name):
    return " ".join(load_scene(SCENES[name]).scene.description.split())


def slow_unless_quick(name):
    return pytest.param(name, marks=() if name in QUICK else pytest.mark.slow)


def test_every_scene_with_a_description_has_a_claim_and_leads_with_analyses():
    described = [name for name in SCENES if words_of(name)]
    assert {claim.scene for claim in CLAIMS} == set(described)
    shows = {name: tomllib.loads(SCENES[name].read_text())["scene"].get("shows") for name in described}
    assert [name for name, analyses in shows.items() if not analyses] == []


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: f"{claim.scene}-{claim.words[:20]}")
def test_a_claim_is_in_the_description(claim):
    assert " ".join(claim.words.split()) in words_of(claim.scene)


@pytest.mark.parametrize("name", [slow_unless_quick(name) for name in sorted({claim.scene for claim in CLAIMS})])
def test_a_scene_shows_what_it_says(name, tmp_path):
    """And the analyses that it leads with apply to it."""
    path = str(tmp_path / "run.h5")
    printed = called("run", SCENES[name], "-o", path).stdout
    leads = registry.shown(load_scene(SCENES[name]))
    assert printed.splitlines()[-1].startswith(f"suggested analyses: `idealgas {leads[0]} ")
    for analysis in leads:
        output_of(analysis, path)
    for claim in CLAIMS:
        if claim.scene == name:
            assert claim.holds(Output(path, claim.command)), claim.words


@pytest.mark.slow
def test_reversals_come_back_as_the_page_of_runs_says(tmp_path):
    """Its table has the options of each run beside the fraction in the right half on return."""
    page = (ROOT / "idealgas" / "run" / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (none|`--set [^|]*`) \|[^|]*\|[^|]*\| (\d+) % \|$", page, re.MULTILINE)
    assert len(rows) == 4
    for options, percent in rows:
        words = [] if options == "none" else options.strip("`").split()
        output_of("run", SCENES["loschmidt"], "-o", tmp_path / "back.h5", "--force", "-q", *words)
        with open_log(tmp_path / "back.h5") as log:
            assert round(100 * (log.state_at(log.end_time).position[:, 0] > 10).mean()) == int(percent)
        if "wall=" not in options:
            assert f"At the end {percent}.0 % of the discs" in output_of("evolution", tmp_path / "back.h5")
