"""The recording of branches: its rows stand on all three timelines, and what is drawn is what was computed."""

import subprocess

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.content.response_curve import response_content
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import level_summaries
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.views.recording.animation import FREQUENCY, MOST_POINTS, ROWS, animation_of, strips_of
from wirerope_mj.views.recording.frequencies import record_branches
from wirerope_mj.views.recording.ghosts import enlarged, factor_of
from wirerope_mj.views.recording.paths import POINT, TIMELINE
from wirerope_mj.views.recording.program import viewer_binary
from wirerope_mj.views.recording.viewer import openings_of


@pytest.fixture(scope="module")
def result():
    system = wr.load_system(models_folder() / "sdof_shaker.xml")
    options = ResponseOptions(accelerations=(2.0, 5.0), start=34.0, stop=40.0, largest_step=0.04)
    return frequency_response(system, options, name="shaker")


@pytest.fixture(scope="module")
def findings(result):
    return level_summaries(result)


@pytest.fixture(scope="module")
def recording(result, findings, tmp_path_factory):
    return record_branches(result, findings, response_content(result, findings), tmp_path_factory.mktemp("branch"))


@pytest.fixture(scope="module")
def animation(findings):
    return animation_of(strips_of(findings)[-1])


@pytest.fixture(scope="module")
def chunks(recording):
    from rerun.chunk import RrdReader

    found = {}
    for chunk in RrdReader(str(recording)).stream():
        found.setdefault(str(chunk.entity_path), []).append((chunk.is_static, chunk.to_record_batch()))
    return found


def rows_of(chunks, path, name):
    """Return the index columns and a component of an entity, in the order of the points."""
    (batch,) = [batch for static, batch in chunks[path] if not static and name in batch.schema.names]
    columns = [batch[line].cast("int64").to_numpy() for line in (POINT, FREQUENCY, TIMELINE)]
    return *columns, batch[name]


def test_the_file_is_whole_and_small(recording):
    assert recording.name == "run.rrd"
    verified = subprocess.run([viewer_binary(), "rrd", "verify", recording], capture_output=True, text=True)
    assert verified.returncode == 0, verified.stderr
    assert recording.stat().st_size < 2e6
    assert [path.name for path in recording.parent.iterdir()] == ["run.rrd"]


def test_the_viewer_opens_at_the_resonance_of_the_highest_level(recording, animation):
    (opening,) = openings_of(recording)
    assert opening.timeline == POINT
    assert animation.strip.amplitude[int(opening.at)] == animation.strip.amplitude.max()


def test_each_level_stands_on_its_curve_at_its_frequency(chunks, findings):
    for number, strip in enumerate(strips_of(findings)):
        path = f"/response/data/here/level_{number + 1}"
        point, frequency, time, positions = rows_of(chunks, path, "Points2D:positions")
        np.testing.assert_array_equal(point, np.arange(MOST_POINTS))
        np.testing.assert_array_equal(frequency, np.round(1e3 * strip.frequency))
        assert (np.diff(time) > 0).all()
        drawn = positions.flatten().flatten().to_numpy().reshape(-1, 2)
        # Positions are kept as float32: 1e-6 of a decade.
        np.testing.assert_allclose(drawn, np.log10(np.column_stack([strip.frequency, strip.amplitude])), atol=1e-6)


def test_the_curves_of_the_levels_have_their_names_beside_them(chunks, findings):
    ((static, batch),) = chunks["/response/data/here/names"]
    assert static
    assert batch["Points2D:labels"][0].as_py() == ["2 m/s²", "5 m/s²"]
    assert len(batch["Points2D:positions"][0]) == len(findings)


def test_the_points_go_once_along_the_branch_and_hold_its_highest(findings):
    for strip in strips_of(findings):
        assert strip.points[0] == 0
        assert strip.points[-1] == strip.branch.frequency.size - 1
        assert (np.diff(strip.points) >= 0).all()
        assert strip.branch.peak in strip.points


def test_loops_are_those_of_the_motions(chunks, findings):
    strip = strips_of(findings)[0]
    *_, loops = rows_of(chunks, "/loops/axial/m1/data/level_1", "LineStrips2D:strips")
    for index in (0, 30, MOST_POINTS - 1):
        mount = strip.orbits[index].response.mounts["m1"]
        drawn = loops[index].values.flatten().flatten().to_numpy().reshape(-1, 2)
        np.testing.assert_allclose(drawn[:, 0], 1e3 * mount.deflection[:, 2], atol=1e-6)
        np.testing.assert_allclose(drawn[:, 1], 1e-3 * mount.force[:, 2], atol=1e-6)


def test_portraits_are_deflections_and_the_velocity_of_the_mass_over_its_base(chunks, findings):
    strip = strips_of(findings)[1]
    *_, portraits = rows_of(chunks, "/portrait/data/level_2", "LineStrips2D:strips")
    for index in (0, 30, MOST_POINTS - 1):
        response = strip.orbits[index].response
        drawn = portraits[index].values.flatten().flatten().to_numpy().reshape(-1, 2)
        rate = response.bodies["mass"].velocity[:, 2] - response.base.velocity[:, 2]
        for filled, values in zip(drawn.T, (response.mounts["m1"].deflection[:, 2], rate), strict=True):
            # A periodic spline's rate at its knots is off by (2 pi k / 128)^4 / 180 of the harmonic k, 1e-8 to 1e-6 here.
            middle = 0.5 * (values.max() + values.min())
            np.testing.assert_allclose(filled, 2.0 * (values - middle) / np.ptp(values), atol=1e-5)


def test_the_report_shows_portraits_of_the_motions_whose_loops_it_shows(result, findings):
    charts = {block.id: block for block in response_content(result, findings).blocks("full") if hasattr(block, "rows")}
    loops, portraits = (charts[name].rows[0] for name in ("orbit-loops", "orbit-portraits"))
    for loop, portrait in zip(loops, portraits, strict=True):
        assert [curve.name for curve in loop.curves] == [curve.name for curve in portrait.curves]
        assert {(curve.x[0], curve.y[0]) for curve in portrait.curves} == set(portrait.dots)
        for a, b in zip(loop.curves, portrait.curves, strict=True):
            np.testing.assert_array_equal(a.x, b.x)
            turning = b.y[[a.x.argmin(), a.x.argmax()]]
            # The samples are at most half a step beside the reversal: sin(pi / 128) / 2 of the range, and harmonics.
            assert np.abs(turning).max() < 0.02 * np.ptp(b.y)


def test_the_animation_plays_one_period_of_each_motion_up_to_its_largest_acceleration(animation):
    strip, response = animation.strip, animation.response
    assert response.time.size == ROWS * MOST_POINTS
    assert (np.diff(response.time) > 0).all()
    np.testing.assert_allclose(np.diff(animation.starts), 1.0 / strip.frequency[:-1], rtol=1e-12)
    last = ROWS * np.arange(1, MOST_POINTS + 1) - 1
    reached = np.abs(response.bodies["mass"].acceleration[last, 2])
    # The largest of the steps; the amplitude is that of the parabola through three of them.
    np.testing.assert_allclose(reached, strip.amplitude, rtol=2e-3)


def test_rows_in_time_stand_at_the_point_of_their_motion(chunks, animation):
    cursors = rows_of(chunks, "/loops/axial/m1/data/cursor", "Points2D:positions")
    point, frequency, time, _ = cursors
    np.testing.assert_array_equal(point, np.repeat(np.arange(MOST_POINTS), ROWS))
    np.testing.assert_array_equal(frequency, np.round(1e3 * animation.strip.frequency)[point])
    np.testing.assert_array_equal(time, np.round(1e9 * animation.response.time))


def test_motions_are_drawn_larger_about_their_mean_and_mounts_still_reach_the_bodies(animation):
    response = animation.response
    factor = factor_of(response, extent=0.5)
    assert factor > 1.0
    large = enlarged(response, factor)
    apart = [r.bodies["mass"].position[:, 2] - r.bodies["table"].position[:, 2] for r in (response, large)]
    assert np.ptp(apart[1]) == pytest.approx(factor * np.ptp(apart[0]), rel=1e-9)
    shift = apart[1] - large.mounts["m1"].deflection[:, 2]
    assert np.ptp(shift) < 1e-12 * factor + 1e-9  # rounding of the deflection that the engine measures
    np.testing.assert_array_equal(large.mounts["m1"].force, response.mounts["m1"].force)


def test_the_text_says_amplitude_stability_and_multipliers(chunks, animation):
    *_, texts = rows_of(chunks, "/motion", "TextDocument:text")
    text = texts[30][0].as_py()
    assert "5 m/s²: stable" in text
    assert f"Amplitude {animation.strip.amplitude[30]:.4g} m/s²" in text
    assert "Floquet multiplier" in text
    assert "Mount m1, axial:" in text
    *_, labels = rows_of(chunks, "/response/data/here/level_1", "Points2D:labels")
    assert labels[30][0].as_py().startswith("2 m/s²: ")


def test_curves_and_tables_are_those_of_the_content(chunks, result, findings):
    content = response_content(result, findings)
    (chart,) = [block for block in content.blocks("headline") if getattr(block, "id", "") == "amplitude"]
    curve = next(curve for curve in chart.rows[0][0].curves if curve.name == "5 m/s²")
    ((static, batch),) = chunks["/response/data/5\\ m\\/s²"]
    assert static
    drawn = batch["LineStrips2D:strips"][0].values.flatten().flatten().to_numpy().reshape(-1, 2)
    np.testing.assert_allclose(10.0**drawn, np.column_stack([curve.x, curve.y]), rtol=1e-5)  # float32
    ((_, about),) = chunks["/about"]
    text = about["TextDocument:text"][0][0].as_py()
    for level, _, frequency, *_ in content.table("peaks").rows:
        assert f"| {level:.4g} | resonance peak | {frequency:.5g} |" in text


def test_sweeps_alone_are_no_branches_to_record(result, findings, tmp_path):
    empty = type(result)(system=result.system, name="", options=result.options, levels=())
    with pytest.raises(ValueError, match="there is no branch to record"):
        record_branches(empty, [], response_content(result, findings), tmp_path)
    assert not list(tmp_path.iterdir())
