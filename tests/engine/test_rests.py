"""Equilibria in lanes against the search with MuJoCo's accelerations, and against the company that a variant has."""

from dataclasses import replace

import numpy as np
import pytest
from laws_for_tests import PARAMETERS, example

import wirerope_mj as wr
from wirerope_mj.engine.kernel.equations import equations, not_held
from wirerope_mj.engine.kernel.variants import Numbers
from wirerope_mj.engine.simulation.engines import unsupported_system
from wirerope_mj.engine.statics import find
from wirerope_mj.engine.statics.find import equilibrium_solver, settle_together
from wirerope_mj.engine.statics.loading import HISTORIES, Loading
from wirerope_mj.engine.system import Changes
from wirerope_mj.engine.system.varied import changed
from wirerope_mj.foundation.resources import shipped_models
from wirerope_mj.studies.vary.quantity import acts, without_force

SAME = 1e-9
"""Relative to the largest deflection or force: both end within 1e-11 of gravity, and follow lines to 1e-10 of a state."""


def searched(system, history):
    with system.assembly.scratch.data(system.model) as data:
        return Loading(system, history, data).solve()


def in_lanes(system, history):
    find._known.pop(system, None)
    settle_together([system], history)
    return find._known.get(system, {}).get(history)


def rows_of(equilibrium):
    return np.array([[mount.deflection, mount.force] for mount in equilibrium.mounts.values()])


def require_same(found, expected):
    for part in range(2):
        one, other = rows_of(found)[:, part], rows_of(expected)[:, part]
        np.testing.assert_allclose(one, other, rtol=0.0, atol=SAME * np.abs(other).max())
    assert found.free == expected.free


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("name", shipped_models())
def test_shipped_models_rest_where_the_search_with_mujoco_finds_them(name, history):
    system = wr.load_system(name)
    found = in_lanes(system, history)
    if found is None:
        assert not_held(system)
        return
    require_same(found, searched(system, history))


def floor_on(law, mass=80.0, coupling=None):
    sites = [(x, y) for x in (-0.4, 0.5) for y in (-0.3, 0.35)]
    base = "".join(f'<site name="b{i}" pos="{x} {y} 0.1"/>' for i, (x, y) in enumerate(sites))
    payload = "".join(f'<site name="p{i}" pos="{x} {y} 0"/>' for i, (x, y) in enumerate(sites))
    tuples = "".join(
        f'<tuple name="mount/m{i}"><element objtype="site" objname="p{i}"/><element objtype="site" objname="b{i}"/>'
        '<element objtype="text" objname="isolator/one"/></tuple>'
        for i in range(len(sites))
    )
    text = f"""<mujoco><option gravity="0.6 -0.3 -9.8" integrator="RK4" timestep="0.001" tolerance="1e-15"/><worldbody>
      <body name="deck"><joint type="slide" axis="0 0 1" armature="1e10"/>
        <geom type="box" size="1 1 .02" contype="0" conaffinity="0"/>{base}</body>
      <body name="floor" pos="0 0 0.1"><freejoint/>
        <inertial pos="0.03 -0.02 0.1" mass="{mass}" diaginertia="9 12 15"/>{payload}</body>
      </worldbody><custom><text name="isolator/one" data="one.toml"/>{tuples}</custom></mujoco>"""
    isolator = wr.Isolator(name="one", roll=law, shear=law, axial=law, coupling=coupling, limits=limits_for(law))
    return wr.load_system(text, isolators={"one": isolator})


def limits_for(law):
    if law.travel_ends == (np.inf, np.inf):
        return wr.Limits()
    each = 0.9 * min(law.travel_ends)
    return wr.Limits(travel=wr.Travel(compression=each, tension=each, shear=each, roll=each))


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("name", [name for name in PARAMETERS if name != "stop"])  # which holds nothing while it is open
def test_every_law_rests_where_the_search_with_mujoco_finds_it(name, history):
    system = floor_on(example(name))
    assert unsupported_system(system) == ""
    require_same(in_lanes(system, history), searched(system, history))


@pytest.mark.parametrize("n", [0.6, 1.0, 1.5, 2.0])
def test_coupled_axes_rest_where_the_search_with_mujoco_finds_them(n):
    law = wr.SymmetricBoucWen(alpha=1e5, beta=0.7e5 / 150.0**n, gamma=0.3e5 / 150.0**n, n=n, k1=8e4, k2=1e5, k3=2e7)
    system = floor_on(law, coupling="biaxial")
    require_same(in_lanes(system, "virgin"), searched(system, "virgin"))


def variants_of(system, count):
    rng = np.random.default_rng(3)
    for _ in range(count):
        mounts = {}
        for name in list(system.mounts)[::2]:
            isolator = system.mounts[name].written
            laws = {axis: law.scaled(rng.uniform(0.8, 1.2)) for axis, law in isolator.axes.items() if law is not None}
            mounts[name] = wr.Isolator(name="own", limits=isolator.limits, **laws)
        yield Changes(
            isolators=mounts, masses={"floor": rng.uniform(0.8, 1.2)}, centres={"floor": rng.uniform(-0.01, 0.01, 3)},
            positions={"m1": rng.uniform(-0.01, 0.01, 3)},
        )  # fmt: skip


def test_numbers_of_variants_have_the_bits_of_their_own_equations():
    system = floor_on(example("asymmetric-bouc-wen"))
    numbers = Numbers(system, equations(system))
    for changes in variants_of(system, 4):
        own = equations(changed(system, changes))
        assert own.key == equations(system).key
        assert numbers.of(changes).tobytes() == own.num.tobytes()


def test_what_has_another_structure_is_not_written():
    system = floor_on(example("asymmetric-bouc-wen"))
    numbers = Numbers(system, equations(system))
    for law in (example("symmetric-bouc-wen"), example("stop"), None):
        other = wr.Isolator(name="other", roll=law, shear=law, axial=example("asymmetric-bouc-wen"))
        assert numbers.of(Changes(isolators={"m0": other})) is None
    assert numbers.of(Changes(masses={"deck": 2.0})) is None
    assert numbers.of(Changes(masses={"nothing": 2.0})) is None


def test_another_energy_of_a_loop_is_written_and_other_numbers_of_coefficients_or_elements_are_not():
    floor, sliders = wr.load_system("floating_floor"), floor_on(example("masing"))
    rope, law = floor.mounts["m01"].written, example("masing")
    stiffer, shorter = rope.loop.scaled(2.0), replace(rope.loop, coefficients=rope.loop.coefficients[:2])
    changes = Changes(isolators={"m01": replace(rope, loop=stiffer)})
    numbers = Numbers(floor, equations(floor))
    assert numbers.of(changes).tobytes() == equations(changed(floor, changes)).num.tobytes()
    assert numbers.of(Changes(isolators={"m01": replace(rope, loop=shorter)})) is None
    fewer = replace(law, stiffness=law.stiffness[:1], slip_force=law.slip_force[:1])
    other = replace(sliders.mounts["m0"].written, axial=fewer)
    assert Numbers(sliders, equations(sliders)).of(Changes(isolators={"m0": other})) is None


@pytest.mark.parametrize("name", [name for name in PARAMETERS if name not in ("stop", "tabulated")])
def test_an_isolator_that_failed_has_the_structure_of_its_own_and_no_force(name):
    system = floor_on(example(name))
    failed = without_force(system.mounts["m0"].written)
    assert acts(system.mounts["m0"].written)
    assert not acts(failed)
    assert without_force(failed) == failed
    changes = Changes(isolators={"m0": failed})
    assert Numbers(system, equations(system)).of(changes).tobytes() == equations(changed(system, changes)).num.tobytes()
    path = np.array([0.0, 0.03, -0.04, 0.02])
    assert np.abs(failed.axial.trace(path, time=np.arange(4.0)).force).max() < 1e-10  # of some 1e3 N


@pytest.mark.parametrize("name", ["bouc-wen", "asymmetric-bouc-wen", "bouc-wen-baber-noori"])
def test_a_variant_rests_with_the_same_bits_in_any_company(name):
    system = floor_on(example(name))
    numbers = Numbers(system, equations(system))
    every = np.array([numbers.of(changes) for changes in variants_of(system, 11)])
    together = equilibrium_solver(system).solve(every, "virgin")
    assert together.found.all()
    for rows in ([7], [10, 2, 5], list(range(10, -1, -1))):
        some = equilibrium_solver(system).solve(every[rows], "virgin")
        for part in ("states", "mounts", "residual"):
            assert getattr(some, part).tobytes() == getattr(together, part)[rows].tobytes()


def test_a_variant_that_finds_no_rest_leaves_the_others_as_they_are():
    system = floor_on(wr.BoucWen(alpha=1e5, beta=150.0, gamma=100.0, n=1.0, k=0.0), mass=20.0)
    numbers = Numbers(system, equations(system))
    heavy, light = (numbers.of(Changes(masses={"floor": factor})) for factor in (100.0, 1.1))
    rests = equilibrium_solver(system).solve(np.array([light, heavy, light]), "virgin")
    assert rests.found.tolist() == [True, False, True]
    assert rests.states[0].tobytes() == rests.states[2].tobytes()
    with pytest.raises(wr.ConvergenceError, match="carries at most"):
        wr.equilibrium(changed(system, Changes(masses={"floor": 100.0})))
