"""Twenty virtual tests that calibrations must not be fooled by: noise, clipping, delay, gain, and truths of another law.

    python tests/virtual_tests.py 20 --seed 1

The truth is a system whose isolators have other numbers than the model's, in every second test another law as well. It is
shaken, measured with 2 % noise, clipped at 95 % of the peak, 0.3 ms late and 2 % too large, and the model is calibrated to
that; then another level and another pulse are predicted. Coverage of the 90 % intervals and bands is counted.
"""

import argparse
import time
import warnings
from functools import cache

import numpy as np
from house import sdof

import wirerope_mj as wr
from wirerope_mj.motions.records.checks import flat_tops
from wirerope_mj.motions.records.measured import MeasuredChannel
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.studies.calibration import MeasuredTest, calibrate
from wirerope_mj.studies.calibration.calibrate import DISCREPANT
from wirerope_mj.studies.calibration.predict import predict

RATE = 10_000.0


def measured(response, subject, axis, rng, *, noise=0.02, gain=1.02, delay=3e-4, clip=0.95):
    """Return the acceleration of a body or point as a poor chain measures it."""
    kind, name = subject.split("/")
    history = getattr(response, {"body": "bodies", "point": "points"}[kind])[name].acceleration[:, "xyz".index(axis)]
    values = gain * np.interp(response.time - delay, response.time, history)
    values = values + noise * np.abs(values).max() * rng.standard_normal(values.size)
    limit = clip * np.abs(values).max()
    values = np.clip(values, -limit, limit)
    return MeasuredChannel(
        subject=subject, quantity="acceleration", axis=axis, time=response.time, values=values,
        saturated=np.isin(values, [extreme for extreme, _ in flat_tops(values)]), column=subject, unit="m/s^2",
    )  # fmt: skip


CHAIN = ["channel/*/gain = Normal(1, 0.02)", "channel/*/delay = Normal(0, 0.0005)"]


NOMINAL = wr.AsymmetricBoucWen(alpha=1e5, beta=150.0, gamma=30.0, n=1.0, k1=8e4, k2=1e5, k3=2e7, b=2.0, c=6.0)
SIZES = (1e-3, 4e-3, 12e-3, 30e-3)


@cache
def as_masing(law):
    """Return the law of Jenkin elements that is nearest to a law in cycles of 1 to 30 mm: another law for a truth."""
    return wr.identify(wr.cyclic_test(law, SIZES), law=wr.Masing, elements=4, free=("k2", "k3"), profiles=False).law


def of_another_law(isolator):
    """Return an isolator whose laws are Jenkin elements."""
    axes = {axis: law if law is None else as_masing(law) for axis, law in isolator.axes.items()}
    return wr.Isolator(name=isolator.name, limits=isolator.limits, geometry=isolator.geometry, **axes)


def single_mass(isolators):
    """Return a mass on one vertical isolator."""
    return sdof(isolators["a"].axial if isolators else NOMINAL, mass=20.0, gravity=9.80665)


def shipped(name):
    """Return what loads a shipped model."""
    return lambda isolators: wr.load_system(name, isolators=isolators)


def drawn(rng, load, body, other_law):
    """Return a system, its truth with other stiffness, damping and mass, and their values by what varies."""
    system = load(None)
    stiffness, damping, mass = rng.uniform(0.8, 1.25), rng.uniform(0.8, 1.25), 1.0 + 0.03 * rng.standard_normal()
    truth = system
    if other_law:
        truth = load({k: one if one.is_stop else of_another_law(one) for k, one in system.isolators.items()})
    changed = {
        mount: one.written.scaled(stiffness).with_damping(damping)
        for mount, one in truth.mounts.items()
        if not one.isolator.is_stop
    }
    truth = wr.varied(truth, isolators=changed, masses={body: mass})
    priors = {
        "mount/*/stiffness": (stiffness, "Uniform(0.5, 1.7)"),
        "mount/*/damping": (damping, "Uniform(0.4, 1.8)"),
        f"body/{body}/mass": (mass, "Normal(1, 0.03, relative)"),
    }
    return system, truth, priors


def farthest(system, peaks):
    """Return mount and axis of the largest deflection along one axis, and its extremes [m]."""
    ends = {
        (name, axis): (
            float(peaks.mounts[name].deflection.minimum[k]),
            float(peaks.mounts[name].deflection.maximum[k]),
        )
        for name, one in system.mounts.items()
        for k, axis in enumerate(AXES)
        if not one.isolator.is_stop
    }
    name, axis = max(ends, key=lambda one: max(np.abs(ends[one])))
    return name, axis, ends[name, axis]


def secant(law, first, last):
    """Return the secant stiffness of a law's cycle between two deflections [N/m]."""
    (loop,) = wr.cyclic_test(law, [0.5 * (last - first)], operating_point=0.5 * (last + first))
    return loop.secant_stiffness


def one_test(number, seed, case, other_law):
    """Run one virtual test and return what is covered: (name, inside, error, half width) of values and of predictions."""
    load, body, axis, levels = case
    rng = np.random.default_rng([seed, number])
    system, truth, priors = drawn(rng, load, body, other_law)
    levels = rng.uniform(0.8, 1.25) * np.array(levels)
    values, vary = {k: v for k, (v, _) in priors.items()}, [f"{k} = {one}" for k, (_, one) in priors.items()]
    tests = []
    for level in levels:
        motion = wr.HalfSine(peak=level, duration=0.011, direction=axis, start=0.02)
        response = wr.simulate(truth, motion, duration=0.6, sample_rate=RATE, accuracy=1e-3)
        tests.append(MeasuredTest(name=f"{level:g}", motion=motion, channels=[measured(response, f"body/{body}", axis, rng)]))
    begin = time.perf_counter(), time.process_time()
    found = calibrate(system, tests, vary=[*vary, *CHAIN])
    took = time.perf_counter() - begin[0], time.process_time() - begin[1]
    values = values | {"channel/*/gain": 1.02, "channel/*/delay": 3e-4}
    known = dict(zip(found.names, found.samples.T, strict=True))
    if other_law:  # factors on a law that the truth does not have are compared as what they do
        del known["mount/*/stiffness"], known["mount/*/damping"]
        mount, way, (low, high) = farthest(system, response.peaks)
        draws = [found.forward.isolators_at(row)[mount].axes[way] for row in found.samples[:100]]
        small = SMALL * max(-low, high)
        for first, last in ((-small, small), (low, high)):  # no cycle leaves what was tested
            name = f"{way} stiffness, {1e3 * first:.2g} to {1e3 * last:.2g} mm"
            known[name] = np.array([secant(law, first, last) for law in draws])
            values[name] = secant(truth.mounts[mount].written.axes[way], first, last)
    rows = []
    for name, samples in known.items():
        low, middle, high = np.quantile(samples, [0.05, 0.5, 0.95])
        true = values[name]
        rows.append((name, low <= true <= high, middle / true - 1.0, (high - low) / 2 / true))
    predictions = []
    for motion in (
        wr.HalfSine(peak=1.6 * max(levels), duration=0.011, direction=axis, start=0.02),
        wr.Sawtooth(peak=max(levels), duration=0.02, direction=axis, start=0.02),
    ):
        expected = predict(found, motion, duration=0.4)
        peaks = wr.simulate(truth, motion, duration=0.4, accuracy=1e-3).peaks
        worst, way, _ = farthest(system, peaks)
        true = {
            f"acceleration/{body}": peaks.bodies[body].acceleration.value,
            f"force/{worst}": peaks.mounts[worst].force.value,
        }
        peak, k = peaks.mounts[worst].deflection, AXES.index(way)
        side = way if way != "axial" else "compression" if -peak.minimum[2] > peak.maximum[2] else "tension"
        true[f"deflection/{worst}/{side}"] = max(-float(peak.minimum[k]), float(peak.maximum[k]))
        for name, value in true.items():
            low, high = expected.band(name)
            middle = 0.5 * (low + high)
            predictions.append((name, low <= value <= high, middle / value - 1.0, (high - low) / 2 / value))
    return found, took, rows, predictions


SMALL = 0.2
"""Part of the largest tested deflection at which the stiffness of another law is compared in small cycles."""

CASES = [
    (single_mass, "mass", "z", (60.0, 150.0)),
    (shipped("shock_table"), "block", "z", (80.0, 200.0)),
    (shipped("cabinet"), "rack", "x", (60.0,)),
]
"""Model, body whose acceleration is measured, direction of the shock, levels [m/s^2]."""


def main():
    """Print every test and the coverage of all."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("tests", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--case", type=int, default=None)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    parameters, predicted, sure = [], [], []
    for number in range(asked.first, asked.first + asked.tests):
        case = CASES[number % len(CASES) if asked.case is None else asked.case]
        other = number % 2 == 1
        found, took, rows, predictions = one_test(number, asked.seed, case, other)
        wall, cpu = took
        law = "another law" if other else "same law"
        print(f"test {number}, {law}: {wall:.0f} s ({cpu:.0f} s of a processor), {found.message}", flush=True)
        for name, inside, error, half in (*rows, *predictions):
            print(f"  {name:28s} {'inside' if inside else 'OUTSIDE'}  {100 * error:+.2f} %, half width {100 * half:.2f} %")
        parameters += [inside for _, inside, *_ in rows]
        predicted += [inside for _, inside, *_ in predictions]
        sure += [
            f"{number}: {name}"
            for name, _, error, half in (*rows, *predictions)
            if abs(error) > 2.0 * half and found.discrepancies.max() < DISCREPANT
        ]
    for name, inside in (("parameters", parameters), ("predictions", predicted)):
        print(f"{name} within their 90 % intervals: {sum(inside)} of {len(inside)}, {100 * np.mean(inside):.0f} %")
    print(f"false confidence, off by more than twice a half width without a word on the model's error: {sure or 'none'}")


if __name__ == "__main__":
    main()
