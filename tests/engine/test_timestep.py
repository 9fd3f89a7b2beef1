"""The step that is chosen before the run, judged by halving it over the whole run."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.foundation.resources import models_folder

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

G = wr.STANDARD_GRAVITY
ACCURACY = 1e-4
SAMPLE_RATE = 50.0  # slow enough that samples do not force the step

MODELS = ("sdof_shaker", "shock_table", "floating_floor", "cabinet")
START = 0.0213  # off the sample grid, so that the corners are the motion's own


def motions(direction):
    yield "half-sine", wr.HalfSine(peak=5 * G, duration=0.011, direction=direction, start=START), 0.5
    yield "sawtooth", wr.Sawtooth(peak=5 * G, duration=0.011, direction=direction, start=START), 0.5
    yield "trapezoid", wr.Trapezoid(peak=4 * G, duration=0.011, rise=0.002, direction=direction, start=START), 0.5
    yield "velocity step", wr.VelocityStep(velocity=0.4, direction=direction, start=START), 0.5
    yield "sine", wr.Sine(frequency=12.0, acceleration=2.0, direction=direction), 0.6
    yield "sweep", wr.Sweep(start=5.0, stop=30.0, rate=60.0, acceleration=2.0, direction="z"), 2.5


@pytest.fixture(scope="module", params=MODELS)
def system(request):
    return wr.load_system(models_folder() / f"{request.param}.xml")


def differences(a, b):
    """Largest differences of samples and of peaks of every tracked quantity, relative to its peak, and of its kind's."""
    scales, parts = {}, {}
    for room, kinds in (("bodies", ("acceleration",)), ("mounts", ("deflection", "force"))):
        for name, peaks in getattr(b.peaks, room).items():
            if name == b.scene.base:
                continue
            for kind in kinds:
                peak, other = getattr(peaks, kind), getattr(getattr(a.peaks, room)[name], kind)
                samples = getattr(getattr(a, room)[name], kind) - getattr(getattr(b, room)[name], kind)
                extremes = [other.value - peak.value, *(other.minimum - peak.minimum), *(other.maximum - peak.maximum)]
                parts[room, kind, name] = max(np.linalg.norm(samples, axis=1).max(), np.abs(extremes).max())
                scales[room, kind, name] = peak.value
    largest = {key[:2]: max(v for k, v in scales.items() if k[:2] == key[:2]) for key in scales}
    # A mount that hardly moves is judged against a thousandth of the one that moves most.
    return max(part / max(scales[key], 1e-3 * largest[key[:2]]) for key, part in parts.items())


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the base moves at up to 30 Hz")
@pytest.mark.parametrize("which", range(6), ids=["half-sine", "sawtooth", "trapezoid", "step", "sine", "sweep"])
def test_chosen_step_keeps_the_accuracy_and_is_not_a_sixth_of_what_would(system, which):
    direction = "z" if len(system.assembly.driven_dofs) == 1 else (1.0, 0.7, 1.0)
    name, motion, duration = list(motions(direction))[which]
    options = {"duration": duration, "sample_rate": SAMPLE_RATE}
    response = wr.simulate(system, motion, accuracy=ACCURACY, **options)
    step = response.timestep

    def error(timestep):
        coarse = wr.simulate(system, motion, timestep=timestep, **options)
        return differences(coarse, wr.simulate(system, motion, timestep=timestep / 2, **options))

    assert error(step) <= ACCURACY
    assert response.estimated_error <= ACCURACY
    # Of two pilots the finer is taken, as it is there already: its double may do. Three times that, and more, must fail: 6.2
    # leaves room for steps that are cut to fit an interval.
    for factor in (6.2, 9.0, 12.0):
        if factor * step <= min(1.0 / SAMPLE_RATE, stable_step(system)):
            assert error(factor * step) > ACCURACY, f"{name}: {factor} times the step would do"


def test_tighter_accuracy_takes_a_smaller_step(system):
    motion = wr.HalfSine(peak=5 * G, duration=0.011, direction="z", start=START)
    steps = [
        wr.simulate(system, motion, duration=0.2, sample_rate=SAMPLE_RATE, accuracy=accuracy).timestep
        for accuracy in (1e-3, 1e-5)
    ]
    # Order 2: a hundredth of the error takes about a tenth of the step, less where both yield within a step.
    assert steps[1] < steps[0] / 3


def test_bottoming_on_contacts_reports_the_accuracy_it_reached():
    system = wr.load_system(models_folder() / "shock_table_contacts.xml")
    motion = wr.HalfSine(peak=40 * G, duration=0.011, direction="z", start=0.02)
    with pytest.warns(wr.AccuracyWarning) as told:
        response = wr.simulate(system, motion, duration=0.2)
    assert any("struck" in str(one.message) for one in told)
    assert any("above the accuracy asked for" in str(one.message) for one in told)
    travel = system.mounts["m1"].isolator.limits.travel.compression
    assert -response.peaks.mounts["m1"].deflection.minimum[2] > travel, "the case is meant to bottom"
    assert np.isfinite(response.estimated_error)


def test_a_system_that_rests_until_the_end_is_not_chased_into_its_rounding():
    pulse = wr.HalfSine(peak=50.0, duration=0.011, direction="z", start=0.05)
    r = wr.simulate(wr.load_system(models_folder() / "shock_table.xml"), pulse, duration=0.05)
    assert r.peaks.bodies["block"].acceleration.value < 1e-8
    assert r.timestep == pytest.approx(1e-3, rel=1e-9)  # the sample interval
