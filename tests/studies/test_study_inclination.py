"""Inclinations that scatter, and draws that several quantities share."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.studies.vary.vary_option import read_vary

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="y", start=0.01)


def study(vary, **arguments):
    settings = {"sampling": "list"} | arguments
    return wr.Study(model="cabinet.xml", motion=PULSE, duration=0.06, timestep=5e-4, vary=vary, **settings)


def written(turn):
    """Return the cabinet as its file would have it with the axes of m01 turned about x [°]."""
    spec = wr.load_system("cabinet").path.read_text()
    for site in ('site name="deck/m01"', 'site name="rack/m01"'):
        assert spec.count(f"<{site}") == 1
        spec = spec.replace(f"<{site}", f'<{site} euler="{turn} 0 0"')
    return wr.load_system(spec)


@pytest.mark.slow
def test_a_turned_mount_is_that_of_a_model_written_so(tmp_path):
    angles = [-20.0, 0.0, 35.0]
    result = study({"mount/m01/turn/x": wr.Choice(*angles)}).run(tmp_path / "study", workers=1)
    forces = result.table["force/m01"].to_pylist()
    for angle, force in zip(angles, forces, strict=True):
        alone = wr.simulate(written(angle), PULSE, duration=0.06, timestep=5e-4)
        assert force == pytest.approx(alone.peaks.mounts["m01"].force.value, rel=1e-9)
    assert len(set(forces)) == 3


def test_turns_about_several_axes_are_one_rotation():
    system = wr.load_system("cabinet")
    turned = wr.varied(system, turns={"m01": np.radians([10.0, 20.0, 30.0])})
    angle = np.radians(np.linalg.norm([10.0, 20.0, 30.0]))
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    quaternion = [np.cos(angle / 2.0), *(np.sin(angle / 2.0) * axis)]
    for site in (system.mounts["m01"].base_site, system.mounts["m01"].payload_site):
        assert turned.model.site(site).quat == pytest.approx(quaternion, abs=1e-12)
        assert turned.model.site(site).pos == pytest.approx(system.model.site(site).pos, abs=0.0)


def test_a_turned_variant_is_made_again_from_its_changes():
    variant = wr.varied(wr.load_system("cabinet"), turns={"m01": [0.1, 0.0, 0.2]})
    again = [type(one).from_dict(one.to_dict()) for one in variant.changes]
    assert [one.turns for one in again] == [{"m01": (0.1, 0.0, 0.2)}]
    with pytest.raises(ValueError, match=r"`turns\['m01'\]` must be 3 finite numbers \[rad\]"):
        wr.varied(wr.load_system("cabinet"), turns={"m01": [0.1]})


@pytest.mark.slow
def test_names_share_a_draw(tmp_path):
    vary = read_vary(["mount/m0*/stiffness & body/rack/mass = Normal(1, 0.1, relative)"])
    drawn = study(vary, sampling="sobol", variants=8)
    (column,) = [name for name in drawn.table().column_names if name != "variant"]
    factors = drawn.table()[column].to_pylist()
    mass = wr.load_system("cabinet").model.body("rack").mass[0]
    for number, factor in enumerate(factors):
        variant = drawn.system(number)
        assert variant.model.body("rack").mass[0] == pytest.approx(factor * mass, rel=1e-15)
        nominal = drawn.base.mounts["m01"].isolator.axial.initial_stiffness
        assert variant.mounts["m01"].isolator.axial.initial_stiffness == pytest.approx(factor * nominal, rel=1e-12)
        assert variant.mounts["s1"].isolator == drawn.base.mounts["s1"].isolator
    result = drawn.run(tmp_path / "study", workers=1)
    assert result.table[column].to_pylist() == factors
    assert not result.failed


def test_each_mount_has_one_draw_for_several_of_its_numbers():
    pair = {"mount/m0*/axial/alpha & mount/m0*/axial/k1": wr.Normal(1.0, 0.1, relative=True, each=True)}
    drawn = study(pair, sampling="sobol", variants=4)
    names = [f"mount/m0{n}/axial/alpha & mount/m0{n}/axial/k1" for n in range(1, 7)]
    assert drawn.table().column_names == ["variant", *names]
    law, nominal = drawn.system(3).mounts["m02"].isolator.axial, drawn.base.mounts["m02"].isolator.axial
    one, other = law.laws[0], nominal.laws[0]
    assert one.alpha / other.alpha == pytest.approx(one.k1 / other.k1, rel=1e-15)
    assert one.alpha != other.alpha


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ("mount/m01/stiffness & motion/level", "only numbers of mounts and bodies can share a draw"),
        ("mount/m01/axial/alpha & mount/m01/turn/x", "of one kind, got value SI, shift °"),
        ("mount/m01/stiffness & mount/m99/stiffness", "there is no mount 'm99'"),
    ],
)
def test_names_that_cannot_share_a_draw_say_why(names, words):
    with pytest.raises((ValueError, ModelError), match=words):
        study({names: wr.Normal(1.0, 0.1)}, sampling="sobol", variants=2).table()


def test_each_needs_as_many_targets_of_every_name():
    vary = {"mount/m0*/stiffness & mount/s*/stiffness": wr.Normal(1.0, 0.1, each=True)}
    with pytest.raises(ValueError, match="must match as many mounts, got 6 and 4"):
        study(vary, sampling="sobol", variants=2).table()
