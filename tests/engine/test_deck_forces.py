"""Loads on the deck: sums over areas against Newton's law, loads of bolts against a rigid plate's, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from house import deck, mjcf

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.loads import area_forces, bolt_loads, foundation_force
from wirerope_mj.engine.response import load_response
from wirerope_mj.foundation.errors import ModelError

G = wr.STANDARD_GRAVITY
PLACES = {"a": (-0.4, -0.3), "b": (0.4, -0.3), "c": (-0.4, 0.3), "d": (0.4, 0.3)}
AREAS = '<custom><text name="area/left" data="a c"/><text name="area/right" data="[bd]"/></custom>'
SHOCK = wr.HalfSine(peak=8.0 * G, duration=0.011, direction=(0.6, 0.0, 0.8), start=0.02)


def plate(areas=AREAS, **geometry):
    """Return 200 kg on four mounts at the corners of a rectangle."""
    sites = {name: f'pos="{x} {y} .1"' for name, (x, y) in PLACES.items()}
    world = deck(sites)
    payload = "".join(f'<site name="p{name}" pos="{x} {y} -.1"/>' for name, (x, y) in PLACES.items())
    world += (
        '<body name="plate" pos="0 0 .2"><freejoint/><geom type="box" size=".5 .4 .05" mass="200" contype="0" '
        f'conaffinity="0"/>{payload}</body>'
    )
    law = wr.KelvinVoigt(k=8e4, c=800.0)
    isolator = wr.Isolator(name="i", roll=law, shear=law, axial=law, geometry=wr.Geometry(height=0.12, **geometry))
    text = mjcf(world, [(name, f"p{name}", name, "i") for name in PLACES], gravity=G, other=areas)
    return wr.load_system(text, isolators={"i": isolator})


@pytest.fixture(scope="module")
def response():
    system = plate(bolts=4, bolts_along_roll=0.09, bolts_along_shear=0.05)
    return wr.simulate(system, SHOCK, duration=0.3, timestep=5e-4)


def test_the_areas_together_bear_what_newton_says(response):
    whole, left, right = area_forces(response)
    assert [(one.name, one.mounts) for one in (whole, left, right)] == [("", 4), ("left", 2), ("right", 2)]
    accelerated = 200.0 * (response.bodies["plate"].acceleration + [0.0, 0.0, G])
    total = foundation_force(response)
    np.testing.assert_allclose(total, -accelerated, rtol=0.0, atol=1e-9 * np.abs(accelerated).max())
    parts = foundation_force(response, ["a", "c"]) + foundation_force(response, ["b", "d"])
    np.testing.assert_allclose(parts, total, rtol=0.0, atol=1e-9 * np.abs(total).max())
    assert whole.at_rest == pytest.approx(200.0 * G, rel=1e-9)
    assert left.at_rest == pytest.approx(100.0 * G, rel=1e-9)
    assert whole.down == pytest.approx(accelerated[:, 2].max(), rel=1e-9)
    assert whole.across == pytest.approx(np.abs(accelerated[:, 0]).max(), rel=1e-9)
    assert left.down > 0.5 * whole.down  # the force across tilts the plate


def test_loads_of_bolts_are_those_of_a_rigid_plate(response):
    loads = {load.mount: load for load in bolt_loads(response)}
    assert list(loads) == sorted(loads, key=lambda name: -loads[name].tension)
    places = np.array([(x, y) for x in (-0.045, 0.045) for y in (-0.025, 0.025)])
    for name, load in loads.items():
        force = response.mounts[name].force
        moments = 0.06 * force[:, :2]  # of the forces across, about the plate
        tension = force[:, 2:] / 4.0 + (moments[:, :1] * places[:, 0]) / (places[:, 0] ** 2).sum()
        tension = tension + (moments[:, 1:] * places[:, 1]) / (places[:, 1] ** 2).sum()
        assert load.bolts == 4
        assert load.tension == pytest.approx(max(tension.max(), 0.0), rel=1e-12)
        assert load.shear == pytest.approx(np.hypot(force[:, 0], force[:, 1]).max() / 4.0, rel=1e-12)


def test_both_come_back_from_the_file_and_stand_in_the_report(response, tmp_path):
    response.save(tmp_path)
    again = load_response(tmp_path)
    assert area_forces(again) == area_forces(response)
    assert bolt_loads(again) == bolt_loads(response)
    assert bolt_loads(replace(again, scene=replace(again.scene, mounts=()))) == []


def test_an_isolator_without_bolts_has_no_loads_of_bolts():
    response = wr.simulate(plate(""), SHOCK, duration=0.05, timestep=5e-4)
    assert bolt_loads(response) == []
    assert [one.name for one in area_forces(response)] == [""]


@pytest.mark.parametrize(
    ("areas", "said"),
    [
        (
            '<custom><text name="area/x" data="a e"/></custom>',
            "text 'area/x': there is no mount 'e'. There are a, b, c, d.",
        ),
        (
            '<custom><text name="area/x" data="a b"/><text name="area/y" data="b"/></custom>',
            "text 'area/y': mount 'b' stands on area 'x' already.",
        ),
    ],
)
def test_areas_that_cannot_be_are_said(areas, said):
    with pytest.raises(ModelError) as caught:
        plate(areas)
    assert str(caught.value) == said


@pytest.mark.parametrize(
    ("geometry", "said"),
    [
        ({"bolts": 3}, "`bolts` must be 1, 2 .in a line. or 4 .in a rectangle., got 3"),
        ({"bolts_along_roll": 0.1}, "need `bolts`, their number"),
        ({"bolts": 4, "bolts_along_shear": 50.0}, r"must be .* <= 2 \[m\], got 50\.0\. If these are millimetres, write 0\.05"),
    ],
)
def test_bolts_that_cannot_be_are_said(geometry, said):
    with pytest.raises(ValueError, match=said):
        wr.Geometry(**geometry)
