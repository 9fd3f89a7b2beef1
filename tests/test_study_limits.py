"""Limits that are stated after the fact on the measures of a study."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.studies.results.stated_limits import limit_of_text, limit_statement

PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01)


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    study = wr.Study(
        model="cabinet.xml", motion=PULSE, duration=0.05, timestep=5e-4, variants=16,
        vary={"mount/m0*/stiffness": wr.Normal(1.0, 0.2, each=True)},
    )  # fmt: skip
    return study.run(tmp_path_factory.mktemp("studies") / "study")


def test_a_pattern_is_exceeded_where_any_of_its_columns_is(result):
    names = [
        name for name in result.table.column_names if name.startswith("deflection/") and name.endswith("/compression")
    ]
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
        ("speed/rack = 3 m", "'m' is no unit of speed"),
        ("deflection/*/roll = 1e mm", "could not convert"),
    ],
)
def test_what_is_no_limit_is_refused(result, text, said):
    with pytest.raises(ValueError, match=said.replace("*", r"\*")):
        limit_of_text(text, result.table.column_names)


def test_a_wrong_limit_is_said_before_anything_is_computed(tmp_path, capsys):
    arguments = ["--vary", "motion/level = Uniform(0.5, 1)", "--variants", "4", "--limit", "speed = 3 m"]
    assert main(["study", "cabinet_shock", *arguments, "--out", str(tmp_path / "study")]) == 2
    assert "no unit of speed" in capsys.readouterr().err
    assert not (tmp_path / "study").exists()
