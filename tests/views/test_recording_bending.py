"""What bends, in recordings and plans: its net follows its modes, and a rigid one has none."""

import math

import numpy as np
import pytest
from house import deck, hysteresis, mjcf
from recordings import entities

import wirerope_mj as wr
from wirerope_mj.content.blocks import SceneView
from wirerope_mj.content.scene_outline import flexible_bodies
from wirerope_mj.engine.flexible import Panel
from wirerope_mj.views.plots.scene_svg import scene_svgs
from wirerope_mj.views.recording.shapes import bending_at

# a deck of one mode is held against the panel of that mass
pytestmark = pytest.mark.filterwarnings("ignore:the modes of the deck")

FEET = [(x, y) for x in (-0.3, 0.3) for y in (-0.2, 0.2)]
PULSE = wr.HalfSine(peak=5.0, duration=0.011, direction="z", start=0.02)
PANEL = Panel(frequency=10.0, mass=40.0, damping=0.04)


@pytest.fixture(scope="module")
def rigid():
    """Return a plate on four mounts that carry along one axis, on a rigid deck."""
    world = deck({f"b{n}": f'pos="{x} {y} .2"' for n, (x, y) in enumerate(FEET)}, slides="z")
    own = "".join(f'<site name="p{n}" pos="{x} {y} -.1"/>' for n, (x, y) in enumerate(FEET))
    joint = '<joint name="up" type="slide" axis="0 0 1"/>'
    world += f'<body name="plate" pos="0 0 .3">{joint}<geom size=".1" mass="15"/>{own}</body>'
    text = mjcf(world, [(f"m{n}", f"p{n}", f"b{n}", "a") for n in range(4)], gravity=9.80665)
    law = wr.BoucWen(**hysteresis(alpha=2e4, z_max=40.0), k=4e3)
    return wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=law)})


def run(system):
    return wr.simulate(system, PULSE, duration=0.2, timestep=1e-4)


def test_the_net_goes_where_a_panel_of_the_same_mass_goes_and_is_drawn(rigid, tmp_path):
    part = wr.FlexiblePart(
        frequencies=[PANEL.frequency], damping=PANEL.damping, participation=[[0.0, 0.0, math.sqrt(PANEL.mass)]],
        shapes={f"b{n}": [[0.0, 0.0, PANEL.mass**-0.5]] for n in range(4)},
        points={f"b{n}": (x, y, 0.2) for n, (x, y) in enumerate(FEET)},
    )  # fmt: skip
    bent, panel = run(wr.on_deck(rigid, part)), run(wr.on_deck(rigid, PANEL))
    below = bending_at(bent, bent.scene.mounts[2], "deck", np.arange(bent.time.size))
    moved = panel.bodies["deck_panel"].position - panel.bodies["deck"].position
    # the panel's own weight is carried as drawn, and both are of one step
    np.testing.assert_allclose(below[:, 2], (moved - moved[0])[:, 2] + below[0, 2], atol=1e-9)
    assert float(np.ptp(below[:, 2])) > 1e-5
    nets = [name for name in entities(wr.record_rerun(bent, tmp_path / "bent.rrd")) if name.endswith("/bending")]
    assert {name.split("/")[1] for name in nets} == {"world", "ghosts"}
    still = run(rigid)
    assert not bending_at(still, still.scene.mounts[0], "deck", np.arange(still.time.size)).any()
    assert not [name for name in entities(wr.record_rerun(still, tmp_path / "still.rrd")) if "bending" in name]


def test_equipment_that_bends_has_a_net_through_the_tops_of_its_mounts_and_is_outlined_in_plans(rigid, tmp_path):
    heights = (0.1, 0.3, 0.1, 0.3)
    part = wr.FlexiblePart(
        frequencies=[14.0], damping=0.02, shapes={f"p{n}": [[0.0, 0.0, height]] for n, height in enumerate(heights)},
        points={f"p{n}": (x, y, -0.1) for n, (x, y) in enumerate(FEET)},
    )  # fmt: skip
    bent = run(wr.with_flexible(rigid, part, body="plate"))
    rows = np.arange(bent.time.size)
    tops = np.array([bending_at(bent, mount, "plate", rows)[:, 2] for mount in bent.scene.mounts])
    assert float(np.ptp(tops[0])) > 1e-5
    # every top by the one coordinate of the mode times its own shape
    np.testing.assert_allclose(tops / np.array(heights)[:, np.newaxis], np.tile(tops[1] / heights[1], (4, 1)), atol=1e-12)
    assert not bending_at(bent, bent.scene.mounts[0], "deck", rows).any()
    nets = [name for name in entities(wr.record_rerun(bent, tmp_path / "bent.rrd")) if name.endswith("/bending")]
    assert {name.split("/")[1] for name in nets} == {"world", "ghosts"}
    assert all("plate" in name for name in nets)
    for scene, named in ((bent.scene, ["plate"]), (run(rigid).scene, [])):
        assert flexible_bodies(scene) == named
        plan = scene_svgs(SceneView(scene=scene, caption=""))[0]
        assert plan.count('stroke-width="1.6"') == len(named)
    assert flexible_bodies(run(wr.on_deck(rigid, PANEL)).scene) == ["deck_panel"]
