"""The kernel against MuJoCo: whole runs of what ships, bits in any company, and what it leaves to MuJoCo."""

import warnings

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.engine.kernel.steps import advance
from wirerope_mj.foundation.resources import scenarios_folder

# Routes of one step are compared with each other, at steps that are coarse for friction.
pytestmark = pytest.mark.filterwarnings("ignore:the given step of")

G = wr.STANDARD_GRAVITY
AGREEMENT = 1e-9
"""Of the peaks: rounding of either engine is 1e-12 to 1e-10 after thousands of steps, and the error of a step far more."""

SCENARIOS = sorted(path.stem for path in scenarios_folder().glob("*.py"))
FASTER = {"floating_floor_sweep": {"rate": 8.0}}
"""A fifth of the sweep's steps, through the same resonances: its peaks are those of the slow one within 0.3 %."""

SHOCK = wr.HalfSine(peak=8 * G, duration=0.011, direction="z", start=0.02)


def apart(one, other):
    """Largest differences of histories and peaks, relative to the peak of their kind, by kind."""
    found = {}
    for room, kinds in (
        ("bodies", ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")),
        ("points", ("acceleration", "relative_displacement")),
        ("mounts", ("deflection", "force", "hysteretic_state")),
    ):
        here, there = getattr(one, room), getattr(other, room)
        assert here.keys() == there.keys()
        for kind in kinds:
            pairs = [(getattr(here[name], kind), getattr(there[name], kind)) for name in here]
            scale = max((np.abs(b).max() for _, b in pairs), default=0.0)
            difference = max((np.abs(a - b).max() for a, b in pairs), default=0.0)
            found[kind] = max(found.get(kind, 0.0), difference / scale if scale > 1e-12 else 0.0)
    for room in ("bodies", "points", "mounts"):
        for name, peaks in getattr(one.peaks, room).items():
            for kind in peaks.__dataclass_fields__:
                a, b = getattr(peaks, kind), getattr(getattr(other.peaks, room)[name], kind)
                largest = max(b.value, 1e-6)
                extremes = np.abs([a.value - b.value, *(a.minimum - b.minimum), *(a.maximum - b.maximum)]).max()
                found["peaks"] = max(found.get("peaks", 0.0), extremes / largest)
    return found


def both(system, motion, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.AccuracyWarning)  # contacts are a verdict of their own
        return [wr.simulate(system, motion, engine=engine, **options) for engine in ("kernel", "mujoco")]


def scenario_runs(name, duration, **given):
    """Return a scenario's runs by both, with the step that a run of it takes: MuJoCo takes what the kernel chooses."""
    scenario = wr.load_scenario(name).make(**given)
    system = wr.load_system(scenario.model_source(), isolators=scenario.isolators)
    options = dict(scenario.simulate)
    options.pop("callback", None)
    options["duration"] = min(options["duration"], duration)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.AccuracyWarning)  # contacts are a verdict of their own
        kernel = wr.simulate(system, scenario.motion, engine="kernel", **options)
        options.pop("accuracy", None)
        options["timestep"] = kernel.numerics.timestep
        return kernel, wr.simulate(system, scenario.motion, engine="mujoco", **options)


@pytest.mark.parametrize("name", SCENARIOS)
def test_the_first_second_of_every_scenario_is_mujocos(name):
    kernel, mujoco = scenario_runs(name, 1.0)
    assert (kernel.numerics.engine, mujoco.numerics.engine) == ("kernel", "mujoco")
    assert kernel.numerics.steps == mujoco.numerics.steps
    assert max(apart(kernel, mujoco).values()) < AGREEMENT, apart(kernel, mujoco)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENARIOS)
def test_the_whole_of_every_scenario_is_mujocos(name):
    kernel, mujoco = scenario_runs(name, np.inf, **FASTER.get(name, {}))
    assert max(apart(kernel, mujoco).values()) < AGREEMENT, apart(kernel, mujoco)


@pytest.mark.quick
def test_a_variant_has_the_same_bits_alone_in_a_batch_and_on_two_threads():
    base = wr.load_system("shock_table")
    systems = [wr.varied(base, masses={"block": 1.0 + 0.03 * i}) for i in range(7)]
    motions = [wr.HalfSine(peak=(5 + i) * G, duration=0.011, direction="z", start=0.02) for i in range(7)]
    options = {"duration": 0.1, "timestep": 5e-4}
    together = wr.simulate_batch(systems, motions, threads=2, **options)
    assert {one.engine for one in together} == {"kernel"}
    backwards = wr.simulate_batch(systems[::-1], motions[::-1], threads=1, **options)[::-1]
    for system, motion, one, other in zip(systems, motions, together, backwards, strict=True):
        alone = wr.simulate(system, motion, **options)
        for result in (one, other):
            assert np.array_equal(result.final_state.values, alone.final_state.values)
            assert result.peaks.to_dict() == alone.peaks.to_dict()


def mjcf(payload, *, joints="", tail="", deck=""):
    return f"""<mujoco><compiler autolimits="true"/><option gravity="0 0 -9.80665"/><worldbody>
      <body name="deck"><joint name="dz" type="slide" axis="0 0 1"/>{deck}<geom size=".2 .2 .01" type="box" mass="5"
        contype="0" conaffinity="0"/><site name="b" pos="0 0 .1"/></body>
      <body name="load" pos="0 0 .2">{joints}<geom name="box" type="box" size=".1 .1 .05" mass="20" {payload}/>
        <site name="p" pos="0 0 -.1"/></body>
    </worldbody><custom><text name="isolator/i" data="i.toml"/><tuple name="mount/m"><element objtype="site" objname="p"/>
      <element objtype="site" objname="b"/><element objtype="text" objname="isolator/i"/></tuple></custom>{tail}</mujoco>"""


LAW = wr.BoucWen(alpha=3e4, beta=40.0, gamma=20.0, n=1.0, k=4e4)
ISOLATOR = wr.Isolator(name="i", roll=LAW, shear=LAW, axial=LAW)
QUIET = 'contype="0" conaffinity="0"'
SLIDE = '<joint name="z" type="slide" axis="0 0 1"/>'


def load(text):
    return wr.load_system(text, isolators={"i": ISOLATOR})


@pytest.mark.quick
@pytest.mark.parametrize(
    ("joints", "tail", "part"),
    [
        (SLIDE, '<tendon><fixed name="t"><joint joint="z" coef="1"/></fixed></tendon>', "tendons"),
        (SLIDE, '<equality><joint joint1="z" active="false"/></equality>', "equality constraints"),
        ('<joint name="ball" type="ball"/>' + SLIDE, "", "ball joints"),
        ('<joint name="z" type="slide" axis="0 0 1" frictionloss="2"/>', "", "dry friction in joints"),
    ],
    ids=["tendon", "equality", "ball", "friction"],
)
def test_what_the_equations_do_not_hold_goes_to_mujoco_and_the_result_says_so(joints, tail, part):
    system = load(mjcf(QUIET, joints=joints, tail=tail))
    r = wr.simulate(system, SHOCK, duration=0.02, timestep=1e-3, initial="unloaded")
    assert r.numerics.engine == "mujoco"
    assert part in r.numerics.why
    with pytest.raises(wr.SimulationError, match=f"the kernel cannot compute this run: the model has .*{part}"):
        wr.simulate(system, SHOCK, duration=0.02, timestep=1e-3, initial="unloaded", engine="kernel")


def test_a_joint_that_comes_to_its_limit_goes_to_mujoco_from_the_start():
    system = load(mjcf(QUIET, joints='<joint name="z" type="slide" axis="0 0 1" range="-.03 .03"/>'))
    gentle = wr.simulate(system, wr.HalfSine(peak=5.0, duration=0.011, direction="z"), duration=0.2, timestep=2e-4)
    hard = wr.simulate(system, SHOCK, duration=0.2, timestep=2e-4)
    assert gentle.numerics.engine == "kernel"
    assert hard.numerics.engine == "mujoco"
    assert hard.numerics.why == "a joint came to its limit"
    alone = wr.simulate(system, SHOCK, duration=0.2, timestep=2e-4, engine="mujoco")
    np.testing.assert_array_equal(hard.bodies["load"].position, alone.bodies["load"].position)


@pytest.mark.filterwarnings("ignore::wirerope_mj.AccuracyWarning")
def test_a_contact_struck_mid_run_goes_to_mujoco_variant_by_variant():
    deck = '<geom name="stop" type="box" size=".1 .1 .01" pos="0 0 .1" mass="1"/>'  # 40 mm below the load
    system = load(mjcf("", joints=SLIDE, deck=deck))
    levels = [0.5, 2.0, 60.0, 1.0]
    shocks = [wr.HalfSine(peak=level * G, duration=0.011, direction="z", start=0.02) for level in levels]
    results = wr.simulate_batch(system, shocks, duration=0.2, timestep=2e-4)
    assert [one.engine for one in results] == ["kernel", "kernel", "mujoco", "kernel"]
    assert "may have touched" in results[2].why
    struck = [contact.touches for contact in results[2].peaks.contacts.values()]
    assert max(struck) > 0
    for one, shock in zip(results, shocks, strict=True):
        by_mujoco = wr.simulate(system, shock, duration=0.2, timestep=2e-4, engine="mujoco")
        assert one.peaks.bodies["load"].acceleration.value == pytest.approx(
            by_mujoco.peaks.bodies["load"].acceleration.value, rel=AGREEMENT
        )


def test_a_base_that_jumps_under_what_rides_on_it_goes_to_mujoco():
    system = wr.load_system("shock_table_frame")
    jump = wr.VelocityStep(velocity=0.5, direction="z", start=0.02)
    r = wr.simulate(system, jump, duration=0.05, timestep=5e-4)
    assert r.numerics.engine == "mujoco"
    assert "velocity jumps" in r.numerics.why
    assert wr.simulate(system, SHOCK, duration=0.05, timestep=5e-4).numerics.engine == "kernel"


def test_chains_of_hinges_and_slides_on_the_base_and_off_it_are_mujocos():
    rocker = (
        '<body name="arm" pos=".05 0 .02"><joint type="hinge" axis="0 1 0" stiffness="800" damping="2" pos="0 0 .01"/>'
        '<joint type="slide" axis="1 0 1" stiffness="9e4" damping="20"/><geom size=".03" mass="2" contype="0" conaffinity="0"/>'
        '<body name="hand" pos="0 .1 .1" quat=".9 .1 .3 .1"><joint type="hinge" axis="1 0 0" stiffness="30" damping="1"/>'
        '<geom size=".03" pos=".02 0 .05" mass="1" contype="0" conaffinity="0"/></body></body>'
    )
    text = mjcf(QUIET, joints='<freejoint/>', deck=rocker).replace('<site name="p"', rocker.replace("arm", "arm2").replace(
        "hand", "hand2") + '<site name="p"')  # fmt: skip
    system = load(text)
    motion = SHOCK + wr.Sine(frequency=8.0, acceleration=3.0, direction="z")
    kernel, mujoco = both(system, motion, duration=0.3, timestep=5e-4, initial="unloaded")
    swing = np.ptp(kernel.bodies["hand"].orientation, axis=0).max()
    assert swing > 3e-3, "half a degree: it is meant to swing"
    # Base and arm push back on each other through the drive's 1e10 kg in both, so that even that agrees.
    assert max(apart(kernel, mujoco).values()) < AGREEMENT, apart(kernel, mujoco)


def test_steps_are_compiled_for_one_layout_of_arrays():
    """The comparison with MuJoCo, a run and a batch hand on arrays of one kind: each further kind is compiled for seconds."""
    system = wr.load_system("shock_table")
    wr.simulate(system, SHOCK, duration=0.02, timestep=1e-3, engine="kernel")
    wr.simulate_batch([system] * 2, SHOCK, duration=0.02, timestep=1e-3, engine="kernel")
    assert len(advance.signatures) == 1
