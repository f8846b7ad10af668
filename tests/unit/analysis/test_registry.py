"""What is made from the registry: results by name, tables, sections of a report; and what an analysis has to have."""

import csv
import inspect
import io
import json
import subprocess
import sys
from fnmatch import fnmatchcase
from importlib import import_module
from pkgutil import iter_modules

import pytest
from helpers.logs import PERIODIC, gas, raised
from helpers.support import ROOT

import idealgas
from idealgas import analysis as package
from idealgas import catalogue
from idealgas.analysis import registry
from idealgas.analysis.analysis import Option
from idealgas.analysis.result import Result
from idealgas.fields import reported_properties
from idealgas.presentation.quantities import ESTIMATE, as_csv, names
from idealgas.presentation.tables import Number, Table, escape, estimates, html_table
from idealgas.report.sections import make_sections
from idealgas.scene import load_scene, parse_scene
from idealgas.statistics.estimates import Estimate

GAS = gas(30, 0.2, (8, 8), "collisions_per_disc = 60", speed=1.0)

SLIT = (
    "species.0.region=[0,0,4,8]",
    "wall=[{from=[4,0],to=[4,3]},{from=[4,5],to=[4,8]},{from=[4,3],to=[4,5],opens_at=1.0}]",
    "run.collisions_per_disc=10",
)

WAVES = (*PERIODIC, "species.0.radius=0.5", "run.collisions_per_disc=1500")
STROKES = (
    "thermostat={temperature=1, rate=1}",
    "piston=[{velocity=[[0, 0], [5, -1], [6, 0], [11, 1], [12, 0], [17, -1], [18, 0]]}]",
    "run.collisions_per_disc=",
    "run.until=20",
)
SHEARED = ("box.left=periodic", "box.right=periodic", "box.bottom={shear=0.1}", "box.top={shear=0.1}")
HOLE = ("wall=[{from=[4,3],to=[4,5],absorbing=true}]", "run.collisions_per_disc=2")
TAKES = {"effusion": SLIT, "sound": WAVES, "scattering": WAVES, "work": STROKES, "cooling": ("restitution.normal=0.9",)}
TAKES |= {"shear": SHEARED, "escape": HOLE}
"""Overrides for the gas of those analyses that have no answer for a closed box."""

NOT_ALONE = ["Cooling", "Order", "Scattering", "Sound", "Shear flow", "Effusion", "Escape", "Work"]
"""Sections that a dilute gas in a closed box does not have."""

every_analysis = pytest.mark.parametrize("analysis", registry.analyses(), ids=lambda analysis: analysis.key)


def test_every_module_beside_the_registry_is_an_analysis_or_named_as_another():
    modules = {module.name for module in iter_modules(package.__path__)}
    assert modules == {*registry.names(), *catalogue.OTHERS}
    assert sorted(analysis.name for analysis in registry.analyses()) == list(registry.names())
    assert [analysis.position for analysis in registry.analyses()] == sorted({a.position for a in registry.analyses()})


@every_analysis
def test_an_analysis_takes_the_options_that_it_declares(analysis):
    taken = list(inspect.signature(analysis.measure).parameters)
    assert taken[0] == "log"
    assert set(taken[1:]) == {"start", "end", "progress", *(option.name for option in analysis.options)}
    assert all(kind.analysis is analysis for kind in analysis.results)
    assert registry.help_of(analysis.name) == inspect.getdoc(import_module(f"{package.__name__}.{analysis.name}"))
    described = inspect.getdoc(getattr(idealgas, analysis.name)).split("\nArgs:\n")[1].partition("\n\nRaises:")[0]
    assert {line.partition(":")[0].strip() for line in described.splitlines()} == set(taken)


def test_what_analyses_say_of_themselves_takes_nothing_heavy():
    heavy = ("numpy", "numba", "scipy", "h5py", "matplotlib", "pydantic", "rich")
    program = (
        "import sys\nfrom idealgas.analysis import registry\nlist(map(registry.help_of, registry.names()))\n"
        f"print(*(name for name in {heavy} if name in sys.modules), end='')"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_analyses_by_name(make):
    log = make()
    steps = []
    result = registry.analyse(log, "temperature", 1.0, 3.0, lambda done, total: steps.append((done, total)))
    assert (result.window.start, result.window.end) == (1.0, 3.0)
    assert steps
    by_key, by_name = (registry.analyse(log, name) for name in ("heat-capacity", "heat_capacity"))
    assert by_key == by_name
    assert registry.analyse(log, "histogram", quantity="vx").quantity == "vx"
    assert len(registry.analyse(log, "profile", bins=3).edges) == 4


def test_a_scene_leads_with_what_it_names_or_its_effects_call_for():
    escape = load_scene(ROOT / "configs" / "escape.toml", ["scene.shows=[]"])
    assert registry.shown(escape) == ("escape", "evolution")
    assert registry.shown(parse_scene(GAS)) == ("pressure", "temperature", "histogram")
    assert registry.shown(parse_scene(GAS, overrides=('scene.shows=["order", "pressure"]',))) == ("order", "pressure")


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("presure", {}, r'unknown analysis, did you mean "pressure"\? \(got presure; allowed billiard, cooling, '),
        ("speeds of light", {}, r"unknown analysis \(got speeds of light; allowed billiard, cooling, "),
        ("profile", {"bin": 3}, r'unknown option of profile, did you mean "bins"\? \(got bin; allowed start, end, '),
        ("profile", {"bins": 0}, r"bins: wrong value \(got 0; allowed a whole number >= 1 and <= 1000\)"),
        ("profile", {"bins": 2.5}, "bins: wrong value"),
        ("profile", {"along": "z"}, r"along: wrong value \(got 'z'; allowed x, y\)"),
        ("histogram", {"quantity": None}, "quantity: wrong value"),
        ("relaxation", {"every": 0}, r"every: wrong value \(got 0; allowed a number > 0\)"),
        ("relaxation", {"every": True}, "every: wrong value"),
    ],
)
def test_unknown_names_and_wrong_options_are_refused(make, name, options, message):
    raised(message, registry.analyse, make(), name, **options)


def test_an_option_takes_its_default():
    option = Option("along", str, "", choices=("x", "y"))
    option.check(None)
    option.check("x")


@every_analysis
def test_terminal_csv_and_json_have_the_same_numbers(make, analysis):
    measured = analysis.analyse(make(*TAKES.get(analysis.name, ())))
    result = analysis.combined([measured])
    assert isinstance(measured, Result)
    assert isinstance(result, Result)
    assert isinstance(result.as_dict()["caveats"], list)
    tables = measured.tables()
    assert any(table.rows for table in tables)
    headline = measured.summary()
    assert headline == result.summary() == str(measured).splitlines()[0]
    assert len(headline) < 300
    said = ("agree", "differ", "theory")  # no number without a theory or its absence
    assert any(word in headline.lower() for word in said)
    text = json.dumps(result.as_dict(), allow_nan=False)
    rows = list(csv.DictReader(io.StringIO(as_csv(result.as_dict(), analysis.name))))
    numbers = [float(row[name]) for row in rows for name in ESTIMATE if row[name]]
    assert sorted(numbers) == sorted(_numbers(json.loads(text)))
    known = list(names(type(result), (analysis.name,)))
    for row in rows:
        assert all(part.isidentifier() or part.isdigit() for part in row["quantity"].split("."))
        assert row["index"] or any(fnmatchcase(row["quantity"], name) for name in known), row["quantity"]
    for table in tables:
        assert all(len(row) == len(table.heads) for row in table.rows)


@every_analysis
def test_a_result_is_restored_from_its_plain_values(make, analysis):
    measured = analysis.analyse(make(*TAKES.get(analysis.name, ())))
    if analysis.combine is None:
        return
    stored = json.loads(json.dumps(measured.as_dict()))
    restored = analysis.restored(stored, measured.origin)
    assert (type(restored), restored.origin) == (type(measured), measured.origin)
    assert json.dumps(restored.as_dict()) == json.dumps(stored)
    assert restored.summary() == measured.summary()
    if analysis.name == "section":  # without its points, which only logs provide
        raised("results of a sweep contain no points", restored.figure)
    else:
        assert restored.figure().axes
    message = f"{measured.origin.path}: damaged results of the analysis {analysis.key}"
    for name in set(stored) - {"caveats", *reported_properties(type(measured))}:
        raised(message, analysis.restored, stored | {name: {"of": ["another", "kind"]}}, measured.origin)


@every_analysis
def test_results_show_themselves_in_a_notebook(make, analysis):
    log = make(*TAKES.get(analysis.name, ()))
    result = getattr(idealgas, analysis.name)(log)
    combined = analysis.combined([analysis.analyse(log)])
    assert repr(result.tables()) == repr(combined.tables())  # nan is not nan
    shown, text = result._repr_html_(), str(result)
    for table in result.tables():
        assert all(escape(note) in shown for note in table.notes)
        if table.rows:
            assert html_table(table) in shown
            assert all(cell in text for row in table.shown for cell in row)
    figure = result.plot()
    assert len(figure.axes) == len(combined.plot().axes) > 0
    assert figure._repr_png_().startswith(b"\x89PNG")
    assert all(ax.get_xlabel() and ax.get_ylabel() for ax in figure.axes)


def test_what_a_notebook_shows_is_plain_text():
    assert "<td>&lt;b&gt; &amp; \\u001b</td>" in html_table(Table("t", ("",), [("<b> & \x1b",)]))


def _numbers(result):
    if isinstance(result, dict | list):
        for part in result.values() if isinstance(result, dict) else result:
            yield from _numbers(part)
    elif isinstance(result, int | float):
        yield float(result)


def test_a_report_shows_every_section_or_says_why_not(make):
    always = [analysis for analysis in registry.analyses() if not analysis.on_request]
    titles = [section.title for analysis in always for section in analysis.sections]
    steps = []
    sections = make_sections(make(), lambda done, total: steps.append((done, total)))
    assert [section.title for section in sections] == titles
    assert steps == [(k + 1, len(titles)) for k in range(len(titles))]
    assert [section.title for section in sections if section.left_out] == NOT_ALONE
    assert all(section.picture and section.caption and section.tables for section in sections if not section.left_out)
    (order,) = [section.left_out for section in sections if section.title == "Order"]
    assert order == "the packing fraction is below 0.5"
    without_positions = make_sections(make('run.method="monte_carlo"', "run.v_ref=5"))
    left_out = {section.title: section.left_out for section in without_positions if section.left_out}
    assert left_out["Profile"] == "a profile requires discs with positions"
    assert "Evolution" not in left_out


def test_people_see_some_rows_and_digits():
    table = Table("t", ("", "n"), [(str(k), Number(k / 7, ".2f")) for k in range(10)], most=3)
    assert table.shown == [["0", "0.00"], ["4", "0.57"], ["9", "1.29"]]
    other = estimates("e", [("a, b", Estimate(1 / 3, float("nan"), 5.0))])
    assert other.shown == [["a, b", "0.333333", "", "5", "", ""]]


def test_csv_has_a_row_for_each_number_with_all_digits():
    result = Estimate(1 / 3, float("nan"), 5.0).as_dict()
    actual = {
        "routes": [{"route": "a, b", "z": result}],
        "left wall": 2,
        "series": [[0.1, None], [0.3, 0.4]],
        "none": None,
    }
    assert as_csv(actual, "p").splitlines() == [
        "quantity,group,index,value,standard_error,independent_samples,theory,theory_error,deviation",
        f'p.routes.a_b.z,"a, b",,{1 / 3!r},,5.0,,0.0,',
        "p.left_wall,left wall,,2.0,,,,,",
        "p.series.0,,0,0.1,,,,,",
        "p.series.0,,1,0.3,,,,,",
        "p.series.1,,1,0.4,,,,,",
    ]


@pytest.mark.parametrize(("overrides", "ideal"), [((), 1.0), (("gravity.acceleration=[0, -0.1]",), None)])
def test_the_figure_of_the_pressure_has_the_ideal_gas(make, overrides, ideal):
    result = idealgas.pressure(make(*overrides))
    (ax,) = result.plot().axes
    (line,) = (line for line in ax.get_lines() if str(line.get_label()).startswith("ideal gas"))
    place = line.get_xdata()[0]
    assert place == (ideal or result.number * result.temperature / result.area)
    assert ax.get_xlim()[0] < place < ax.get_xlim()[1]
