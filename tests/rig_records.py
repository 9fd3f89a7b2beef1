"""Records as a test rig writes them: several cycles and amplitudes, noise, a force zero that drifts."""

import numpy as np

from wirerope_mj.mounts.test_rig import cyclic_test


def rig_record(
    law, amplitudes, *, seed=1, operating_point=0.0, cycles=5, points=240.0, noise=0.01, slack=0.0, drift=0.0, zero=0.0
):
    """Return time [s], deflection [m] and force [N] of a test at 1 Hz.

    Args:
        law: under test.
        amplitudes: of the sines that follow each other [m]; each begins and ends at the operating point.
        seed: of the noise.
        operating_point: about which the sines go [m]; a ramp of one second leads there.
        cycles: of each amplitude.
        points: samples of a cycle; they need not fit into it.
        noise: of the force, relative to half of each amplitude's steady force range.
        slack: noise of the deflection, relative to the largest amplitude.
        drift: of the force zero over the whole record [N].
        zero: of the force at the begin of the record [N].
    """
    rng = np.random.default_rng(seed)
    time = np.arange(int(cycles * len(amplitudes) * points)) / points
    sizes = np.repeat(amplitudes, cycles)[np.minimum(time.astype(int), cycles * len(amplitudes) - 1)]
    path = operating_point + sizes * np.sin(2.0 * np.pi * time)
    if operating_point:
        ramp = np.arange(int(points)) / points
        time = np.concatenate([ramp, 1.0 + time])
        path, sizes = (
            np.concatenate([operating_point * ramp, path]),
            np.concatenate([np.full(ramp.size, sizes[0]), sizes]),
        )
    force = law.trace(path).force
    ranges = {size: np.ptp(cyclic_test(law, size, operating_point=operating_point)[0].force) for size in amplitudes}
    sigma = noise * 0.5 * np.array([ranges[size] for size in sizes])
    force = force + sigma * rng.standard_normal(time.size) + zero + drift * time / time[-1]
    return time, path + slack * max(amplitudes) * rng.standard_normal(time.size), force


def write_record(path, time, deflection, force, *, header="time [s],deflection [mm],force [kN]", metre=1e3, newton=1e-3):
    """Write a record with as many digits as a rig gives."""
    rows = [f"{t:.5f},{metre * x:.7g},{newton * f:.7g}" for t, x, f in zip(time, deflection, force, strict=True)]
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path
