"""Folds between motions that differ by hundredths of a percent: a branch goes on past them, and keeps those that are jumps."""

import dataclasses

import numpy as np
import pytest
from house import sdof
from one_scale import one_scale_floor

import wirerope_mj as wr
from wirerope_mj.content.response_curve import response_content
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import level_summaries

LEVEL = 1.0


@pytest.fixture(scope="module")
def floor():
    """A floor on loops whose friction roll and axial share: two motions, 10 um apart, between 7.54 and 7.79 Hz.

    As it shipped with one scale of friction, to which these frequencies belong.
    """
    options = ResponseOptions(accelerations=(LEVEL,), direction="z", start=6.0, stop=10.0)
    return frequency_response(one_scale_floor(), options)


@pytest.mark.slow
def test_a_branch_goes_on_past_a_side_branch_to_the_resonance(floor):
    """It turned back at 7.785 Hz, passed its start, and called 2.08 m/s^2 there the resonance peak."""
    (branch,) = floor.branches
    assert branch.complete
    assert branch.folds == ()
    assert branch.gaps == ()
    system, frequency = branch.system, float(branch.frequency[branch.peak])
    sine = wr.Sine(frequency=frequency, acceleration=LEVEL, direction="z")
    swept = wr.simulate(system, sine, duration=100.0 / frequency, sample_rate=100.0 * frequency)
    top = np.abs(swept.bodies["floor"].acceleration[-300:, 2]).max()
    # Both integrations stay within 1e-4 of the motion; 100 samples a period miss 5e-4 of a crest.
    assert branch.amplitude[branch.peak] == pytest.approx(top, rel=2e-3)
    assert frequency == pytest.approx(9.17, rel=0.01)  # steps of the branch; a sweep of an independent integration says 9.2


@pytest.mark.slow
def test_what_lies_beside_it_is_said(floor):
    (branch,) = floor.branches
    assert branch.side_branches
    for side in branch.side_branches:
        assert 7.5 < side.start < side.stop < 7.85
        assert 1e-4 < side.difference < 1e-2  # 6e-4 by an independent integration of both motions at the upper end
    content = response_content(floor, level_summaries(floor))
    events = content.table("events").rows
    assert [row[1] for row in events] == ["side branch"] * len(branch.side_branches)
    assert all(row[5].endswith("% apart") for row in events)
    assert "resonance peak" in [row[1] for row in content.table("peaks").rows]
    assert content.verdict.text.startswith("Resonance of floor at 9.")


@pytest.mark.slow
def test_the_highest_of_a_branch_that_ended_early_is_not_called_a_resonance(floor):
    level = floor.levels[0]
    branch = dataclasses.replace(level.branch, complete=False)
    ended = dataclasses.replace(floor, levels=(dataclasses.replace(level, branch=branch),))
    content = response_content(ended, level_summaries(ended))
    names = [row[1] for row in content.table("peaks").rows]
    assert "resonance peak" not in names
    assert names[0].content == "highest before it ended"
    assert content.verdict.text.startswith("ENDED EARLY at 1 m/s²: ")
    assert content.verdict.tone == "exceeded"


HARDENING = {"alpha": 1.0, "beta": 0.5, "gamma": 0.5, "k1": 0.5, "k2": 0.0, "k3": 0.3}


@pytest.mark.parametrize("n", [0.3, 1.0, 2.0])
def test_a_fold_is_kept_where_two_settled_motions_differ(n):
    system = sdof(wr.SymmetricBoucWen(**HARDENING, n=n), mass=1.0)
    branch = wr.follow_branch(system, start=0.15, stop=0.8, acceleration=1.0, direction="z", payload="mass", largest_step=0.05)
    assert branch.complete
    upper, lower = branch.folds
    assert [jump.rising for jump in branch.jumps] == [True, False]
    assert branch.side_branches == ()
    sheets = slice(0, upper.index), slice(lower.index + 1, None)
    for sheet in sheets:
        # the motion of this sheet nearest to the middle of the range in which there are two, left to itself for 100 periods
        middle = np.sqrt(upper.frequency * lower.frequency)
        index = range(branch.frequency.size)[sheet][np.argmin(np.abs(branch.frequency[sheet] - middle))]
        orbit = branch.orbit(index)
        settled = wr.simulate(
            system, orbit.motion, duration=100.0 / orbit.frequency, initial=orbit.state,
            timestep=1.0 / (400.0 * orbit.frequency), sample_rate=400.0 * orbit.frequency,
        )  # fmt: skip
        largest = np.abs(settled.bodies["mass"].acceleration[-800:, 2]).max()
        # 128 steps against 400: 1e-4 of the deflection, three times that of a force that grows with its third power
        assert branch.amplitude[index] == pytest.approx(largest, rel=1e-3)
