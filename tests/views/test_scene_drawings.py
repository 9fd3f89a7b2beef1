"""The scene as a drawing: what stands where, at rest and at the worst instant of a run."""

import re
from dataclasses import replace
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from finished_runs import finished_of

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.verdict import against_limit
from wirerope_mj.content.blocks import SceneView
from wirerope_mj.content.scene_outline import View, drawn_scene, worst_instant
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.views.plots.scene_svg import scene_svgs

SVG = "{http://www.w3.org/2000/svg}"
ELEVATION = 1


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Return a short run of one mount that travels too far."""
    folder = tmp_path_factory.mktemp("runs") / "table"
    wr.run_scenario(load_scenario("shock_table").make(duration=0.15, level_g=60.0), folder)
    return finished_of(folder)


def polygons(svg: str, *, pale: bool) -> np.ndarray:
    """Return the mean corner of every outline, (n, 2)."""
    (group,) = [
        one
        for one in ElementTree.fromstring(svg).iter(f"{SVG}g")
        if one.get("stroke-width") and (one.get("fill") == "none") == pale
    ]
    points = [np.array([pair.split(",") for pair in one.get("points").split()], dtype=float) for one in group]
    return np.array([corners.mean(axis=0) for corners in points])


def upward_scale(svg: str) -> float:
    """Return the units of a drawing to the metre along its upward axis, read from its ticks."""
    ticks = [
        one
        for one in ElementTree.fromstring(svg).iter(f"{SVG}text")
        if one.get("text-anchor") == "end" and one.get("x") == "-5"
    ]
    heights = [float(one.get("y")) for one in ticks]
    values = [float(one.text.replace("\N{MINUS SIGN}", "-")) for one in ticks]
    return -float(np.polyfit(values, heights, 1)[0])


def test_what_moved_stands_as_much_higher_as_it_moved(finished):
    scene = finished.response.scene
    up = np.array([0.0, 0.0, 0.02])
    moved = replace(
        scene,
        bodies=tuple(replace(one, position=one.position + up) if one.name == "block" else one for one in scene.bodies),
    )
    ring = ("block", moved.bodies[-1].position)
    svg = scene_svgs(SceneView(scene=scene, caption="", moved=moved, ring=ring, exceeded=True))[ELEVATION]
    risen = np.sort(polygons(svg, pale=True)[:, 1])[:1] - np.sort(polygons(svg, pale=False)[:, 1])[:1]
    assert risen == pytest.approx([0.02 * upward_scale(svg)], abs=0.2)  # corners are rounded to a tenth


def test_the_worst_instant_is_that_of_the_worst_verdict(finished):
    drawing = worst_instant(finished)
    worst = max((row for row in finished.verdicts if row.limit), key=lambda row: row.value / row.limit)
    assert f": {against_limit(worst)}. " in drawing.caption
    assert len(scene_svgs(drawing)) == 2


def test_displacements_in_the_picture_are_those_of_the_response_times_the_factor(finished):
    drawing = worst_instant(finished)
    factor = float(re.search(r"displacements (\d+) times", drawing.caption)[1]) if "times as large" in drawing.caption else 1.0
    instant = float(re.search(r" at ([\d.]+) ms", drawing.caption)[1]) / 1e3
    response = finished.response
    number = int(np.abs(response.time - instant).argmin())
    block = next(one for one in response.scene.bodies if one.name == "block")
    rise = factor * (response.bodies["block"].position[number] - response.base.displacement[number] - block.position)[2]
    svg = scene_svgs(drawing)[ELEVATION]
    drawn = np.sort(polygons(svg, pale=True)[:, 1])[:1] - np.sort(polygons(svg, pale=False)[:, 1])[:1]
    assert drawn == pytest.approx([rise * upward_scale(svg)], abs=0.2)


def test_a_run_that_does_not_move_has_no_such_picture(finished):
    response = finished.response
    bodies = {
        one.name: SimpleNamespace(
            position=one.position + response.base.displacement, orientation=response.bodies[one.name].orientation
        )
        for one in response.scene.bodies
        if one.name in response.bodies
    }
    still = SimpleNamespace(
        scene=response.scene, time=response.time, base=response.base, bodies=bodies,
        displacement_from_base=lambda position, modelled: position - modelled - response.base.displacement,
    )  # fmt: skip
    assert worst_instant(replace(finished, response=still)) is None


def test_every_mount_is_marked_in_both_views_and_its_isolator_in_the_key(finished):
    plan, elevation, key = scene_svgs(SceneView(scene=finished.response.scene, caption=""))
    for svg in (plan, elevation):
        marks = [one for one in ElementTree.fromstring(svg).iter(f"{SVG}path") if one.get("transform")]
        assert len(marks) == len(finished.response.scene.mounts)
    assert finished.response.scene.mounts[0].isolator in key


def test_the_view_that_shows_the_longer_extent_is_the_elevation(finished):
    drawn = drawn_scene(finished.response.scene)
    assert all(isinstance(view, View) for view in drawn.views)
    across = drawn.high - drawn.low
    assert drawn.views[ELEVATION].right == int(across[1] > across[0])
