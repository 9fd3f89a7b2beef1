"""What a run says of how far it can be relied on: the weakest part first, grades that follow from what is stated."""

from dataclasses import replace

import numpy as np
import pytest
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.content.credibility import (
    _PROVENANCE_GRADES,
    compared_credibility_blocks,
    credibility_blocks,
    study_credibility_blocks,
)
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.mounts.isolator import MeasuredRange, Validity
from wirerope_mj.mounts.isolator.parts import KINDS

LAW = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.4, k=5e4)
TESTED = MeasuredRange(amplitude=(1e-4, 20e-3), deflection=(-20e-3, 20e-3), frequency=(1.0, 1.0))
SPREAD = wr.Spread(parameters=("axial.alpha", "axial.k"), covariance=((4e8, 0.0), (0.0, 1e8)))


SHOCK = wr.HalfSine(peak=100.0, duration=0.011, direction="z")


def judged(isolator, **options):
    """Return a judged shock on one mount."""
    system = wr.load_system(sdof_text(mass=20.0), isolators={"a": isolator})
    return judged_run(system, SHOCK, wr.simulate(system, SHOCK, duration=0.3, **options))


def told(isolator, **options):
    """Return statement and rows by part of a shock on one mount."""
    statement, table = credibility_blocks(judged(isolator, **options))
    return statement, {row[0]: row for row in table.rows}


def grade(row):
    return int(row[1].content[0])


@pytest.fixture(scope="module")
def identified():
    provenance = wr.Provenance(kind="identified", source="rig", assumed=("roll as axial",))
    return wr.Isolator(name="a", axial=LAW, provenance=provenance, spread=SPREAD, validity=Validity(axial=TESTED))


def test_what_is_measured_in_all_parts_is_limited_by_its_input(identified):
    statement, rows = told(identified)
    assert [grade(row) for row in rows.values()] == [4, 2, 3, 4]
    assert statement.text.startswith("The answer is as good as its weakest part, input (stated): half-sine")
    assert "1 isolator: identified; 1 value assumed" in rows["isolator data"][2]
    assert "direction: every axis tested" in rows["form of the model"][2]


def test_the_scatter_of_the_stiffness_moves_peaks_by_half_of_it(identified):
    _, rows = told(identified)
    scatter = (4e8 + 1e8) ** 0.5 / (LAW.alpha + LAW.k)
    assert rows["isolator data"][3] == pytest.approx(1.645 * 0.5 * scatter, rel=1e-6)
    shares = [row[4] for row in rows.values() if row[4] == row[4]]
    assert sum(shares) == pytest.approx(1.0)


def test_the_scatter_of_an_asymmetry_moves_peaks_by_its_stiffness_at_half_the_travel():
    """A catalogue part states the scatter of c alone, which leaves the slope at rest as it is."""
    part = wr.load_isolator("enidine_wr16_400")
    law, half = part.axial, -0.5 * part.limits.travel.compression
    changes = [
        wr.Parallel(laws=[replace(one, c=one.c + sign * 21.0076**0.5) for one in law.laws]).trace([0.0, half]).force[-1]
        for sign in (-1.0, 1.0)
    ]
    scatter = abs(changes[1] - changes[0]) / 2.0 / abs(law.trace([0.0, half]).force[-1])
    _, rows = told(part)
    assert "no file states a scatter" not in rows["isolator data"][2]
    assert rows["isolator data"][3] == pytest.approx(1.645 * 0.5 * scatter, rel=0.02)  # the other is the slope at c


def test_beyond_what_was_tested_the_form_says_how_far(identified):
    small = replace(TESTED, amplitude=(1e-4, 1e-3), deflection=(-1e-3, 1e-3))
    _, rows = told(replace(identified, validity=Validity(axial=small)))
    assert grade(rows["form of the model"]) == 2
    assert "times the largest tested, at m1 axial" in rows["form of the model"][2]


def test_what_nothing_is_known_of_is_the_weakest_part(identified):
    statement, rows = told(replace(identified, validity=Validity(), spread=None, provenance=wr.Provenance()))
    assert (grade(rows["form of the model"]), grade(rows["isolator data"])) == (1, 1)
    assert statement.tone == "unjudged"
    assert "no number, so that the true band is wider" in statement.text


def test_a_given_step_is_an_assumption(identified):
    _, rows = told(identified, timestep=1e-4)
    assert grade(rows["computation"]) == 1


@pytest.mark.slow
def test_a_study_is_graded_as_its_runs_are_by_the_largest_of_its_deflections(identified, tmp_path):
    small = replace(TESTED, amplitude=(1e-4, 4e-3), deflection=(-4e-3, 4e-3))
    known = replace(identified, validity=Validity(axial=small))
    study = wr.Study(
        model=sdof_text(mass=20.0), isolators={"a": known}, motion=SHOCK, duration=0.3, variants=4, timestep=2e-4,
        vary={"motion/level": wr.Uniform(0.5, 2.0)},
    )  # fmt: skip
    result = study.run(tmp_path / "study", workers=1)
    statement, table = study_credibility_blocks(result)
    rows = {row[0]: row for row in table.rows}
    deepest = [np.max(result.table[f"deflection/m1/{side}"]) for side in ("compression", "tension")]
    assert f"amplitude {0.5 * sum(deepest) / 4e-3:.2g} times" in rows["form of the model"][2]
    system = wr.load_system(sdof_text(mass=20.0), isolators={"a": known})
    coarse, fine = (
        wr.simulate(system, SHOCK, duration=0.3, timestep=step).peaks.mounts["m1"].force.value for step in (2e-4, 1e-4)
    )
    assert rows["computation"][3] >= abs(coarse / fine - 1.0) * 0.999  # of all peaks the largest change
    assert 0.0 < rows["computation"][3] < 1e-3
    assert statement.text.startswith("The answer is as good as its weakest part, ")
    result.study.vary["mount/m1/isolator"] = wr.Choice("a", "b")  # other parts may need other steps
    _, table = study_credibility_blocks(result)
    rows = {row[0]: row for row in table.rows}
    assert grade(rows["computation"]) == 3


def test_a_comparison_is_as_good_as_the_weakest_part_of_all_runs(identified):
    guessed = replace(identified, validity=Validity(), provenance=wr.Provenance())
    statement, table = compared_credibility_blocks({"known": judged(identified), "guessed": judged(guessed)})
    assert "weakest part, form of the model of guessed (assumed)" in statement.text
    assert [column.title() for column in table.columns] == ["part", "known", "guessed"]
    assert [int(cell.content[0]) for cell in table.rows[2][1:]] == [3, 1]


def test_every_kind_of_provenance_has_a_grade():
    assert set(_PROVENANCE_GRADES) == set(KINDS)
