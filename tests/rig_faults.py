"""Records of foreign devices with faults of a rig, and what is said of each beside what is true.

python tests/rig_faults.py --seeds 2
"""

import argparse
import re

import foreign_devices
import numpy as np

import wirerope_mj as wr
from wirerope_mj.mounts.test_rig.faults import checked_record

LAW = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.4, k=5e4)
NI = wr.AsymmetricBoucWen(alpha=4e5, beta=200.0, gamma=60.0, n=1.0, k1=4e4, k2=1e6, k3=2e8, b=1.0, c=1.0)
SIZES = [1e-3, 3e-3, 8e-3]
DEVICES = {
    "iwan": lambda x, time: foreign_devices.iwan(x),
    "five sliders": lambda x, time: foreign_devices.few_sliders(x),
    "dead zones": lambda x, time: foreign_devices.dead_zone(x),
    "lugre": lambda x, time: foreign_devices.lugre(x, time=time),
    "bouc-wen": lambda x, time: LAW.trace(x).force,
    "asymmetric": lambda x, time: NI.trace(x).force,
}
# Faults of a record, of half of the force range and of a cycle, and how the sentence on each begins.
FAULTS = (
    {}, {"lag": 0.001}, {"lag": 0.004}, {"drift": 0.08}, {"hum": 0.02},
    {"noise": 0.003}, {"noise": 0.003, "lag": 0.001}, {"noise": 0.003, "lag": 0.004}, {"noise": 0.003, "drift": 0.08},
    {"noise": 0.003, "hum": 0.02},
)  # fmt: skip
BEGINS = {"lag": "the force turns round", "drift": "the zero of the force drifts", "hum": "hum of"}


def foreign_record(name, *, lag=0.0, noise=0.0, drift=0.0, hum=0.0, seed=0):
    """Return a record of a foreign device at 1 Hz, 400 samples a cycle, its force channel late by a fraction of a cycle.

    Noise, drift over the record, and hum at 50 Hz are fractions of half of the force range.
    """
    fine = np.arange(0.0, 15.0, 1.0 / 4000.0)
    path = np.repeat(SIZES, 5)[fine.astype(int)] * np.sin(2.0 * np.pi * fine)
    force = DEVICES[name](path, fine)
    time, half = fine[::10], 0.5 * np.ptp(force)
    late = np.interp(time - lag, fine, force)
    added = noise * np.random.default_rng(seed).standard_normal(time.size)
    added += drift * time / time[-1] + hum * np.sin(2.0 * np.pi * 50.0 * time + 0.4)
    return time, path[::10], late + half * added


def main():
    """Print what is said of each record, and count false alarms and what was missed."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=1, help="records of each kind that has noise")
    records = false = missed = 0
    for seed in range(parser.parse_args().seeds):
        for name in DEVICES:
            for true in FAULTS if seed == 0 else (one for one in FAULTS if "noise" in one):
                checked = checked_record(*foreign_record(name, **true, seed=seed))
                said = {key for key, begin in BEGINS.items() for text in checked.faults if text.startswith(begin)}
                others = [text for text in checked.faults if not text.startswith(tuple(BEGINS.values()))]
                records, false = records + 1, false + len(said - set(true)) + len(others)
                missed += len(set(true) - said - {"noise"})
                texts = [re.split("[:;]", text)[0] for text in checked.faults]
                print(name, true, f"from {100.0 * checked.least_lag:.2g} % on", *(texts or ["nothing"]), sep="; ", flush=True)
    print(f"{records} records: {false} false alarms, {missed} faults not named")


if __name__ == "__main__":
    main()
