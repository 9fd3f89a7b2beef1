"""Rattle space: points and corners against clearances, from the modelled place and relative to the base."""

from dataclasses import replace

import numpy as np
import pytest
from house import rotation
from made_up_floor import UPRIGHT, box, floor_response
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import rattle_verdicts
from wirerope_mj.assessment.criteria.ended import utilisation_over_time
from wirerope_mj.assessment.criteria.payload import between_points, body_corners, corner_displacements
from wirerope_mj.engine.response.histories import MemorySamples
from wirerope_mj.foundation.payload_limits import PayloadLimit, limit_from_text
from wirerope_mj.runs.scenario_file import judged_by


def by_name(verdicts):
    return {(v.subject, v.criterion): v for v in verdicts}


def clearance(name, *values):
    return PayloadLimit(kind="clearance", name=name, values=values)


@pytest.fixture(scope="module")
def floor():
    return floor_response()


@pytest.mark.quick
def test_a_point_is_judged_in_both_directions_of_every_axis(floor):
    peak = floor.peaks.points["rack_top"].relative_displacement
    found = by_name(rattle_verdicts(floor, [clearance("rack_top", 0.5, 0.0, 1.01 * peak.maximum[2])]))
    for axis, name in enumerate("xyz"):
        assert found["rack_top", f"rattle space along -{name}"].value == -peak.minimum[axis]
        assert found["rack_top", f"rattle space along +{name}"].value == peak.maximum[axis]
    assert found["rack_top", "rattle space along +x"].verdict == "within"
    assert found["rack_top", "rattle space along -y"].verdict == "not judged"
    assert found["rack_top", "rattle space along +z"].margin == pytest.approx(0.01)
    down = found["rack_top", "rattle space along -z"]
    assert down.verdict == ("within" if -peak.minimum[2] <= 1.01 * peak.maximum[2] else "exceeded")
    assert down.time == peak.minimum_time[2]


@pytest.mark.quick
def test_six_values_are_one_for_each_direction(floor):
    found = by_name(rattle_verdicts(floor, [clearance("rack_top", 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)]))
    limits = [found["rack_top", f"rattle space along {side}"].limit for side in ("-x", "+x", "-y", "+y", "-z", "+z")]
    assert limits == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]


def test_without_a_clearance_the_largest_displacement_is_stated_and_not_judged(floor):
    found = by_name(rattle_verdicts(floor))
    peak = floor.peaks.points["rack_top"].relative_displacement
    assert found["rack_top", "rattle space"].value == peak.value
    assert set(found) == {(name, "rattle space") for name in ("rack_top", "floor", "rack_0", "rack_1")}  # not the base
    assert {v.verdict for v in found.values()} == {"not judged"}


@pytest.mark.quick
def test_corners_move_with_the_body_and_its_rotation(floor):
    body = next(body for body in floor.scene.bodies if body.name == "rack_0")
    corners = body_corners(body)
    # a box of half lengths 0.2, 0.2, 0.5 and a capsule of radius 0.05 and half length 0.3 along z
    np.testing.assert_allclose(corners.max(axis=0), [0.2, 0.2, 0.5])
    np.testing.assert_allclose(corners.min(axis=0), [-0.2, -0.2, -0.5])
    assert corners.shape == (8, 3)
    moved = floor.bodies["rack_0"]
    turn = rotation(moved.orientation)
    for corner, displacement in zip(corners, corner_displacements(floor, body, corners), strict=True):
        expected = moved.position + turn @ corner - floor.base.displacement - (body.position + corner)
        np.testing.assert_allclose(displacement, expected, atol=1e-12)
    found = by_name(rattle_verdicts(floor, [clearance("rack_0", 0.05, 0.05, 0.05)]))
    side = found["rack_0", "rattle space along -z"]
    least = -min(displacement[:, 2].min() for displacement in corner_displacements(floor, body, corners))
    assert least <= side.value <= 1.001 * least  # the parabola between samples of 1 ms


@pytest.mark.quick
def test_a_tilt_moves_the_far_corner_by_its_arm():
    """At rest but for a tilt of 0.01 about y: a corner 1.5 m along x and 0.5 m up moves by (0.5, 0, -1.5) times that."""
    floor = floor_response(equipment=0, rows=50)  # nothing happens before 50 ms
    body = next(body for body in floor.scene.bodies if body.name == "floor")
    tilted = np.array([np.cos(0.005), 0.0, np.sin(0.005), 0.0])
    still = replace(body, orientation=UPRIGHT)
    values, place = floor.samples.values.copy(), floor.samples.names.index("bodies/floor/position/x")
    values[:, place : place + 7] = [*body.position, *tilted]
    turned = replace(floor, samples=MemorySamples(floor.samples.names, values))
    found = next(corner_displacements(turned, still, np.array([[1.5, 0.3, 0.5]])))
    np.testing.assert_allclose(found[0], [0.005, 0.0, -0.015], atol=1e-4)  # 1.5 times 0.01^2 / 2


@pytest.mark.quick
@pytest.mark.parametrize(
    ("shape", "size", "half"),
    [
        ("box", [0.1, 0.2, 0.3], [0.3, 0.2, 0.1]),
        ("sphere", [0.1, 0.0, 0.0], [0.1, 0.1, 0.1]),
        ("capsule", [0.1, 0.4, 0.0], [0.5, 0.1, 0.1]),
        ("cylinder", [0.1, 0.4, 0.0], [0.4, 0.1, 0.1]),
        ("ellipsoid", [0.1, 0.2, 0.3], [0.3, 0.2, 0.1]),
    ],
)
def test_every_shape_has_its_box(floor, shape, size, half):
    """Turned by 90 degrees about y, a shape's z lies along x."""
    turned = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0])
    geom = replace(box("", size, shape=shape), orientation=turned, position=np.array([1.0, 2.0, 3.0]))
    corners = body_corners(replace(floor.scene.bodies[1], geoms=(geom, box("", [9.0, 9.0, 0.1], shape="plane"))))
    np.testing.assert_allclose(corners.max(axis=0), np.add([1.0, 2.0, 3.0], half), atol=1e-12)
    np.testing.assert_allclose(corners.min(axis=0), np.subtract([1.0, 2.0, 3.0], half), atol=1e-12)


def test_a_mesh_has_the_box_of_its_vertices(floor):
    vertices = np.array([[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.1]])
    geom = replace(box("", [0.0, 0.0, 0.0], shape="mesh"), vertices=vertices, position=np.array([0.0, 0.0, 1.0]))
    corners = body_corners(replace(floor.scene.bodies[1], geoms=(geom,)))
    np.testing.assert_allclose(corners.max(axis=0), [0.4, 0.2, 1.1])
    np.testing.assert_allclose(corners.min(axis=0), [0.0, 0.0, 1.0])


@pytest.mark.quick
def test_a_clearance_of_nothing_is_an_error(floor):
    with pytest.raises(ValueError, match="'rack_9', which has no clearance here. There are: rack_top, floor, rack_0, rack_1"):
        rattle_verdicts(floor, [clearance("rack_9", 0.1, 0.1, 0.1)])


def test_a_clearance_between_two_points_is_that_of_the_turning_body_that_carries_them():
    system = wr.load_system("cabinet")
    response = wr.simulate(system, wr.HalfSine(peak=150.0, duration=0.011, direction="y", start=0.01), duration=0.15)
    name = "rack_top to rack_base_front"
    arm = np.array([-0.4, 0.0, 1.685])  # between both points as the model has them, in the axes of the rack
    turns = Rotation.from_quat(response.bodies["rack"].orientation, scalar_first=True)
    expected = turns.apply(arm) - arm
    np.testing.assert_allclose(between_points(response, name), expected, atol=1e-12)
    between = CubicSpline(response.time, expected)(np.linspace(0.0, 0.15, 20_001))  # the largest is between samples
    found = by_name(rattle_verdicts(response, [clearance(name, 1e-3, 0.02, 0.0)]))
    for axis, letter in enumerate("xyz"):
        for sign, side in ((-1.0, "-"), (1.0, "+")):
            verdict = found[name, f"rattle space along {side}{letter}"]
            assert verdict.value == pytest.approx(max((sign * between[:, axis]).max(), 0.0), rel=5e-3)  # parabolas
    sideways = found[name, "rattle space along -y"]
    used = utilisation_over_time(response, sideways)
    np.testing.assert_allclose(used, np.maximum(-expected[:, 1], 0.0) / 0.02, atol=1e-9)
    assert found[name, "rattle space along +z"].verdict == "not judged"


def test_a_clearance_between_points_that_are_not_there_is_an_error():
    text = "clearance/rack_top to {} = 10 10 0 mm"
    system = wr.load_system("cabinet")
    for other in ("nothing", "rack_top", "rack"):
        limit = limit_from_text(text.format(other))
        with pytest.raises(wr.ModelError, match="no body of the payload and no point"):
            judged_by(system, combined_travel=True, limits=[limit])
    assert judged_by(system, combined_travel=True, limits=[limit_from_text(text.format("rack_base_front"))]).limits[
        -1
    ].values == (0.01, 0.01, 0.0)
