"""Frequency responses at three levels and loops recover a law's parameters: twenty draws of truth and noise.

    python tests/frequency_draws.py 20 --seed 1

The truth's responses are solutions of harmonic balance, which the calibration does not use; 1 % noise on transmissibilities and
0.5 % on forces.
"""

import argparse
import time
import warnings

import numpy as np
from house import sdof

import wirerope_mj as wr

NOMINAL = {"alpha": 1e5, "beta": 150.0, "gamma": 30.0, "n": 1.0, "k1": 8e4, "k2": 1e5, "k3": 2e7, "b": 2.0, "c": 6.0}
SOUGHT = ("alpha", "beta", "gamma", "k1", "k3", "c")
MASS, GRAVITY = 20.0, 9.80665
LEVELS = (3.0, 7.0, 15.0)
FREQUENCIES = np.geomspace(6.0, 20.0, 8)


def transmissibility(law, level):
    """Return the amplitude at the base's frequency over the base's, by harmonic balance from above, (n_f,)."""
    found, guess = [], None
    for frequency in FREQUENCIES[::-1]:
        orbit = wr.harmonic_balance(
            law,
            mass=MASS,
            frequency=frequency,
            acceleration=level,
            gravity=GRAVITY,
            harmonics=11,
            samples=128,
            guess=guess,
        )
        guess = orbit.coefficients
        relative = -((2.0 * np.pi * frequency) ** 2) * orbit.coefficients[1]
        found.append(abs(-1j * level + relative) / level)
    return np.array(found[::-1])


def one_draw(seed):
    """Return the calibration of one draw and the true factors on the nominal parameters."""
    rng = np.random.default_rng(seed)
    factors = dict(zip(SOUGHT, rng.uniform(0.85, 1.18, len(SOUGHT)), strict=True))
    truth = wr.AsymmetricBoucWen(**{k: v * factors.get(k, 1.0) for k, v in NOMINAL.items()})
    tests = [
        wr.FrequencyTest(
            name=f"{level:g}", payload="mass", acceleration=level, frequency=FREQUENCIES,
            transmissibility=transmissibility(truth, level) * (1.0 + 0.01 * rng.standard_normal(FREQUENCIES.size)),
        )
        for level in LEVELS
    ]  # fmt: skip
    loops = []
    for loop in wr.cyclic_test(truth, [1e-3, 3e-3, 8e-3], points_per_cycle=120):
        noise = 0.005 * 0.5 * np.ptp(loop.force) * rng.standard_normal(loop.force.size)
        noise[-1] = noise[0]
        loops.append(wr.Loop.from_samples(loop.deflection, loop.force + noise))
    system = sdof(wr.AsymmetricBoucWen(**NOMINAL), mass=MASS, gravity=GRAVITY)
    vary = [f"mount/m1/axial/{name} = Uniform(0.6, 1.5, relative)" for name in SOUGHT]
    return wr.calibrate(system, [*tests, wr.LoopTest(name="rig", mount="m1", axis="axial", loops=loops)], vary=vary), factors


def main():
    """Print for each draw by how many standard errors each parameter is missed."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("draws", type=int)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    within = 0
    for seed in range(asked.seed, asked.seed + asked.draws):
        begin = time.perf_counter()
        found, factors = one_draw(seed)
        errors = np.sqrt(np.diag(found.covariance))
        missed = {
            name: (value - factors[name.rpartition("/")[2]]) / error
            for name, value, error in zip(found.names, found.values, errors, strict=True)
        }
        within += max(map(abs, missed.values())) < 3.0
        texts = ", ".join(
            f"{name.rpartition('/')[2]} {one:+.1f} ({100 * error:.1f} %)"
            for (name, one), error in zip(missed.items(), errors, strict=True)
        )
        print(
            f"draw {seed}, {time.perf_counter() - begin:.0f} s: standard errors off: {texts}; {found.message}",
            flush=True,
        )
    print(f"all parameters within three standard errors in {within} of {asked.draws} draws")


if __name__ == "__main__":
    main()
