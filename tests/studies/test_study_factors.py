"""Factors on a whole mount: its stiffness and its damping as one number of a study."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.vendor_parts import find_isolator

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01)


def study(**arguments):
    return wr.Study(model="cabinet.xml", motion=PULSE, duration=0.08, timestep=5e-4, sampling="list", **arguments)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "change"), [("stiffness", "scaled"), ("damping", "with_damping"), ("friction", "with_friction")]
)
def test_a_factor_on_a_mount_is_what_the_isolator_makes_of_it(tmp_path, name, change):
    factors = [0.5, 1.0, 2.0]
    result = study(vary={f"mount/m0*/{name}": wr.Choice(*factors)}).run(tmp_path / "study", workers=1)
    system = wr.load_system("cabinet")
    for factor, forces in zip(factors, result.table["force/m01"].to_pylist(), strict=True):
        isolators = {
            mount: getattr(one.isolator, change)(factor) for mount, one in system.mounts.items() if mount.startswith("m0")
        }
        alone = wr.simulate(wr.varied(system, isolators=isolators), PULSE, duration=0.08, timestep=5e-4)
        assert forces == pytest.approx(alone.peaks.mounts["m01"].force.value, rel=1e-9)
    assert len(set(result.table["force/m01"].to_pylist())) == 3


def test_each_mount_may_have_its_own(tmp_path):
    one = wr.Normal(1.0, 0.1, each=True)
    drawn = wr.Study(
        model="cabinet.xml", motion=PULSE, duration=0.02, timestep=5e-4, vary={"mount/m0*/stiffness": one}, variants=4
    )
    columns = [name for name in drawn.table().column_names if name.endswith("/stiffness")]
    assert columns == [f"mount/m0{n}/stiffness" for n in range(1, 7)]
    assert len(np.unique(drawn.table()[columns[0]])) == 4


@pytest.mark.parametrize("value", [0.0, -1.0])
def test_a_mount_without_stiffness_is_refused(value):
    with pytest.raises(ModelError, match="`factor` must be > 0"):
        study(vary={"mount/m01/stiffness": wr.Choice(1.0, value)}).table()


@pytest.mark.slow
def test_isolators_are_chosen_by_name(tmp_path):
    names = ["enidine_wr16_400", "enidine_wr16_700"]
    result = wr.Study(
        model="floating_floor.xml", motion=PULSE, duration=0.05, timestep=5e-4, sampling="grid",
        vary={"mount/m01/isolator": wr.Choice(*names)},
    ).run(tmp_path / "study", workers=1)  # fmt: skip
    system = wr.load_system("floating_floor")
    for name, force in zip(result.table["mount/m01/isolator"].to_pylist(), result.table["force/m01"].to_pylist(), strict=True):
        device = wr.load_isolator(find_isolator(name))
        rise = 0.5 * (system.mounts["m01"].written.geometry.height - device.geometry.height)  # m01 stands upright
        variant = wr.varied(system, isolators={"m01": device}, positions={"m01": [0.0, 0.0, rise]} if rise else None)
        alone = wr.simulate(variant, PULSE, duration=0.05, timestep=5e-4)
        assert force == pytest.approx(alone.peaks.mounts["m01"].force.value, rel=1e-9)
    assert result.table["mount/m01/isolator"].to_pylist() == names


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        ({"mount/m01/isolator": wr.Choice("nothing_like_it")}, "there is no isolator 'nothing_like_it'"),
        ({"mount/m01/isolator": wr.Choice(1.0, 2.0)}, "must be a Choice of isolators' names"),
        (
            {"mount/m01/isolator": wr.Choice("enidine_wr16_700"), "mount/m01/axial/alpha": wr.Choice(1.1)},
            "its isolator varies, and so do parameters",
        ),
    ],
)
def test_an_isolator_that_cannot_be_chosen_is_named(vary, said):
    with pytest.raises((ValueError, ModelError), match=said):
        wr.Study(model="floating_floor.xml", motion=PULSE, duration=0.05, timestep=5e-4, sampling="list", vary=vary).table()


def test_any_part_of_the_catalogue_is_chosen_by_a_pattern_and_the_foundation_follows_its_height():
    """The payload's bar stays: mid-height moves down by half of what a part is higher, on a mount that stands upright."""
    made = wr.Study(
        model="floating_floor.xml", motion=PULSE, duration=0.05, timestep=5e-4, sampling="grid",
        vary={"mount/m01/isolator": wr.Choice("CB1[57]*", "WR12-400")},
    )  # fmt: skip
    names = made.table()["mount/m01/isolator"].to_pylist()
    assert names[-1] == "WR12-400"
    assert {name[:4] for name in names[:-1]} == {"CB15", "CB17"}
    drawn = made.base.mounts["m01"]
    for number, name in enumerate(names):
        mount = made.system(number).mounts["m01"]
        assert mount.written == wr.load_isolator(name)
        tops = [one.position[2] + 0.5 * one.written.geometry.height for one in (drawn, mount)]
        assert tops[1] == pytest.approx(tops[0], abs=1e-12)
    with pytest.raises(ValueError, match="no part of the vendors' tables is called 'XY"):
        wr.Study(model="floating_floor.xml", motion=PULSE, duration=0.05, vary={"mount/m01/isolator": wr.Choice("XY*")})


@pytest.mark.parametrize("factor", ["friction", "damping"])
def test_friction_and_damping_are_factors_of_mounts_that_have_some(factor):
    names = study(vary={f"mount/m0*/{factor}": wr.Choice(0.5, 2.0)}).table().column_names
    assert names == ["variant", f"mount/m0*/{factor}"]
    with pytest.raises(ModelError, match=f"{factor}' is a factor on what dissipates.* has such a part that stands by itself"):
        wr.Study(
            model="shock_table.xml",
            motion=PULSE,
            duration=0.08,
            sampling="list",
            vary={f"mount/s1/{factor}": wr.Choice(0.5, 2.0)},
        ).table()
