"""Responses: what a saved one gives back, streaming, and peaks between the steps."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest
from house import deck, hysteresis, mjcf, sdof

import wirerope_mj as wr
from wirerope_mj.engine.response.histories import MemorySamples

G = wr.STANDARD_GRAVITY
LAW = wr.BoucWen(**hysteresis(alpha=1e5, z_max=60.0), k=2e4)
SHOCK = wr.HalfSine(peak=30 * G, duration=0.011, direction="z", start=0.0075)
AXES = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


@pytest.fixture(scope="module")
def system():
    """Return a box with a point on two mounts of different kinds; its freedom is three slides and a hinge."""
    joints = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in AXES.values()) + '<joint axis="0 1 0"/>'
    world = deck({"d1": 'pos=".3 0 .2"', "d2": 'pos="-.3 0 .2"'}) + (
        f'<body name="box" pos="0 0 .3">{joints}<geom size=".2" mass="9"/><site name="p1" pos=".3 0 -.1"/>'
        '<site name="p2" pos="-.3 0 -.1"/><site name="point/lid" pos=".1 .2 .2"/></body>'
    )
    viscous = wr.KelvinVoigt(k=3e4, c=40.0)
    isolators = {
        "a": wr.Isolator(name="A", roll=LAW, axial=LAW),
        "r": wr.Isolator(name="R", roll=viscous, shear=viscous, axial=LAW),
    }
    return wr.load_system(mjcf(world, [("m1", "p1", "d1", "a"), ("m2", "p2", "d2", "r")], gravity=G), isolators=isolators)


@pytest.fixture(scope="module")
def response(system):
    shock = wr.HalfSine(peak=8 * G, duration=0.011, direction=(1, 1, 2), start=0.0075)
    return wr.simulate(system, shock, duration=0.25, timestep=2.5e-4)


def everything(r):
    return r.samples.columns(0, len(r.samples.names))


@pytest.mark.quick
def test_shapes_and_names(response):
    n = response.time.size
    assert n == 251
    np.testing.assert_array_equal(response.time, np.arange(n) / 1000.0)
    assert set(response.bodies) == {"deck", "box"}
    assert set(response.points) == {"lid"}
    assert list(response.mounts) == ["m1", "m2"]
    for part in (*response.bodies.values(), *response.points.values()):
        for name in ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration"):
            assert getattr(part, name).shape == (n, 3)
        assert part.orientation.shape == (n, 4)
        np.testing.assert_allclose(np.linalg.norm(part.orientation, axis=1), 1.0, atol=1e-12)
    assert response.points["lid"].relative_displacement.shape == (n, 3)
    for mount in response.mounts.values():
        assert mount.deflection.shape == mount.force.shape == mount.hysteretic_state.shape == (n, 3)
    assert set(response.mounts["m1"].internal_states) == {"roll.z", "axial.z"}
    assert set(response.mounts["m2"].internal_states) == {"axial.z"}
    assert len(set(response.samples.names)) == len(response.samples.names)


def test_an_axis_without_a_law_has_no_force_and_one_without_state_no_z(response):
    one, two = response.mounts["m1"], response.mounts["m2"]
    assert np.abs(one.deflection[:, 1]).max() > 1e-4
    assert not one.force[:, 1].any()
    assert not one.hysteretic_state[:, 1].any()
    assert not two.hysteretic_state[:, :2].any()
    assert np.abs(two.force[:, 0]).max() > 1.0
    np.testing.assert_array_equal(one.hysteretic_state[:, 2], one.internal_states["axial.z"])
    np.testing.assert_array_equal(one.hysteretic_state[:, 0], one.internal_states["roll.z"])
    # F = k x + z of recorded samples: the same sum, one rounding apart.
    np.testing.assert_allclose(
        one.force[:, 2], LAW.k * one.deflection[:, 2] + one.hysteretic_state[:, 2], rtol=1e-12, atol=1e-9
    )


def test_the_base_moves_as_its_motion_says(response):
    box = response.bodies["deck"]
    shock = wr.HalfSine(peak=8 * G, duration=0.011, direction=(1, 1, 2), start=0.0075)
    np.testing.assert_array_equal(response.base.displacement, shock.displacement(response.time))
    np.testing.assert_array_equal(response.base.velocity, shock.velocity(response.time))
    # RK4 of the half-sine in steps of 2.5e-4 s: (pi h / D)^4 / 2880 of the peak velocity, 1e-8.
    scale = np.abs(response.base.velocity).max()
    assert np.abs(box.velocity - response.base.velocity).max() < 1e-7 * scale
    assert np.abs(box.position - box.position[0] - response.base.displacement).max() < 1e-7 * scale
    np.testing.assert_allclose(box.acceleration, response.base.acceleration, atol=1e-5)


def test_points_move_relative_to_the_base(response):
    lid, box = response.points["lid"], response.bodies["box"]
    moved = lid.position - np.array([0.1, 0.2, 0.5]) - response.base.displacement
    # Measured from the deck as integrated, see above: 1e-7 m/s over 0.25 s at the most.
    np.testing.assert_allclose(lid.relative_displacement, moved, atol=1e-7)
    w = box.angular_velocity
    arm = lid.position - box.position
    np.testing.assert_allclose(lid.velocity, box.velocity + np.cross(w, arm), atol=1e-12)
    assert np.abs(w[:, 1]).max() > 0.1
    # At rest under gravity accelerations are zero, not g.
    assert np.abs(lid.acceleration[0]).max() < 1e-6 * G


def test_samples_and_states_stand_for_the_same_instants(system):
    r = wr.simulate(system, SHOCK, duration=0.0105, timestep=5e-4, sample_rate=400.0)
    # The grid joins 1 / 400 s samples with the corner at 7.5 ms and ends between two samples.
    np.testing.assert_allclose(r.time, np.arange(5) / 400.0, rtol=0, atol=1e-15)
    assert r.final_state.time == pytest.approx(0.0105, abs=1e-15)
    assert r.timestep <= 5e-4 * (1 + 1e-9)
    late = wr.simulate(system, SHOCK, duration=0.01, timestep=5e-4, sample_rate=400.0, initial=r.final_state)
    assert late.time[0] == pytest.approx(0.0125)


def same(a, b):
    assert everything(a).tobytes() == everything(b).tobytes()
    assert a.time.tobytes() == b.time.tobytes()
    for name in a.mounts:
        for part in ("deflection", "force", "hysteretic_state"):
            assert getattr(a.mounts[name], part).tobytes() == getattr(b.mounts[name], part).tobytes()
    for name in a.bodies:
        assert a.bodies[name].acceleration.tobytes() == b.bodies[name].acceleration.tobytes()
        assert a.bodies[name].orientation.tobytes() == b.bodies[name].orientation.tobytes()
    for part in ("displacement", "velocity", "acceleration"):
        assert getattr(a.base, part).tobytes() == getattr(b.base, part).tobytes()
    assert a.peaks.to_dict() == b.peaks.to_dict()
    assert a.motion == b.motion
    assert a.events == b.events
    assert a.final_state.values.tobytes() == b.final_state.values.tobytes()
    assert a.initial_state.values.tobytes() == b.initial_state.values.tobytes()
    assert (a.final_state.time, a.initial_state.time) == (b.final_state.time, b.initial_state.time)
    assert json.dumps(a.numerics.__dict__) == json.dumps(b.numerics.__dict__)  # NaN for NaN
    assert [body.name for body in a.scene.bodies] == [body.name for body in b.scene.bodies]


@pytest.mark.quick
def test_a_saved_response_comes_back_bit_by_bit(response, tmp_path):
    response.save(tmp_path / "run")
    loaded = wr.load_response(tmp_path / "run")
    assert np.isfinite(everything(response)).all()
    same(response, loaded)
    assert [path.name for path in (tmp_path / "run").iterdir()] == ["response.parquet"]
    loaded.save(tmp_path / "again")
    same(response, wr.load_response(tmp_path / "again"))


def test_a_loaded_response_reads_what_is_asked_for(response, tmp_path, monkeypatch):
    response.save(tmp_path)
    import pyarrow.parquet as pq

    read, original = [], pq.ParquetFile.iter_batches

    def counted(file, rows, *, columns, **more):
        read.append(list(columns))
        return original(file, rows, columns=columns, **more)

    monkeypatch.setattr(pq.ParquetFile, "iter_batches", counted)
    loaded = wr.load_response(tmp_path)
    assert not isinstance(loaded.samples, MemorySamples)
    read.clear()
    force = loaded.mounts["m2"].force
    assert read == [["mounts/m2/force/roll", "mounts/m2/force/shear", "mounts/m2/force/axial"]]
    assert loaded.mounts["m2"].force is force  # read once
    assert len(read) == 1


@pytest.mark.quick
def test_a_streamed_response_is_the_one_in_memory(system, tmp_path):
    settings = {"duration": 0.25, "timestep": 5e-5, "sample_rate": 20_000.0}
    memory = wr.simulate(system, SHOCK, **settings)
    streamed = wr.simulate(system, SHOCK, **settings, out=tmp_path / "run")
    # More than one block is written.
    assert streamed.time.size == 5001
    assert streamed.path == tmp_path / "run" / "response.parquet"
    assert not isinstance(streamed.samples, MemorySamples)
    same(memory, streamed)
    assert [path.name for path in (tmp_path / "run").iterdir()] == ["response.parquet"]
    with pytest.raises(wr.RecordError, match="elsewhere: there is no such folder"):
        wr.load_response(tmp_path / "elsewhere")


@pytest.mark.quick
def test_a_run_goes_on_from_a_loaded_state(system, response, tmp_path):
    response.save(tmp_path)
    a, b = (
        wr.simulate(system, SHOCK, duration=0.02, timestep=2.5e-4, initial=state)
        for state in (response.final_state, wr.load_response(tmp_path).final_state)
    )
    assert everything(a).tobytes() == everything(b).tobytes()


def test_a_damaged_file_is_named(response, tmp_path):
    response.save(tmp_path)
    path = tmp_path / "response.parquet"
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(wr.RecordError, match=r"response\.parquet: this is not a response of wirerope_mj"):
        wr.load_response(tmp_path)


@pytest.mark.quick
@pytest.mark.parametrize("timestep", [2e-3, 1e-3])
def test_peaks_are_refined_between_the_steps(timestep):
    """An undamped mass after a velocity step moves on x = -v/omega sin(omega t): its peaks are known."""
    k, mass, velocity = 3e4, 3.5, 2.0
    omega = np.sqrt(k / mass)
    motion = wr.VelocityStep(velocity=velocity, direction="z")
    system = sdof(wr.KelvinVoigt(k=k, c=0.0), mass=mass)
    r = wr.simulate(system, motion, duration=0.06, timestep=timestep, initial="unloaded", sample_rate=1 / timestep)
    peak = r.peaks.mounts["m1"].deflection
    exact = velocity / omega
    on_grid = np.abs(r.mounts["m1"].deflection[:, 2]).max()
    # On the grid a peak is missed by up to (omega h / 2)^2 / 2; the parabola leaves its fourth power, and RK4 its own error.
    bound = (omega * timestep) ** 4 / 20
    print(timestep, "grid", 1 - on_grid / exact, "refined", peak.value / exact - 1, "bound", bound)
    assert abs(peak.value / exact - 1) < bound
    assert abs(peak.minimum[2] / -exact - 1) < bound
    assert peak.minimum_time[2] == pytest.approx(np.pi / 2 / omega, abs=0.02 * timestep)
    assert peak.maximum_time[2] == pytest.approx(1.5 * np.pi / omega, abs=0.02 * timestep)
    assert abs(peak.value / exact - 1) < 0.2 * (1 - on_grid / exact)
    acceleration = r.peaks.bodies["mass"].acceleration
    assert abs(acceleration.value / (omega * velocity) - 1) < bound
    assert acceleration.maximum[2] == pytest.approx(omega * velocity, rel=bound)  # struck upwards: first along +z
    assert acceleration.vector[2] == pytest.approx(np.sign(acceleration.vector[2]) * acceleration.value, rel=1e-12)


@pytest.mark.quick
def test_peaks_see_every_step_and_not_only_the_samples():
    system = sdof(LAW)
    runs = [
        wr.simulate(system, SHOCK, duration=0.2, timestep=5e-4, initial="unloaded", sample_rate=rate) for rate in (2000.0, 50.0)
    ]
    dense, sparse = (r.peaks.mounts["m1"].force for r in runs)
    assert np.abs(runs[1].mounts["m1"].force).max() < 0.98 * dense.value
    # The grids differ by a few rounded instants and the corner's pieces only; peaks agree to the integration error.
    assert sparse.value == pytest.approx(dense.value, rel=2e-3)


def test_peak_of_a_jump_is_not_refined_across_it():
    """The sawtooth falls from its peak to zero at once: a parabola through the fall would overshoot."""
    saw = wr.Sawtooth(peak=30 * G, duration=0.011, direction="z", start=0.0075)
    r = wr.simulate(sdof(LAW), saw, duration=0.05, timestep=5e-4, initial="unloaded")
    deck_peak = r.peaks.bodies["deck"].acceleration.value
    assert deck_peak <= 30 * G * (1 + 1e-9)
    # The last step before the corner is seen one step earlier at the least.
    assert deck_peak >= 30 * G * (1 - 1.01 * 5e-4 / 0.011)


def test_the_peak_of_the_base_is_that_of_its_motion():
    soft = sdof(wr.KelvinVoigt(k=3e3, c=5.0))
    shock = wr.HalfSine(peak=30 * G, duration=0.011, direction="z", start=0.0033)
    r = wr.simulate(soft, shock, duration=0.1, timestep=1e-3, initial="unloaded", sample_rate=200.0)
    peak = r.peaks.bodies["deck"].acceleration
    print("base peak", peak.value / (30 * G) - 1.0, "step", r.timestep)
    # The motion is a closed form, so that the step does not excuse more than the 1e-4 that a response keeps by default.
    assert peak.value == pytest.approx(30 * G, rel=1e-4)
    assert peak.time == pytest.approx(0.0033 + 0.0055, abs=0.05 * r.timestep)


def test_streaming_does_not_write_over_a_response(tmp_path):
    soft = sdof(wr.KelvinVoigt(k=3e3, c=5.0))
    shock = wr.HalfSine(peak=G, duration=0.011, direction="z")
    settings = {"duration": 0.02, "timestep": 1e-3, "initial": "unloaded", "out": tmp_path}
    first = wr.simulate(soft, shock, **settings)
    with pytest.raises(wr.RecordError, match="a response stands here already"):
        wr.simulate(soft, shock, **settings)
    assert first.mounts["m1"].hysteretic_state.shape == (first.time.size, 3)


def test_a_file_that_another_has_taken_the_place_of_is_read_as_it_is_now(response, tmp_path):
    response.save(tmp_path)
    loaded = wr.load_response(tmp_path)
    np.testing.assert_array_equal(loaded.column("time"), response.time)
    path = tmp_path / "response.parquet"
    table = pq.read_table(path)
    pq.write_table(table, tmp_path / "other", compression="gzip", row_group_size=7)
    (tmp_path / "other").replace(path)
    name = loaded.samples.names[-1]
    np.testing.assert_array_equal(loaded.column(name), table[name].to_numpy())
