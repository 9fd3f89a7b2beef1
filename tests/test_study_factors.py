"""Factors on a whole mount: its stiffness and its damping as one number of a study."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError

PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01)


def study(**arguments):
    return wr.Study(model="cabinet.xml", motion=PULSE, duration=0.08, timestep=5e-4, sampling="list", **arguments)


@pytest.mark.parametrize(("name", "change"), [("stiffness", "scaled"), ("damping", "with_damping")])
def test_a_factor_on_a_mount_is_what_the_isolator_makes_of_it(tmp_path, name, change):
    factors = [0.5, 1.0, 2.0]
    result = study(vary={f"mount/m0*/{name}": wr.Choice(*factors)}).run(tmp_path / "study")
    system = wr.load_system("cabinet")
    for factor, forces in zip(factors, result.table["force/m01"].to_pylist(), strict=True):
        isolators = {
            mount: getattr(one.isolator, change)(factor)
            for mount, one in system.mounts.items()
            if mount.startswith("m0")
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
