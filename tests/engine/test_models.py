"""The models of the house, read by plain MuJoCo: what their comments state must be what they compile to."""

from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pytest

from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.vendor_parts import load_isolator

MODELS = Path(__file__).parents[2] / "models"


@dataclass(frozen=True)
class Expected:
    """What the comment at the top of a model says of it."""

    base: str
    payload: str
    mass: float  # [kg]
    centre_of_mass: tuple[float, float, float]  # [m]
    stop_gap: float  # [m], rated travel of the mounts in compression
    side_gap: float | None  # [m]
    vertical_mounts: int
    mounts: int  # that isolate
    carrier: str = ""  # what the mounts stand on, if it is not the base itself
    stops: int = 0  # that are mounts, not contacts


EXPECTED = {
    "sdof_shaker": Expected("table", "mass", 3.5, (0.0, 0.0, 0.095), 0.015, None, 1, 1),
    "shock_table": Expected("table", "block", 50.0, (0.0, 0.0, 0.1035), 0.0401, None, 1, 1, stops=4),
    "shock_table_contacts": Expected("table", "block", 50.0, (0.0, 0.0, 0.1035), 0.0401, None, 1, 1),
    "shock_table_frame": Expected("table", "block", 50.0, (0.0, 0.0, 0.1035), 0.0401, None, 1, 1, "frame", 4),
    "floating_floor": Expected("deck", "floor", 3300.0, (0.2488, 0.1067, 0.4995), 0.0432, 0.0401, 16, 24, stops=16),
    "cabinet": Expected("deck", "rack", 850.0, (0.0319, 0.0264, 0.7962), 0.03556, 0.03556, 6, 10, stops=6),
}

# From the catalogues: vibration stiffness [N/m] along roll, shear and axial, rated static load [N] in compression.
# The rubber spring is only a guess of the right size here: it carries no weight.
CATALOGUE = {
    "wr16_400": ((173e3, 173e3, 613e3), 2869.0),
    "wr12_400": ((77e3, 77e3, 242e3), 1068.0),
    "cb1400_15": ((258e3, 258e3, 1143e3), 4160.0),
    "rubber": ((200e3, 200e3, 0.0), np.inf),
}


def compiled(name):
    model = mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def model_name(model):
    return model.names[: model.names.index(b"\0")].decode()


def mounts_of(model):
    """Mount name -> (payload site id, base site id, isolator name)."""
    found = {}
    for index in range(model.ntuple):
        name = model.tuple(index).name
        assert name.startswith("mount/")
        ids = model.tuple_objid[model.tuple_adr[index] :][: model.tuple_size[index]]
        kinds = model.tuple_objtype[model.tuple_adr[index] :][: model.tuple_size[index]]
        assert list(kinds) == [mujoco.mjtObj.mjOBJ_SITE, mujoco.mjtObj.mjOBJ_SITE, mujoco.mjtObj.mjOBJ_TEXT]
        isolator = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_TEXT, ids[2]).removeprefix("isolator/")
        found[name.removeprefix("mount/")] = (int(ids[0]), int(ids[1]), isolator)
    return found


def stops_of(model):
    """Those of the mounts that are stops, by name."""
    return {name: mount for name, mount in mounts_of(model).items() if mount[2].startswith("bump_stop")}


def isolators_of(model):
    """Those of the mounts that are not stops, by name."""
    return {name: mount for name, mount in mounts_of(model).items() if not mount[2].startswith("bump_stop")}


def geoms_of(model, body):
    root = model.body(body).id
    return [g for g in range(model.ngeom) if model.body_rootid[model.geom_bodyid[g]] == root]


def distance(model, data, first, second):
    # 20 m: beyond every distance in these models, so that the answer is never cut off
    return mujoco.mj_geomDistance(model, data, first, second, 20.0, None)


@pytest.fixture(params=EXPECTED)
def case(request):
    return EXPECTED[request.param], *compiled(request.param)


def test_every_model_is_listed_here():
    assert {path.stem for path in MODELS.glob("*.xml")} == set(EXPECTED)


def test_gravity_is_standard_and_the_integrator_is_runge_kutta(case):
    _, model, _ = case
    np.testing.assert_array_equal(model.opt.gravity, [0.0, 0.0, -STANDARD_GRAVITY])
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    assert model.nu == 0


def test_the_base_slides_and_the_payload_hangs_on_the_world(case):
    expected, model, _ = case
    base, payload = model.body(expected.base), model.body(expected.payload)
    assert base.parentid == 0
    assert payload.parentid == 0
    assert [model.body(b).name for b in range(1, model.nbody) if model.body_parentid[b] == 0] == [
        expected.base,
        expected.payload,
    ]
    slides = range(base.jntadr[0], base.jntadr[0] + base.jntnum[0])
    assert all(model.jnt_type[j] == mujoco.mjtJoint.mjJNT_SLIDE for j in slides)
    wanted = np.eye(3)[2:] if expected.payload == "mass" else np.eye(3)  # the shaker moves along z only
    np.testing.assert_array_equal([model.jnt_axis[j] for j in slides], wanted)


def test_mass_and_centre_of_mass_are_those_of_the_comment(case):
    expected, model, data = case
    body = model.body(expected.payload).id
    assert model.body_subtreemass[body] == pytest.approx(expected.mass, rel=1e-12)  # rounding of the sum
    # the comment gives four decimals
    np.testing.assert_allclose(data.subtree_com[body], expected.centre_of_mass, atol=0.5001e-4)
    text = " ".join((MODELS / f"{model_name(model)}.xml").read_text().split())
    assert f"Total payload mass {expected.mass:g} kg" in text


def test_mount_sites_coincide_and_point_from_base_to_payload(case):
    expected, model, data = case
    mounts = mounts_of(model)
    assert (len(isolators_of(model)), len(stops_of(model))) == (expected.mounts, expected.stops)
    assert sum(name.startswith("m") for name in mounts) == expected.vertical_mounts
    for name, (payload_site, base_site, _) in mounts.items():
        assert model.site(payload_site).name == f"{expected.payload}/{name}"
        assert model.site(base_site).name == f"{expected.carrier or expected.base}/{name}"
        # house rule: closer than 1e-6 m at qpos0
        assert np.linalg.norm(data.site_xpos[payload_site] - data.site_xpos[base_site]) < 1e-6
        frame = data.site_xmat[base_site].reshape(3, 3)
        np.testing.assert_allclose(data.site_xmat[payload_site].reshape(3, 3), frame, atol=1e-12)
        if name in stops_of(model):
            continue  # what they stand before decides; the next test but one looks
        if name[0] in "mr":
            np.testing.assert_allclose(frame[:, 2], [0, 0, 1], atol=1e-12)
        else:  # horizontal: towards the payload's centre, roll upright
            inward = data.subtree_com[model.body(expected.payload).id] - data.site_xpos[base_site]
            assert abs(frame[2, 2]) < 1e-12
            assert frame[:, 2] @ inward > 0.0
            np.testing.assert_allclose(frame[:, 0], [0, 0, 1], atol=1e-12)


def test_base_and_payload_stand_apart_by_the_mounts_height(case):
    """No geom of the payload reaches into the base, and upright mounts stand half-way between deck and payload."""
    expected, model, data = case
    payload, base = geoms_of(model, expected.payload), geoms_of(model, expected.base)
    gap = min(distance(model, data, g, h) for g in payload for h in base)
    # the nearest pair of all is a stop and its pad
    smallest = min(expected.stop_gap, expected.side_gap or np.inf)
    assert gap == pytest.approx(smallest, abs=1e-9)
    underside = data.xpos[model.body(expected.payload).id][2]
    for name, (site, _, _) in mounts_of(model).items():
        if name.startswith("m"):
            assert data.site_xpos[site][2] == pytest.approx(underside / 2.0, abs=1e-9)


def spheres_of(model):
    """The geoms that are drawn as stops."""
    sphere = mujoco.mjtGeom.mjGEOM_SPHERE
    return {g for g in range(model.ngeom) if "stop" in model.geom(g).name and model.geom_type[g] == sphere}


def test_nothing_touches_but_declared_pairs_and_only_where_no_stop_is_a_mount(case):
    expected, model, data = case
    assert data.ncon == 0
    assert not np.any(model.geom_contype)
    assert not np.any(model.geom_conaffinity)
    assert (model.npair > 0) != (expected.stops > 0)


def test_each_pair_waits_at_the_rated_travel(case):
    expected, model, data = case
    for stop, pad in zip(model.pair_geom1, model.pair_geom2, strict=True):
        assert distance(model, data, stop, pad) == pytest.approx(expected.stop_gap, abs=1e-9)  # rounding of the file
    assert expected.stops or spheres_of(model) < {*model.pair_geom1.tolist(), *model.pair_geom2.tolist()}
    assert expected.stops or model.npair == len(spheres_of(model))


def test_each_stop_of_the_mounts_stands_in_its_sphere_and_closes_where_it_meets_its_pad(case):
    """Sphere and pad as drawn touch at the gap of the isolator file, along the axis of the site."""
    expected, model, data = case
    spheres = spheres_of(model) if expected.stops else set()
    for name, (payload_site, base_site, isolator) in stops_of(model).items():
        (sphere,) = (g for g in spheres if np.allclose(data.geom_xpos[g], data.site_xpos[payload_site], atol=1e-9))
        spheres.remove(sphere)
        lines = np.zeros((len(geoms_of(model, expected.base)), 6))
        apart = [
            mujoco.mj_geomDistance(model, data, sphere, g, 20.0, line)
            for g, line in zip(geoms_of(model, expected.base), lines, strict=True)
        ]
        stop = load_isolator(MODELS / "isolators" / f"{isolator}.toml")
        gap = stop.axial.gap_below
        assert stop.is_stop
        assert stop.limits.travel.stated == {}
        side = "side" in isolator or model.geom(sphere).name.startswith("rear")
        assert gap == (expected.side_gap if side else expected.stop_gap)
        assert min(apart) == pytest.approx(gap, abs=1e-9), name  # rounding of the file
        line = lines[int(np.argmin(apart))]
        np.testing.assert_allclose((line[:3] - line[3:]) / gap, data.site_xmat[base_site].reshape(3, 3)[:, 2], atol=1e-6)
    assert not spheres


def test_points_of_interest_belong_to_the_payload(case):
    expected, model, _ = case
    points = [s for s in range(model.nsite) if model.site(s).name.startswith("point/")]
    assert points
    for site in points:
        assert model.body_rootid[model.site_bodyid[site]] == model.body(expected.payload).id


def driven(name):
    """The model as the loader will make it: a base of 1e10 kg that gravity does not pull, a tight solver."""
    spec = mujoco.MjSpec.from_file(str(MODELS / f"{name}.xml"))
    spec.option.tolerance = 1e-15  # the heavy base enters the solver's termination scale
    base = spec.body(EXPECTED[name].base)
    base.gravcomp = 1.0
    for joint in base.joints:
        joint.armature = 1e10
    return spec.compile()


@pytest.mark.slow
@pytest.mark.parametrize("timestep", [2e-4, 5e-4])
@pytest.mark.parametrize("name", [name for name, expected in EXPECTED.items() if not expected.stops])
def test_a_payload_without_mounts_settles_on_its_contacts(name, timestep):
    """Dropped from 1 mm above the stops: resting force is the weight within 1e-5, less than 0.25 mm deep."""
    expected, model = EXPECTED[name], driven(name)
    model.opt.timestep = timestep
    data = mujoco.MjData(model)
    joint = model.body(expected.payload).jntadr[0]
    only_z = len(model.body(expected.payload).jntadr) == 1 and model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE
    height = model.jnt_qposadr[joint] + (0 if only_z else 2)
    data.qpos[height] -= expected.stop_gap - 1e-3
    mujoco.mj_step(model, data, nstep=round(6.0 / timestep))  # 6 s: hundreds of the stops' time constants
    mujoco.mj_forward(model, data)
    assert not np.any(data.warning.number)
    weight = expected.mass * STANDARD_GRAVITY
    assert data.efc_force.sum() == pytest.approx(weight, rel=1e-5)
    assert 0.0 < max(-data.contact.dist) < 0.25e-3


def static_forces(name):
    """Mount forces [N] (n, 3) in mount axes of the linear rigid-body problem, by our own six equations."""
    expected = EXPECTED[name]
    model, data = compiled(name)
    centre = data.subtree_com[model.body(expected.payload).id]
    stiffness, rows = np.zeros((6, 6)), {}
    for mount, (_, site, isolator) in isolators_of(model).items():
        axes = data.site_xmat[site].reshape(3, 3)
        arm = data.site_xpos[site] - centre
        spin = np.array([[0.0, arm[2], -arm[1]], [-arm[2], 0.0, arm[0]], [arm[1], -arm[0], 0.0]])
        jacobian = axes.T @ np.hstack([np.eye(3), spin])
        local = np.diag(CATALOGUE[isolator][0]) @ jacobian
        stiffness += jacobian.T @ local
        rows[mount] = (local, CATALOGUE[isolator][1])
    load = np.array([0, 0, -expected.mass * STANDARD_GRAVITY, 0, 0, 0])
    motion = np.linalg.solve(stiffness, load)
    return {mount: (local @ motion, rating) for mount, (local, rating) in rows.items()}


@pytest.mark.parametrize(
    ("name", "lowest", "mean", "highest"),
    # the percentages stated in the comments
    [("floating_floor", 0.51, 0.68, 0.86), ("cabinet", 0.27, 0.29, 0.32)],
)
def test_every_upright_mount_carries_its_stated_share_of_its_rating(name, lowest, mean, highest):
    forces = static_forces(name)
    shares = np.array([-force[2] / rating for mount, (force, rating) in forces.items() if mount.startswith("m")])
    # the comment rounds to whole per cent
    np.testing.assert_allclose([shares.min(), shares.mean(), shares.max()], [lowest, mean, highest], atol=0.0051)
    assert np.all(shares < 1.0)
