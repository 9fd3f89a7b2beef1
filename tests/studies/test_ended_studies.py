"""Studies, searches and candidates whose runs end before their peaks are over judge nothing but what is exceeded already."""

import math
import tomllib

import numpy as np
import pytest
from house import sdof, sdof_text
from small_search import beam_search
from table_study import G, table_study

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge
from wirerope_mj.assessment.criteria.ended import GROWS, too_short
from wirerope_mj.assessment.criteria.summary import contact_lines
from wirerope_mj.assessment.criteria.verdict import TRAVEL
from wirerope_mj.cli import main
from wirerope_mj.content.study_statements import limit_statement, statements
from wirerope_mj.mounts.isolator import Limits, Travel
from wirerope_mj.studies.ended import ended_early
from wirerope_mj.studies.results.study_summary import any_exceeded, summary_of
from wirerope_mj.studies.results.varied import limit_of_text

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

PULSE = wr.HalfSine(peak=15.0 * G, duration=0.011, direction="z")


def rated(**others):
    """Return a study of a linear mass of 10 Hz under a shock that stays within a rated travel of 40 mm."""
    law = wr.KelvinVoigt(k=3.5 * (2 * math.pi * 10.0) ** 2, c=10.0)
    limits = Limits(travel=Travel(compression=0.04, tension=0.04))
    given = {
        "model": sdof_text(), "isolators": {"a": wr.Isolator(name="a", axial=law, limits=limits)}, "motion": PULSE,
        "timestep": 1e-3, "sampling": "list", "vary": {"body/mass/mass": wr.Choice([2.0, 3.5, 14.0], relative=False)},
    }  # fmt: skip
    return wr.Study(**given | others)


@pytest.mark.quick
def test_variants_are_judged_by_the_rule_of_runs_each_by_its_own_period(tmp_path):
    """A mass four times as large swings half as fast: 0.26 s are long enough for the two lighter ones alone."""
    study = rated(duration=0.26)
    result = study.run(tmp_path / "study", workers=1)
    early = ended_early(result.table)
    for variant in range(3):
        assert early[variant] == bool(too_short(study.response(variant)))
    assert early.tolist() == [False, False, True]
    assert (np.asarray(result.table["travel"]) < 1.0).all()  # what was reached until the end
    beyond = result.exceedance("travel")
    assert (beyond.count, beyond.n, beyond.early) == (0, 3, 1)
    assert beyond.high > result.exceedance("travel", limit=2.0).high - 1e-12
    assert beyond.at_most == pytest.approx(1.0 / 3.0)
    first, second, *_ = statements(result)
    assert first.startswith("1 of 3 variants: not judged but for what is exceeded already, since the run ends at 260 ms")
    assert "beyond 100 % in 0 of 3 variants; 1 ended too early to be judged" in second
    stated = limit_of_text("deflection/m1/compression = 35 mm", result.table.column_names)
    assert limit_statement(stated, result.table, sampled=False).endswith("0 of 3 variants; 1 ended too early to be judged.")
    assert any_exceeded([summary_of(result)]).early == 1


@pytest.mark.quick
def test_a_study_that_ends_inside_its_pulse_says_so_and_keeps_what_is_exceeded(tmp_path):
    short = rated(duration=0.012).run(tmp_path / "short", workers=1)
    assert short.exceedance("travel").judged == 0
    assert statements(short)[0].startswith("Every variant: not judged but for what is exceeded already")
    assert "not judged, since every run ends before its peaks are over" in statements(short)[1]
    hard = rated(duration=0.05, motion=wr.HalfSine(peak=60.0 * G, duration=0.011, direction="z"))
    beyond = hard.run(tmp_path / "hard", workers=1).exceedance("travel")
    assert (beyond.count, beyond.n, beyond.early) == (3, 3, 0)


def test_one_alone_and_many_together_end_too_early_alike(tmp_path):
    kept = table_study(variants=6, duration=0.2).run(tmp_path / "kept", keep="responses", workers=1)
    together = table_study(variants=6, duration=0.2).run(tmp_path / "together", workers=1)
    assert ended_early(together.table).all()
    assert together.table["message"].to_pylist() == kept.table["message"].to_pylist()


def test_the_command_does_not_call_a_short_study_within(tmp_path, capsys):
    how = [
        "--vary",
        "body/block/mass = Uniform(0.9, 1.1, relative)",
        "--variants",
        "8",
        "--workers",
        "1",
        "--timestep",
        "1e-3",
    ]
    limit = ["--limit", "acceleration = 40 g"]
    command = ["study", "shock_table", *how, *limit, "--out", str(tmp_path / "out"), "--duration", "0.02"]
    assert main(command) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "Every variant: not judged but for what is exceeded already, since the run ends at 20 ms" in printed
    assert "Beyond acceleration = 40 g: not judged, since every run ends before its peaks are over" in printed


def test_a_search_takes_no_design_whose_run_was_stopped(tmp_path):
    pytest.importorskip("pymoo")
    result = beam_search(generations=2, duration=0.02).run(tmp_path / "search", workers=1)
    assert not result.feasible.any()
    assert "before its peaks are over" in result.message


@pytest.mark.quick
def test_stops_of_a_run_that_ends_early_are_not_judged():
    law = wr.Parallel(laws=(wr.KelvinVoigt(k=14e3, c=10.0), wr.Stop(gap_below=0.03, gap_above=0.03, k=1e6)))
    system = sdof(law)
    for duration, verdict in ((0.02, "not judged"), (0.5, "not touched")):
        response = wr.simulate(system, PULSE, duration=duration, timestep=1e-4)
        stops = [row for row in judge(response) if row.criterion == "stop"]
        assert [row.verdict for row in stops] == [verdict]
        said = contact_lines(response, too_short(response))[0]
        assert ("until the run ends" in said) == (duration == 0.02)
    assert stops[0].note == ""


@pytest.mark.quick
def test_batches_and_scenario_files_warn_of_histories_that_alias(tmp_path):
    system = sdof(wr.KelvinVoigt(k=4e4, c=120.0))
    fast = wr.Sine(frequency=700.0, acceleration=5.0 * G, direction="z")
    with pytest.warns(wr.AccuracyWarning, match="up to 700 Hz, and 1000 samples a second tell nothing above 500 Hz"):
        wr.simulate_batch(system, [fast, PULSE], duration=0.02, timestep=1e-4, responses=True)
    wr.simulate_batch(system, [fast, PULSE], duration=0.02, timestep=1e-4)  # keeps no history
    scenario = wr.Scenario(
        question="?", model=system.mjcf, motion=fast, simulate={"duration": 0.02}, isolators=system.isolators
    )
    with pytest.warns(wr.AccuracyWarning, match="up to 700 Hz"):
        wr.run_scenario(scenario, tmp_path / "run")
    content = tomllib.loads((tmp_path / "run" / "scenario.toml").read_text(encoding="utf-8"))
    assert content["warning"].startswith("the base moves at up to 700 Hz")
    with pytest.warns(wr.AccuracyWarning, match="up to 700 Hz"):
        assert wr.replay(tmp_path / "run").agrees


@pytest.mark.quick
@pytest.mark.parametrize("keep", ["peaks", "responses"])
def test_what_still_grows_is_not_judged_in_studies_as_in_runs(keep, tmp_path):
    """A sine at the resonance of the second of three masses goes on pumping it up; the others beat and are over."""
    sine = wr.Sine(frequency=10.0, acceleration=4.0, direction="z")
    vary = {"body/mass/mass": wr.Choice([2.0, 3.5, 14.0], relative=False)}
    study = rated(motion=sine, duration=1.25, vary=vary)
    result = study.run(tmp_path / "study", workers=1, keep=keep)
    growing = []
    for variant in range(3):
        rows = judge(study.response(variant))
        growing.append(any(row.note.startswith(GROWS) for row in rows if row.criterion.kind == TRAVEL))
    assert growing == [False, True, False]
    assert ended_early(result.table, "travel").tolist() == ended_early(result.table, "travel/m1").tolist() == growing
    assert not ended_early(result.table, "static_load").any()
    beyond = result.exceedance("travel")
    assert (beyond.count, beyond.early) == (0, 1)
    assert statements(result)[0].startswith("1 of 3 variants: what still grows when the run ends is not judged")
