"""Where systems rest: signs, balance of forces and moments, stops, and that a simulation from there stays there."""

import mujoco
import numpy as np
import pytest
from free_bodies import floor_on_stops
from house import deck, hysteresis, mjcf, quiet, sdof, sdof_text
from scipy.optimize import root

import wirerope_mj as wr
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.statics.loading import LOAD_STEPS, Loading
from wirerope_mj.foundation.resources import models_folder

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
STATE = mujoco.mjtState.mjSTATE_INTEGRATION
MODELS = ("sdof_shaker", "shock_table", "cabinet", "floating_floor")


@pytest.fixture(scope="module")
def systems():
    """Return the systems of the house's models by name."""
    return {name: wr.load_system(models_folder() / f"{name}.xml") for name in MODELS}


def at_rest(system, e):
    """Return MuJoCo's data in the state of the equilibrium `e`, everything computed."""
    model = system.model.__copy__()
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, e.state.values, STATE)
    with installed(model, data):
        mujoco.mj_forward(model, data)
    return model, data


def loads(system, e):
    """Return the world forces of the mounts on the payload (n, 3), where they act (n, 3), mass and centre of the payload."""
    model, data = at_rest(system, e)
    force, place = [], []
    for name, mount in system.mounts.items():
        axes = data.site(mount.base_site).xmat.reshape(3, 3)
        force.append(-axes @ e.mounts[name].force)
        place.append(data.site(mount.payload_site).xpos.copy())
    base = model.body(system.base).id
    moving = [b for b in range(1, model.nbody) if model.body_rootid[b] != base]
    mass = model.body_mass[moving]
    centre = mass @ data.xipos[moving] / mass.sum()
    return np.array(force), np.array(place), mass.sum(), centre


def test_the_floating_floor_hangs_in_balance(systems):
    system = systems["floating_floor"]
    e = wr.equilibrium(system)
    force, place, mass, centre = loads(system, e)
    weight = mass * G
    assert mass == pytest.approx(3300.0, abs=1.0)
    isolators = {name: mount for name, mount in system.mounts.items() if not mount.isolator.is_stop}
    upright = [name for name, mount in isolators.items() if mount.axes[2, 2] > 0.99 and mount.isolator.axial]
    assert len(upright) >= 12
    for name in upright:
        assert e.mounts[name].deflection[2] < 0.0
        assert e.mounts[name].force[2] < 0.0
    # 1e-6 is what an engineer's check sums allow; Newton's method ends at 1e-11 g and reaches 1e-14.
    total = force.sum(axis=0) - [0.0, 0.0, weight]
    moment = np.cross(place - centre, force).sum(axis=0)
    print("force", np.abs(total).max() / weight, "moment", np.abs(moment).max() / weight / 6.0, "residual", e.residual)
    assert np.abs(total).max() < 1e-6 * weight
    assert np.abs(moment).max() < 1e-6 * weight * 6.0
    assert e.residual < 1e-8 * G


def test_the_equilibrium_lies_on_the_virgin_path_of_every_mount(systems):
    system = systems["floating_floor"]
    e = wr.equilibrium(system)
    for name in ("m01", "m16"):
        law = system.mounts[name].isolator.coupled
        loop = law.trace([[0.0, 0.0], e.mounts[name].deflection[[0, 2]]])
        # Loaded monotonely, so that one straight trace ends at nearly the same force: the path bends in roll by a thousandth.
        assert e.mounts[name].force[2] == pytest.approx(loop.force[-1, 1], rel=1e-6)


def test_relaxed_mounts_hang_lower_and_carry_the_weight_without_z(systems):
    system = systems["floating_floor"]
    virgin, relaxed = wr.equilibrium(system), wr.equilibrium(system, history="relaxed")
    force, place, mass, centre = loads(system, relaxed)
    assert relaxed.history == "relaxed"
    assert np.abs(force.sum(axis=0) - [0.0, 0.0, mass * G]).max() < 1e-6 * mass * G
    assert np.abs(np.cross(place - centre, force).sum(axis=0)).max() < 1e-6 * mass * G * 6.0
    sag = [np.mean([e.mounts[f"m{i:02d}"].deflection[2] for i in range(1, 17)]) for e in (virgin, relaxed)]
    assert sag[1] < sag[0] < 0.0
    _, data = at_rest(system, relaxed)
    assert np.abs(data.act).max() == 0.0


def test_a_simulation_from_the_relaxed_equilibrium_stays_there(systems):
    system = systems["floating_floor"]
    relaxed = wr.equilibrium(system, history="relaxed")
    r = wr.simulate(system, quiet(), duration=0.3, timestep=1e-3, initial="relaxed")
    assert np.array_equal(r.initial_state.values, relaxed.state.values)
    assert max(peaks.acceleration.value for peaks in r.peaks.bodies.values()) < 1e-6 * G
    assert not r.mounts["m01"].hysteretic_state[0].any()


def test_one_mass_sags_by_the_law():
    law = wr.BoucWen(**hysteresis(alpha=5e4, z_max=30.0), k=2e4)
    e = wr.equilibrium(sdof(law, mass=3.5, gravity=G))
    assert e.mounts["m1"].force == pytest.approx([0.0, 0.0, -3.5 * G], rel=1e-9)
    assert law.trace([0.0, e.mounts["m1"].deflection[2]]).force[-1] == pytest.approx(-3.5 * G, rel=1e-8)
    relaxed = wr.equilibrium(sdof(law, mass=3.5, gravity=G), history="relaxed")
    assert relaxed.mounts["m1"].deflection[2] == pytest.approx(-3.5 * G / 2e4, rel=1e-9)


@pytest.mark.parametrize("name", MODELS)
def test_a_simulation_from_the_equilibrium_stays_there(systems, name):
    system = systems[name]
    r = wr.simulate(system, quiet(), duration=1.0, timestep=1e-3 if name != "sdof_shaker" else 5e-4)
    largest = {body: peaks.acceleration.value / G for body, peaks in r.peaks.bodies.items()}
    print(name, "largest acceleration [g]", max(largest.values()))
    assert max(largest.values()) < 1e-6, largest
    e = wr.equilibrium(system)
    for mount, load in e.mounts.items():
        np.testing.assert_allclose(r.mounts[mount].deflection[-1], load.deflection, atol=1e-8)


LAWS = {
    "ozdemir": wr.Ozdemir(alpha=4e4, beta=2e4, n=1.6, k=2e4),
    "asymmetric": wr.AsymmetricBoucWen(**hysteresis(alpha=4e4, z_max=15.0), k1=2e4, k2=-1e5, k3=3e7, b=1.0, c=20.0),
    "masing": wr.Masing(stiffness=[3e4, 2e4, 1e4], slip_force=[2.0, 6.0, 9.0], k=1e4),
    "friction": wr.EnhancedDryFriction(k=2e4, d=15.0, u_c=3e-4),
    "degrading": wr.BoucWenBaberNoori(**hysteresis(alpha=4e4, z_max=15.0), k=2e4, delta_nu=0.5, delta_eta=2.0),
    "zener": wr.Zener(k0=2e4, k1=4e4, c=50.0),
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_one_mass_rests_on_the_trace_of_every_law(law):
    e = wr.equilibrium(sdof(law, gravity=G))
    x = e.mounts["m1"].deflection[2]
    # Zener's damper lets go on a slow path; all other laws are traced in one go, to 1e-8 or better.
    force = law.k0 * x if isinstance(law, wr.Zener) else law.trace([0.0, x]).force[-1]
    assert x < 0.0
    assert force == pytest.approx(-3.5 * G, rel=1e-7)


def test_coupled_roll_and_shear_follow_the_load_together():
    """A mass on a wall whose mount is turned by 30 degrees: gravity pulls along both axes, and the path in the plane bends."""
    roll = wr.BoucWen(**hysteresis(alpha=2e4, z_max=15.0), k=1e4)
    shear = wr.BoucWen(**hysteresis(alpha=8e4, z_max=15.0), k=2e4)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    world = deck({"b": f'pos="1 0 1" xyaxes="0 {s} {-c} 0 {c} {s}"'}) + (
        '<body name="mass" pos=".8 0 1"><joint type="slide" axis="0 0 1"/><joint type="slide" axis="0 1 0"/>'
        '<geom size=".1" mass="3.5"/><site name="p" pos=".2 0 0"/></body>'
    )
    isolator = wr.Isolator(name="a", roll=roll, shear=shear, coupling="biaxial")
    system = wr.load_system(mjcf(world, [("w", "p", "b", "a")], gravity=G), isolators={"a": isolator})
    weight, path = 3.5 * G * np.array([c, -s]), [np.zeros(2)]
    for step in range(1, LOAD_STEPS + 1):
        load = weight * step / LOAD_STEPS

        def left(x, load=load):
            return isolator.coupled.trace([*path, x]).force[-1] - load

        path.append(root(left, path[-1] + load / 1e5, tol=1e-12).x)
    e = wr.equilibrium(system)
    np.testing.assert_allclose(e.mounts["w"].force[:2], weight, rtol=1e-9)
    # Both follow the plane's law to 1e-10 a segment.
    np.testing.assert_allclose(e.mounts["w"].deflection[:2], path[-1], rtol=1e-8)
    straight = isolator.coupled.trace([np.zeros(2), path[-1]]).force[-1]
    assert np.abs(straight / weight - 1.0).max() > 1e-4  # else the bend would not be seen


def test_what_nothing_holds_sideways_stays_where_it_is():
    places = {"p1": (0.5, 0.4), "p2": (0.5, -0.4), "p3": (-0.5, 0.4), "p4": (-0.5, -0.4)}
    points = "".join(f'<site name="{name}" pos="{x} {y} 0"/>' for name, (x, y) in places.items())
    inertia = '<inertial pos="0 0 .3" mass="300" diaginertia="30 30 20"/>'
    box = f'<body name="box" pos="0 0 1"><freejoint/>{inertia}{points}</body>'
    sites = {f"b{name}": f'pos="{x} {y} 1"' for name, (x, y) in places.items()}
    text = mjcf(deck(sites) + box, [(f"m{name}", name, f"b{name}", "a") for name in places], gravity=G)
    law = wr.BoucWen(**hysteresis(alpha=5e4, z_max=200.0), k=2e4)
    e = wr.equilibrium(wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=law)}))
    for load in e.mounts.values():
        assert load.force[2] == pytest.approx(-75.0 * G, rel=1e-9)
        np.testing.assert_allclose(load.deflection[:2], 0.0, atol=1e-9)  # rounding of a travel of centimetres


@pytest.mark.parametrize("history", ["virgin", "relaxed"])
def test_a_jacobian_serves_many_load_steps(systems, history, monkeypatch):
    passes, forward = [], mujoco.mj_forwardSkip
    monkeypatch.setattr(mujoco, "mj_forwardSkip", lambda *args: (passes.append(1), forward(*args)))
    system = systems["floating_floor"]
    found = Loading(system, history, mujoco.MjData(system.model)).solve()
    assert found.residual < 1e-11 * G
    assert len(passes) < 250  # a Jacobian from differences in every iteration takes four times as many


def test_a_floor_on_its_bump_stops_carries_its_weight():
    system = floor_on_stops()
    e = wr.equilibrium(system)
    model, data = at_rest(system, e)
    assert data.ncon == 4
    wrench = np.zeros(6)
    contact, moment = 0.0, np.zeros(3)
    for i in range(data.ncon):
        mujoco.mj_contactForce(model, data, i, wrench)
        contact += wrench[0]
        moment += np.cross(data.contact[i].pos - data.body("plate").xipos, [0.0, 0.0, wrench[0]])
    force, place, mass, centre = loads(system, e)
    weight = mass * G
    moment += np.cross(place - centre, force).sum(axis=0)
    error = (contact + force[:, 2].sum()) / weight - 1.0
    print("on its stops: force error", error, "moment", np.abs(moment).max() / weight, "share", contact / weight)
    assert 0.3 < contact / weight < 0.9
    assert abs(error) < 1e-5
    assert np.abs(moment).max() < 1e-5 * weight
    r = wr.simulate(system, quiet(), duration=0.5, timestep=5e-4)
    # The contact's own solver iterates to a tolerance; 1e-5 of the weight is far below any load cell.
    assert r.peaks.bodies["plate"].acceleration.value < 1e-5 * G


def test_a_plate_dropped_onto_its_stops_comes_to_rest_with_its_weight_on_them():
    system = floor_on_stops()
    with pytest.warns(wr.AccuracyWarning, match="4 of 4 contact pairs were struck"):
        r = wr.simulate(system, quiet(), duration=3.0, timestep=5e-4, initial="unloaded")
    model = system.model.__copy__()
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, r.final_state.values, STATE)
    with installed(model, data):
        mujoco.mj_forward(model, data)
    wrench, contact = np.zeros(6), 0.0
    for i in range(data.ncon):
        mujoco.mj_contactForce(model, data, i, wrench)
        contact += wrench[0]
    carried = contact - sum(m.force[-1, 2] for m in r.mounts.values())
    left = 400.0 * r.bodies["plate"].acceleration[-1, 2]
    # Whatever still rings is in the acceleration: the balance holds at any instant, to the contact solver's 1e-5.
    assert carried - left == pytest.approx(400.0 * G, rel=1e-5)
    assert abs(left) < 0.05 * 400.0 * G


def test_a_body_that_reaches_beyond_what_rounding_holds_is_refused_in_words():
    """A plate of 1e12 m: of the mass matrix of what its one mount leaves free, rounding has no inverse."""
    box = (
        '<body name="box" pos="0 0 .3"><freejoint/><geom size=".1" mass="30"/><site name="p" pos=".3 .2 -.1"/>'
        '<geom type="box" size=".3 1e12 .01" pos="0 0 -.1" mass="2"/><body pos="0 0 .1">'
        '<joint axis="0 1 0" stiffness="50" damping=".1"/><geom size=".02" pos="0 0 .05" mass="1"/></body></body>'
    )
    law = wr.BoucWen(alpha=1e5, beta=75.0, gamma=30.0, n=1.2, k=4e4)
    text = mjcf(deck({"b": 'pos=".3 .2 .2"'}) + box, [("m1", "p", "b", "a")], gravity=G)
    system = wr.load_system(text, isolators={"a": wr.Isolator(name="a", roll=law, shear=law, axial=law)})
    with pytest.raises(wr.ConvergenceError, match="body 'box' still accelerates"):
        wr.equilibrium(system)


def test_a_mount_without_elastic_part_below_its_load_has_no_equilibrium():
    law = wr.BoucWen(**hysteresis(alpha=5e4, z_max=30.0))
    system = sdof(law, mass=3.5, gravity=G)  # 34.3 N
    with pytest.raises(wr.ConvergenceError, match=r"'m1'.*at most 30 N.*34\.32 N"):
        wr.equilibrium(system)
    with pytest.raises(wr.ConvergenceError, match="no elastic part"):
        wr.equilibrium(sdof(wr.BoucWen(**hysteresis(alpha=5e4, z_max=60.0)), gravity=G), history="relaxed")
    assert wr.equilibrium(sdof(wr.BoucWen(**hysteresis(alpha=5e4, z_max=36.0)), gravity=G)).mounts["m1"].force[2] < 0.0


def test_a_weight_that_no_mount_can_bear_is_refused_with_gravity_and_mass():
    law = wr.BoucWen(**hysteresis(alpha=1e5, z_max=60.0), k=2e4)
    words = r"deflects mount 'm1' by 1\d\.\d m\. Gravity is 100000 m/s\^2 and the mass on the mounts 3\.5 kg"
    with pytest.raises(wr.ConvergenceError, match=words):
        wr.equilibrium(sdof(law, gravity=1e5))
    with pytest.raises(wr.ModelError, match="`gravity` is 0 0 -1e.09 m/s.2, beyond 100000; take 0 0 -9.80665"):
        sdof(law, gravity=1e9)


def test_a_body_beside_its_only_mount_is_named():
    """It would swing below the mount, and that far the loading path does not lead."""
    box = '<body name="box" pos="0 0 1"><freejoint/><geom size=".1" mass="3"/><site name="p" pos=".5 0 0"/></body>'
    text = mjcf(deck({"b": 'pos=".5 0 1"'}) + box, [("m1", "p", "b", "a")], gravity=G)
    spring = wr.KelvinVoigt(k=1e4, c=0.0)
    isolator = wr.Isolator(name="a", roll=spring, shear=spring, axial=spring)
    with pytest.raises(wr.ConvergenceError, match=r"body 'box' still accelerates.*no mount, joint or stop resists"):
        wr.equilibrium(wr.load_system(text, isolators={"a": isolator}))


def test_the_history_must_be_known():
    with pytest.raises(ValueError, match=r"`history` must be one of 'virgin', 'relaxed', got 'old'"):
        wr.equilibrium(sdof(wr.KelvinVoigt(k=1e4, c=1.0)), history="old")


def test_a_mass_hanging_from_a_ceiling_stretches_its_mount():
    law = wr.BoucWen(**hysteresis(alpha=5e4, z_max=30.0), k=2e4)
    # The base's bar is above, the payload's below: z of the base site points down.
    world = deck({"b": 'pos="0 0 1.2" zaxis="0 0 -1"'}) + (
        '<body name="mass" pos="0 0 1"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="3.5"/>'
        '<site name="p" pos="0 0 .2"/></body>'
    )
    system = wr.load_system(mjcf(world, [("c", "p", "b", "a")], gravity=G), isolators={"a": wr.Isolator(name="a", axial=law)})
    e = wr.equilibrium(system)
    assert e.mounts["c"].deflection[2] > 0.0
    assert e.mounts["c"].force[2] == pytest.approx(3.5 * G, rel=1e-9)
    # A base that jumps up pulls the hanging mass behind it: the mount stretches further.
    shock = wr.HalfSine(peak=5 * G, duration=0.01, direction="z")
    assert wr.simulate(system, shock, duration=0.02, timestep=1e-4).mounts["c"].force[:, 2].max() > 4.0 * G


def test_a_mass_on_a_wall_mount_hangs_in_roll_and_is_pushed_in_axial_direction():
    # z of the base site points from the wall along -x to the mass, x down, so that gravity is positive roll, and y along -y.
    frame = 'pos="1 0 1" xyaxes="0 0 -1 0 -1 0"'
    world = deck({"b": frame}) + (
        '<body name="mass" pos=".8 0 1"><joint type="slide" axis="0 0 1"/><joint type="slide" axis="1 0 0"/>'
        '<joint type="slide" axis="0 1 0"/><geom size=".1" mass="3.5"/><site name="p" pos=".2 0 0"/></body>'
    )
    law = wr.KelvinVoigt(k=2e4, c=20.0)
    isolator = wr.Isolator(name="a", roll=law, shear=wr.KelvinVoigt(k=3e4, c=20.0), axial=wr.KelvinVoigt(k=5e4, c=20.0))
    system = wr.load_system(mjcf(world, [("w", "p", "b", "a")], gravity=G), isolators={"a": isolator})
    np.testing.assert_allclose(system.mounts["w"].axes[:, 2], [-1.0, 0.0, 0.0], atol=1e-12)
    e = wr.equilibrium(system)
    np.testing.assert_allclose(e.mounts["w"].force, [3.5 * G, 0.0, 0.0], atol=1e-8)
    np.testing.assert_allclose(e.mounts["w"].deflection, [3.5 * G / 2e4, 0.0, 0.0], atol=1e-12)
    # The wall strikes towards the mass (-x): compression, negative. Along +y the mass lags towards -y: positive shear.
    shock = wr.HalfSine(peak=-5 * G, duration=0.01, direction="x") + wr.HalfSine(peak=5 * G, duration=0.01, direction="y")
    r = wr.simulate(system, shock, duration=0.008, timestep=1e-4)
    assert r.mounts["w"].force[-1, 2] < -0.5 * 3.5 * G
    assert r.mounts["w"].force[-1, 1] > 0.5 * 3.5 * G
    assert r.bodies["mass"].acceleration[-1, 0] < 0.0 < r.bodies["mass"].acceleration[-1, 1]


def test_an_attached_model_brings_its_mounts_under_its_prefix():
    law = wr.KelvinVoigt(k=2e4, c=20.0)
    room = '<mujoco><option gravity="0 0 -9.80665"/><worldbody/></mujoco>'
    parent = mujoco.MjSpec.from_string(room)
    for prefix, x in (("A-", 0.0), ("B-", 2.0)):
        child = mujoco.MjSpec.from_string(sdof_text(mass=3.5, gravity=G))
        parent.attach(child, prefix=prefix, frame=parent.worldbody.add_frame(pos=[x, 0.0, 0.0]))
    parent.add_tuple(name="base", objtype=[mujoco.mjtObj.mjOBJ_BODY], objname=["A-deck"], objprm=[0.0])
    parent.compile()
    system = wr.load_system(parent.to_xml(), isolators={"a": wr.Isolator(name="a", axial=law)})
    assert list(system.mounts) == ["A-m1", "B-m1"]
    assert system.mounts["B-m1"].payload_site == "B-p"
    assert system.mounts["B-m1"].payload_body == "B-mass"
    assert system.base == "A-deck"
    assert set(system.isolators) == {"a"}
