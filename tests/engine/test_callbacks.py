"""The callbacks: native and Python agree, runs repeat bit by bit, restarts go on identically, and nothing is left behind."""

import json
import os
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from house import deck, hysteresis, mjcf, sdof, sdof_text

import wirerope_mj as wr
from wirerope_mj.engine.control import install
from wirerope_mj.foundation.resources import models_folder

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

G = wr.STANDARD_GRAVITY
LAW = wr.BoucWen(**hysteresis(alpha=1e5, z_max=60.0), k=2e4)
SHOCK = wr.HalfSine(peak=30 * G, duration=0.011, direction="z", start=0.0075)
INSTALLED = (mujoco.get_mjcb_control, mujoco.get_mjcb_act_dyn, mujoco.get_mjcb_sensor, mujoco.get_mju_user_warning)
LARGER_WAIT = 120  # seconds for a fresh interpreter that runs the kernels as plain Python on a busy machine


@pytest.fixture(scope="module")
def floor():
    return wr.load_system(models_folder() / "floating_floor.xml")


def shock(direction=(1.0, 2.0, 3.0)):
    return wr.HalfSine(peak=10 * G, duration=0.011, direction=direction, start=0.0075)


def everything(r):
    """Return all samples of a response, (n_t, n_columns)."""
    return r.samples.columns(0, len(r.samples.names))


def test_native_and_python_callback_agree_over_a_shock(floor):
    native, python = (
        wr.simulate(floor, shock(), duration=0.1, timestep=5e-4, callback=callback, engine="mujoco")
        for callback in ("native", "python")
    )
    assert native.numerics.callback == "native"
    assert python.numerics.callback == "python"
    names = native.samples.names
    a, b = everything(native), everything(python)
    largest = 0.0
    for quantity in ("deflection", "force", "state", "acceleration", "position", "orientation", "angular_velocity"):
        columns = [i for i, name in enumerate(names) if f"/{quantity}/" in name]
        assert columns
        largest = max(largest, np.abs(a[:, columns] - b[:, columns]).max() / np.abs(a[:, columns]).max())
    print("native against python", largest)
    # The same kernels and the same engine: only the order of a few roundings may differ.
    assert largest < 1e-10
    for mount, peaks in native.peaks.mounts.items():
        assert python.peaks.mounts[mount].force.value == pytest.approx(peaks.force.value, rel=1e-10)


def test_z_does_not_exceed_its_bound():
    r = wr.simulate(
        sdof(LAW),
        wr.HalfSine(peak=60 * G, duration=0.02, direction="z"),
        duration=0.3,
        timestep=1e-4,
        initial="unloaded",
    )
    z = np.abs(r.mounts["m1"].hysteretic_state[:, 2])
    print("z / z_max - 1 =", z.max() / LAW.z_max - 1.0)
    # It is driven far past its bound, so it must come close; RK4 at 1e-4 s errs by 1e-4 of it at the most.
    assert 0.999 * LAW.z_max < z.max() < (1.0 + 1e-4) * LAW.z_max


def test_z_of_the_floor_stays_within_its_bounds(floor):
    r = wr.simulate(floor, shock(), duration=0.3, timestep=5e-4)
    for name, mount in floor.mounts.items():
        for axis, law in enumerate(mount.isolator.axes.values()):
            if getattr(law, "z_max", np.inf) < np.inf:
                # The integration error of 5e-4 s, seen at the sharpest of the catalogue's loops.
                assert np.abs(r.mounts[name].hysteretic_state[:, axis]).max() <= (1.0 + 1e-3) * law.z_max


def test_two_runs_are_bit_identical(floor):
    a, b = (wr.simulate(floor, shock(), duration=0.05, timestep=5e-4) for _ in range(2))
    assert everything(a).tobytes() == everything(b).tobytes()
    assert a.final_state.values.tobytes() == b.final_state.values.tobytes()
    assert a.peaks.to_dict() == b.peaks.to_dict()


@pytest.mark.parametrize("callback", ["native", "python"])
def test_a_run_restarted_from_its_final_state_goes_on_identically(floor, callback):
    settings = {"timestep": 5e-4, "callback": callback}
    # The cut lies inside the pulse, where the base accelerates.
    whole = wr.simulate(floor, shock(), duration=0.06, **settings)
    first = wr.simulate(floor, shock(), duration=0.012, **settings)
    assert first.final_state.time == 0.012
    second = wr.simulate(floor, shock(), duration=0.048, initial=first.final_state, **settings)
    n = first.time.size
    assert second.time[0] == first.time[-1]
    np.testing.assert_array_equal(np.concatenate([first.time[:-1], second.time]), whole.time)
    assert everything(second)[1:].tobytes() == everything(whole)[n:].tobytes()
    assert everything(first)[:-1].tobytes() == everything(whole)[: n - 1].tobytes()
    # The shared instant is seen from both sides of it; the acceleration of a half-sine is continuous there, to the 1e-10 s
    # that separate the sides.
    np.testing.assert_allclose(everything(second)[0], everything(whole)[n - 1], rtol=1e-9, atol=1e-9)
    assert motion_of(floor, second.final_state) == motion_of(floor, whole.final_state)


def motion_of(system, state):
    """Return positions, velocities and internal states in a State as bytes, without what peaks were met on the way."""
    data = mujoco.MjData(system.model)
    mujoco.mj_setState(system.model, data, state.values, mujoco.mjtState.mjSTATE_INTEGRATION)
    return data.qpos.tobytes() + data.qvel.tobytes() + data.act.tobytes()


def test_a_restart_at_the_corner_of_a_pulse_goes_on_identically():
    system = sdof(LAW)
    saw = wr.Sawtooth(peak=30 * G, duration=0.01, direction="z", start=0.005)
    settings = {"timestep": 1e-4, "initial": "unloaded"}
    whole = wr.simulate(system, saw, duration=0.05, **settings)
    first = wr.simulate(system, saw, duration=0.015, **settings)
    second = wr.simulate(system, saw, duration=0.035, **{**settings, "initial": first.final_state})
    assert everything(second).tobytes() == everything(whole)[first.time.size - 1 :].tobytes()


def test_a_velocity_step_at_the_restart_is_applied_once():
    system = sdof(LAW)
    step = wr.VelocityStep(velocity=2.0, direction="z", start=0.01)
    settings = {"timestep": 1e-4, "initial": "unloaded"}
    whole = wr.simulate(system, step, duration=0.05, **settings)
    first = wr.simulate(system, step, duration=0.01, **settings)
    second = wr.simulate(system, step, duration=0.04, **{**settings, "initial": first.final_state})
    assert everything(second)[1:].tobytes() == everything(whole)[first.time.size :].tobytes()
    assert whole.bodies["deck"].velocity[-1, 2] == pytest.approx(2.0, rel=1e-9)


def test_simulate_leaves_no_callback_behind():
    before = [get() for get in INSTALLED]
    assert before == [None] * 4
    wr.simulate(sdof(LAW), SHOCK, duration=0.02, timestep=1e-4, initial="unloaded")
    assert [get() for get in INSTALLED] == before
    wr.simulate(sdof(LAW), SHOCK, duration=0.02, timestep=1e-4, initial="unloaded", callback="python")
    assert [get() for get in INSTALLED] == before
    blown = wr.HalfSine(peak=1e9 * G, duration=0.011, direction="z")
    stiffening = wr.SymmetricBoucWen(**hysteresis(alpha=1e5, z_max=60.0), k1=2e4, k2=0.0, k3=1e9)
    for callback in ("native", "python"):
        with pytest.raises(wr.SimulationError):
            wr.simulate(
                sdof(stiffening),
                blown,
                duration=0.1,
                timestep=1e-3,
                initial="unloaded",
                callback=callback,
                engine="mujoco",
            )
        assert [get() for get in INSTALLED] == before
    wr.equilibrium(sdof(LAW, gravity=G))
    assert [get() for get in INSTALLED] == before


def test_an_interrupt_leaves_no_callback_behind(tmp_path, monkeypatch):
    from wirerope_mj.engine.simulation import run as module

    def interrupted(*_args, **_kwargs):
        raise KeyboardInterrupt

    monkeypatch.setattr(module.Stepper, "check", interrupted)
    with pytest.raises(KeyboardInterrupt):
        wr.simulate(sdof(LAW), SHOCK, duration=0.02, timestep=1e-4, initial="unloaded", out=tmp_path, engine="mujoco")
    assert [get() for get in INSTALLED] == [None] * 4
    assert list(tmp_path.iterdir()) == []


CALLBACKS = ("control", "act_dyn", "sensor", "passive", "act_gain", "act_bias", "contactfilter")


@pytest.mark.parametrize("name", CALLBACKS)
def test_a_callback_of_the_process_is_refused_by_name_in_every_room(name):
    system = sdof(LAW, gravity=G)
    relaxed = wr.equilibrium(system, history="relaxed").state
    rooms = [
        lambda: wr.load_system(sdof_text(), isolators={"a": wr.Isolator(name="a", axial=LAW)}),
        lambda: wr.equilibrium(system),
        lambda: wr.modes(system, history="relaxed"),  # of an equilibrium that is known
        *(
            lambda engine=engine: wr.simulate(system, SHOCK, duration=0.02, timestep=1e-4, initial=relaxed, engine=engine)
            for engine in ("auto", "mujoco")
        ),
        lambda: wr.simulate_batch([system], SHOCK, duration=0.02, timestep=1e-4, initial=relaxed),
    ]
    mine = lambda *_: 0.0  # noqa: E731
    set_callback, get_callback = (getattr(mujoco, f"{verb}_mjcb_{name}") for verb in ("set", "get"))
    set_callback(mine)
    try:
        for room in rooms:
            with pytest.raises(wr.SimulationError, match=rf"`mjcb_{name}` of this process is set.*set_mjcb_{name}\(None\)"):
                room()
            assert get_callback() is mine
    finally:
        set_callback(None)
    wr.simulate(system, SHOCK, duration=0.02, timestep=1e-4, initial=relaxed, engine="mujoco")
    assert get_callback() is None


def test_callbacks_that_another_thread_installs_meanwhile_are_not_taken_for_foreign_ones(monkeypatch):
    class Lock:
        def __enter__(self):
            pass

        def __exit__(self, *_):
            mujoco.set_mjcb_control(lambda *_: None)  # as a thread that waited for the lock does

    monkeypatch.setattr(install, "_lock", Lock())
    try:
        install.check_callbacks()
    finally:
        mujoco.set_mjcb_control(None)


def test_the_mounts_act_on_a_model_beside_one_that_is_not_ours():
    from wirerope_mj.engine.control import installed

    other = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><joint name="j" type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody>'
        '<actuator><motor joint="j"/></actuator></mujoco>'
    )
    system = sdof(LAW)
    data, foreign = mujoco.MjData(system.model), mujoco.MjData(other)
    with installed(system.model, data):
        mujoco.mj_step(other, foreign)
    assert foreign.time > 0.0
    assert foreign.qvel[0] == pytest.approx(-9.81 * other.opt.timestep, rel=1e-12)


SCRIPT = """
import json, sys, warnings
import wirerope_mj as wr
text, law, shock = json.loads(sys.argv[1])
system = wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=wr.BoucWen(**law))})
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    r = wr.simulate(system, wr.HalfSine(**shock), duration=0.03, timestep=5e-4, initial="unloaded")
print(json.dumps({
    "force": r.mounts["m1"].force[:, 2].tolist(), "z": r.mounts["m1"].hysteretic_state[:, 2].tolist(),
    "callback": r.numerics.callback, "warnings": [str(w.message) for w in caught if w.category is RuntimeWarning],
}))
"""


def test_without_the_compiler_the_plain_kernels_give_the_same():
    law = {**hysteresis(alpha=1e5, z_max=60.0), "k": 2e4}
    pulse = {"peak": 30 * G, "duration": 0.011, "direction": "z", "start": 0.002}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, json.dumps([sdof_text(), law, pulse])],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, cwd=Path(wr.__file__).parents[1],
        capture_output=True, text=True, timeout=LARGER_WAIT, check=True,
    )  # fmt: skip
    plain = json.loads(done.stdout)
    assert plain["callback"] == "python"
    assert any("Python callback" in text for text in plain["warnings"]), plain["warnings"]
    r = wr.simulate(sdof(wr.BoucWen(**law)), wr.HalfSine(**pulse), duration=0.03, timestep=5e-4, initial="unloaded")
    for name, values in (("force", r.mounts["m1"].force), ("z", r.mounts["m1"].hysteretic_state)):
        # Compiled code may fuse a product and a sum and has its own pow: a few roundings, 1e-12 of the peak.
        np.testing.assert_allclose(plain[name], values[:, 2], rtol=0, atol=1e-12 * np.abs(values).max())


def test_native_reads_isolators_from_the_model_itself():
    """Two systems with different laws are stepped in turn under one callback."""
    soft, stiff = (sdof(wr.KelvinVoigt(k=k, c=10.0)) for k in (1e4, 4e4))
    runs = [wr.simulate(s, SHOCK, duration=0.05, timestep=1e-4, initial="unloaded") for s in (soft, stiff, soft)]
    assert everything(runs[0]).tobytes() == everything(runs[2]).tobytes()
    for r, k in zip(runs, (1e4, 4e4), strict=False):
        m = r.mounts["m1"]
        rate = r.bodies["mass"].velocity[:, 2] - r.bodies["deck"].velocity[:, 2]
        # The law itself, of recorded samples: rounding only.
        force = k * m.deflection[:, 2] + 10.0 * rate
        np.testing.assert_allclose(m.force[:, 2], force, atol=1e-10 * np.abs(force).max())


def test_user_data_and_actuators_of_the_model_stay_its_own():
    text = mjcf(
        deck({"b": 'pos="0 0 .2"'}, slides="z")
        + '<body name="mass" pos="0 0 .3"><joint name="z" type="slide" axis="0 0 1"/><geom size=".1" mass="3.5"/>'
        '<site name="p" pos="0 0 -.1"/></body>',
        [("m1", "p", "b", "a")],
        other='<size nuserdata="3"/><actuator><motor name="own" joint="z"/></actuator>',
    )
    system = wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=LAW)})
    a = wr.simulate(system, SHOCK, duration=0.02, timestep=1e-4, initial="unloaded")
    b = wr.simulate(sdof(LAW), SHOCK, duration=0.02, timestep=1e-4, initial="unloaded")
    assert system.model.actuator(0).name == "own"
    np.testing.assert_allclose(a.mounts["m1"].force, b.mounts["m1"].force, rtol=0, atol=1e-9)


def test_threads_share_the_native_callback():
    from concurrent.futures import ThreadPoolExecutor

    laws = [wr.KelvinVoigt(k=k, c=10.0) for k in (1e4, 2e4, 3e4, 4e4)]
    every = [sdof(law) for law in laws]

    def one(system):
        return everything(wr.simulate(system, SHOCK, duration=0.2, timestep=1e-4, initial="unloaded")).tobytes()

    alone = [one(system) for system in every]
    with ThreadPoolExecutor(2) as pool:
        together = list(pool.map(one, every))
    assert together == alone
    assert [get() for get in INSTALLED] == [None] * 4


def test_two_kinds_of_callback_cannot_step_at_once():
    from wirerope_mj.engine.control import installed

    system = sdof(LAW)
    with (
        installed(system.model, mujoco.MjData(system.model)),
        pytest.raises(wr.SimulationError, match="another thread is stepping with the native callback"),
    ):
        wr.simulate(system, SHOCK, duration=0.02, timestep=1e-4, initial="unloaded", callback="python")
    assert [get() for get in INSTALLED] == [None] * 4


def test_a_restart_at_a_coarse_step_goes_on_identically():
    soft = sdof(wr.BoucWen(**hysteresis(alpha=1e4, z_max=60.0), k=5e3))
    settings = {"timestep": 1e-3, "initial": "unloaded"}
    whole = wr.simulate(soft, SHOCK, duration=0.1, **settings)
    first = wr.simulate(soft, SHOCK, duration=0.05, **settings)
    second = wr.simulate(soft, SHOCK, duration=0.05, **{**settings, "initial": first.final_state})
    assert everything(second)[1:].tobytes() == everything(whole)[first.time.size :].tobytes()
