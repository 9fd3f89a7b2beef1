"""Limits that are stated after the fact on the measures of a study."""

import json
from dataclasses import replace

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.study import measures_table, study_content
from wirerope_mj.content.study_statements import limit_statement, percent
from wirerope_mj.studies.results.study_summary import summary_of
from wirerope_mj.studies.results.varied import StatedLimit, limit_of_text

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01)


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    study = wr.Study(
        model="cabinet.xml", motion=PULSE, duration=0.05, timestep=5e-4, variants=16,
        vary={"mount/m0*/stiffness": wr.Normal(1.0, 0.2, each=True)},
    )  # fmt: skip
    return study.run(tmp_path_factory.mktemp("studies") / "study", workers=1)


def test_a_pattern_is_exceeded_where_any_of_its_columns_is(result):
    names = [name for name in result.table.column_names if name.startswith("deflection/") and name.endswith("/compression")]
    largest = np.max([result.table[name].to_numpy() for name in names], axis=0)
    limit = float(np.median(largest))
    stated = limit_of_text(f"deflection/*/compression = {1e3 * limit!r} mm", result.table.column_names)
    assert stated.measures == tuple(names)
    assert stated.exceedance(result.table).count == int((largest > limit).sum()) == 8


def test_one_measure_is_what_exceedance_says(result):
    stated = limit_of_text("acceleration/rack = 0.5 g", result.table.column_names)
    assert stated.exceedance(result.table) == result.exceedance("acceleration/rack", 0.5 * wr.STANDARD_GRAVITY)
    sentence = limit_statement(stated, result.table, sampled=True)
    assert sentence.startswith("Beyond acceleration/rack = 0.5 g: ")
    assert "at 95 % confidence" in sentence


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("deflection/*/roll 35 mm", "is written like"),
        ("deflection/*/roll = 35", "is written like"),
        ("deflection/*/roll = 35 g", "'g' is no unit of deflection"),
        ("deflection/*/yaw = 35 mm", "there is no measure 'deflection/*/yaw'"),
        ("speed/rack = 3 m", "there is no measure 'speed/rack'; there are "),
        ("acceleration/rak = 3 g", "there is no measure 'acceleration/rak'; alike are acceleration/rack, "),
        ("force/m1 = 3 kN", "alike are force/m01, "),
        ("struck = 3 m", "'m' is no unit of struck; known are none"),
        ("deflection/*/roll = 1e mm", "'1e' is no number"),
        ("deflection/*/roll = 1e999 mm", "too large for a number"),
        ("deflection/*/roll = 3 4 mm", "one number must stand there, got 2"),
    ],
)
def test_what_is_no_limit_is_refused(result, text, said):
    with pytest.raises(ValueError, match=said.replace("*", r"\*")):
        limit_of_text(text, result.table.column_names)


def test_a_wrong_limit_is_said_before_anything_is_computed(tmp_path, capsys):
    arguments = ["--vary", "motion/level = Uniform(0.5, 1)", "--variants", "4", "--limit", "speed = 3 m"]
    assert main(["study", "cabinet_shock", *arguments, "--out", str(tmp_path / "study")]) == 2
    assert "there is no measure 'speed'" in capsys.readouterr().err
    assert not (tmp_path / "study").exists()


def run_with_limit(folder, limit, *options):
    """Return what `wirerope study` says of a mass on a mount under a limit."""
    vary = ["--vary", "motion/level = Uniform(0.3, 0.9)", "--vary", "mount/m1/stiffness = Normal(1, 0.05)"]
    how = ["--variants", "32", "--workers", "1", "--duration", "0.1", "--timestep", "1e-3"]
    limits = ["--limit", limit] if limit else []
    return main(["study", "shock_table", *vary, *how, *limits, *options, "--out", str(folder)])


def test_a_stated_limit_stands_in_summary_and_report_whose_headline_counts_it(tmp_path, capsys):
    folder = tmp_path / "study"
    assert run_with_limit(folder, "acceleration/* = 5 g") == 0
    result = wr.load_study(folder)
    assert result.exceedance("travel").count == 0  # what was judged before: within
    beyond = result.exceedance("acceleration", 5.0 * wr.STANDARD_GRAVITY)
    (stated,) = json.loads((folder / "summary.json").read_text())["stated_limits"]
    assert 0 < stated["beyond"] == beyond.count
    assert (stated["text"], stated["of"], stated["failed"]) == ("acceleration/* = 5 g", 32, 0)
    assert (stated["probability"], stated["low"], stated["high"]) == (beyond.ratio, beyond.low, beyond.high)
    sentence = f"Beyond acceleration/* = 5 g, any of 2: {beyond.count} of 32 variants"
    assert sentence in capsys.readouterr().out
    assert main(["study-report", str(folder)]) == 0
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert sentence in page
    assert f"A limit is exceeded in {beyond.count} of 32 variants" in page
    assert "Within the limits" not in page


@pytest.mark.slow
def test_stated_limits_stay_until_others_are_stated(tmp_path, capsys):
    folder = tmp_path / "study"
    assert run_with_limit(folder, "acceleration = 500 g") == 0
    for limit, words in ((None, "Beyond acceleration = 500 g"), ("travel = 50 %", "Beyond travel = 50 %")):
        capsys.readouterr()
        assert run_with_limit(folder, limit, "--resume") == 0
        assert words in capsys.readouterr().out
    (stated,) = json.loads((folder / "summary.json").read_text())["stated_limits"]
    assert stated["limit"] == 0.5


def test_a_limit_on_one_measure_stands_in_the_table_of_measures(tmp_path):
    folder = tmp_path / "study"
    assert run_with_limit(folder, "acceleration = 5 g") == 0
    summary = summary_of(wr.load_study(folder))
    (row,) = [one for one in summary.statistics if one.measure.name == "acceleration"]
    assert row.measure.limit == 49.03325  # 5 g to twelve digits
    assert row.beyond.count > 0


def test_a_summary_that_was_damaged_is_one_message(tmp_path, capsys):
    folder = tmp_path / "study"
    assert run_with_limit(folder, None) == 0
    for content, words in (
        ("{", "not the summary of a study, nor JSON"),
        ('{"stated_limits": [{"text": "speed"}]}', "`stated_limits` is not"),
    ):
        (folder / "summary.json").write_text(content)
        assert main(["study-report", str(folder)]) == 2
        assert words in capsys.readouterr().err


@pytest.fixture
def unrated(result):
    """Return the table as if nothing stated a limit of acceleration."""
    table = result.table
    return table.set_column(table.column_names.index("fragility"), "fragility", [np.full(16, np.nan)])


def test_a_limit_on_what_is_rated_nowhere_is_not_judged(unrated):
    stated = limit_of_text("fragility = 50 %", unrated.column_names)
    assert "not judged" in limit_statement(stated, unrated, sampled=True)


def test_the_headline_counts_variants_beyond_any_limit(result):
    names = [f"deflection/{mount}/compression" for mount in ("m01", "m06")]
    values = [result.table[name].to_numpy() for name in names]
    limits = [float(np.sort(own)[-3]) for own in values]  # two are beyond each
    union = np.any([own > limit for own, limit in zip(values, limits, strict=True)], axis=0)
    assert union.sum() > 2
    stated = tuple(StatedLimit(text=name, measures=(name,), limit=limit) for name, limit in zip(names, limits, strict=True))
    headline = study_content(replace(summary_of(result), stated=stated)).verdict
    assert headline.text.startswith(f"A limit is exceeded in {union.sum()} of 16 variants ({percent(union.mean())})")
    assert headline.values["ratio"] == union.mean()


def test_what_has_a_value_counts_beside_what_has_none(unrated):
    both = StatedLimit(text="", measures=("fragility", "acceleration"), limit=0.0)
    assert both.exceedance(unrated).n == 16


def test_the_list_of_measures_has_every_kind_and_not_every_mount(result):
    names = [name for name in result.table.column_names[2:] if name not in ("status", "message")]
    with pytest.raises(ValueError, match="there is no measure 'deflection/m01/rol'") as raised:
        result.exceedance("deflection/m01/rol", 1.0)
    said = str(raised.value)
    assert "alike are deflection/m01/roll, " in said
    for kind in ("acceleration/NAME", "deflection/NAME/compression", "travel/NAME", "static_load/NAME", "force/NAME"):
        assert kind in said
    assert len(said) < 600 < len(", ".join(names))


@pytest.mark.slow
def test_the_nominal_system_stands_beside_its_variants(tmp_path):
    pulse = wr.HalfSine(peak=50.0, duration=0.011, direction="z", start=0.01)
    study = wr.Study(
        model="shock_table.xml", motion=pulse, duration=0.1, timestep=5e-4, variants=8,
        vary={"motion/level": wr.Uniform(0.5, 1.5)},
    )  # fmt: skip
    result = study.run(tmp_path / "study", workers=1)
    alone = wr.simulate(wr.load_system("shock_table"), pulse, duration=0.1, timestep=5e-4)
    assert result.nominal["acceleration/block"] == pytest.approx(alone.peaks.bodies["block"].acceleration.value, rel=1e-9)
    assert "nominal" in [column.heading for column in measures_table(summary_of(result)).columns]
