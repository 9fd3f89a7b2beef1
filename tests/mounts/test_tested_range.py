"""The range that a law was identified in: kept in the isolator's file, and said where a run or an amplitude leaves it."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from commands import wirerope
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.travel import untested_line
from wirerope_mj.content.blocks import Statement
from wirerope_mj.content.modes import below_tests
from wirerope_mj.content.response_curve import response_content
from wirerope_mj.dynamics.frequency_response.result import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import level_summaries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.identification.records import identified_isolator
from wirerope_mj.mounts.identification.result import OF_ACCELERATION, OF_DEFLECTION
from wirerope_mj.mounts.isolator import MeasuredRange, Validity
from wirerope_mj.mounts.isolator.parts import BELOW

LAW = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.4, k=5e4)
SIZES = 2e-3, 5e-3, 8e-3


def record(sizes):
    """Return time, deflection and force of five cycles of each size at 2 Hz, one after the other."""
    time = np.arange(0.0, 2.5 * len(sizes), 1e-3)
    size = np.asarray(sizes)[np.minimum((time / 2.5).astype(int), len(sizes) - 1)]
    deflection = size * np.sin(4.0 * np.pi * time)
    return time, deflection, LAW.trace(deflection).force


@pytest.fixture(scope="module")
def isolator():
    time, deflection, force = record(SIZES)
    result = wr.identify(wr.steady_loops(deflection, force, time=time), law=wr.BoucWen)
    return identified_isolator(result, name="rig", axis="axial", files=[], given=[])


def test_the_range_of_a_record_is_that_of_its_cycles(isolator):
    axial = isolator.validity.axial
    assert isolator.validity.stated.keys() == {"axial"}
    assert axial.amplitude == pytest.approx((2e-3, 8e-3), rel=1e-3)
    assert axial.deflection == pytest.approx((-8e-3, 8e-3), rel=1e-3)
    assert axial.frequency == pytest.approx((2.0, 2.0), rel=1e-3)
    # over a tenth of a cycle a sine's mean rate is sinc(0.1) of the largest
    assert axial.rate == pytest.approx([4.0 * np.pi * size * np.sinc(0.1) for size in (2e-3, 8e-3)], rel=1e-2)


def test_the_range_comes_back_from_the_file(isolator, tmp_path):
    isolator.save(tmp_path / "rig.toml")
    assert wr.load_isolator(tmp_path / "rig.toml").validity == isolator.validity


@pytest.mark.parametrize(
    ("level", "said"),
    [
        (60.0, ""),
        (120.0, r"m1 axial -1\d\.\d to 0 mm \(tested -8 to 8 mm\)"),
        (0.5, r"m1 axial ±0\.0\d+ mm \(tested 2 to 8 mm\)"),
    ],
)
def test_a_run_says_where_it_leaves_the_range(isolator, level, said):
    system = wr.load_system(sdof_text(mass=20.0), isolators={"a": isolator})
    shock = wr.HalfSine(peak=level, duration=0.02, direction="z", start=0.01)
    response = wr.simulate(system, shock, duration=0.3, timestep=5e-4)
    deflection = response.mounts["m1"].deflection[:, 2]
    half = 0.5 * np.ptp(deflection)
    assert (2e-3 < half < 8e-3) == (said == "")
    line = untested_line({"m1": isolator}, response)
    if said:
        assert re.fullmatch(
            f"Outside the cycles that the isolator was identified from, and so extrapolated: {said}. The error of the fit says "
            "nothing of forces there.",
            line,
        )
    else:
        assert line == ""


def test_what_hardly_moves_across_and_what_nothing_was_measured_of_is_not_said():
    small = MeasuredRange(amplitude=(1e-3, 5e-3), deflection=(-5e-3, 5e-3))
    validity = Validity(roll=small, axial=small)
    still = validity.outside([-1e-5, -9.0, -4e-3], [1e-5, 9.0, 4e-3], small=True)
    assert still == {}
    off_centre = validity.outside([0.0, 0.0, -8e-3], [0.0, 0.0, -4e-3], small=False)
    assert off_centre == {"axial": "-8 to -4 mm (tested -5 to 5 mm)"}


def test_modes_and_frequency_responses_below_the_least_tested_cycle_are_not_judged():
    tested = MeasuredRange(amplitude=(2e-3, 8e-3), deflection=(-8e-3, 8e-3))
    device = wr.Isolator(name="a", axial=LAW, validity=Validity(axial=tested))
    system = wr.load_system(sdof_text(mass=20.0), isolators={"a": device})
    (text,) = below_tests(system)
    assert "least that isolators were tested at: a axial (2 mm)" in text
    assert f"extrapolated and {BELOW}" in text
    options = ResponseOptions(accelerations=(0.3, 8.0), start=8.0, stop=25.0).checked(system)
    result = frequency_response(system, options)
    content = response_content(result, level_summaries(result))
    statements = [one for one in content.blocks("headline") if isinstance(one, Statement) and one.id == "outside-tests"]
    (small,) = statements  # 8 m/s^2 deflect the mount by 2 to 8 mm
    assert "At 0.3 m/s² the highest motion is outside the cycles" in small.text
    assert "m1 axial ±0.455 mm (tested 2 to 8 mm)" in small.text
    assert BELOW in small.text
    assert small.tone == "unjudged"


@pytest.mark.slow
def test_command_and_report_say_it(isolator, tmp_path):
    (tmp_path / "one.xml").write_text(sdof_text(mass=20.0).replace('data="a"', 'data="a.toml"'), encoding="utf-8")
    replace(isolator, name="rig").save(tmp_path / "a.toml")
    done = wirerope("shock", "one.xml", "--half-sine", "12 g 20 ms z", "--duration", "0.3", "--out", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    flat = " ".join(done.stdout.split())
    assert "Outside the cycles that the isolator was identified from, and so extrapolated: m1 axial -" in flat
    assert "extrapolated: m1 axial" in json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))["untested"]
    assert "and so extrapolated: m1 axial" in (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    modes = wirerope("modes", "one.xml", "--amplitude-mm", "5", "20", "--out", "modes", cwd=tmp_path)
    flat = " ".join(modes.stdout.split())
    assert "20 mm is outside the cycles that isolators were identified from: m1 axial ±20 mm (tested 2 to 8 mm)" in flat
    assert "5 mm is outside" not in flat


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"amplitude": [2e-3]}, "must be 2 finite numbers, got"),
        ({"amplitude": [5e-3, 2e-3]}, "lowest and then the highest"),
        ({"amplitude": [-1e-3, 2e-3]}, "must be >= 0"),
        ({"deflection": [-1e-3, 2e-3]}, "amplitude"),
        ({"amplitude": [1e-3, 2e-3], "speed": [1.0, 2.0]}, "`speed` is unknown"),
    ],
)
def test_a_range_that_cannot_be_is_refused(table, said):
    whole = {"deflection": [-1e-3, 1e-3]} | table if "amplitude" in table else table
    with pytest.raises(ModelError, match=said):
        wr.Isolator.from_dict({"name": "a", "axial": LAW.to_dict(), "validity": {"axial": whole}})


@pytest.mark.slow
def test_three_axes_are_joined_into_one_file(tmp_path):
    parts = {"axial": 8e-3, "shear": 6e-3, "roll": 5e-3}
    for axis, largest in parts.items():
        time, deflection, force = record([0.25 * largest, largest])
        rows = [f"{t:.4f},{1e3 * x:.7g},{f:.7g}" for t, x, f in zip(time, deflection, force, strict=True)]
        (tmp_path / f"{axis}.csv").write_text("\n".join(["time [s],deflection [mm],force [N]", *rows]) + "\n")
        joined = [] if axis == "axial" else ["--join", "whole.toml", "--force"]
        done = wirerope(
            "identify", f"{axis}.csv", "--axis", axis, "--law", "bouc-wen", "--out", "whole.toml", *joined, cwd=tmp_path
        )
        assert done.returncode == 0, done.stderr
    whole = wr.load_isolator(tmp_path / "whole.toml")
    assert set(whole.validity.stated) == set(parts)
    for axis, largest in parts.items():
        law = whole.axes[axis]
        assert isinstance(law, wr.BoucWen)
        assert law.normalised.z_max == pytest.approx(LAW.normalised.z_max, rel=0.05)
        assert whole.validity.stated[axis].amplitude[1] == pytest.approx(largest, rel=1e-3)
        assert f"{axis}.csv" in whole.provenance.source


@pytest.mark.slow
def test_an_identification_says_how_well_peaks_of_shocks_are_known():
    """The band of a foreign device, that of bristles with seed 113, holds a shock within its tests."""
    import prediction_errors as foreign

    found, _ = foreign.fitted(foreign.drawn(113), 113)
    assert f"within {100.0 * OF_DEFLECTION * found.misfit:.2g} % of deflection" in found.prediction
    assert found.prediction in str(found)
    for misfit, reached, deflection, acceleration in foreign.misses(113):
        assert reached <= 1.0
        assert abs(deflection) <= OF_DEFLECTION * misfit
        assert abs(acceleration) <= OF_ACCELERATION * misfit
