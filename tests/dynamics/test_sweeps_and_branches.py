"""Two ways to a resonance curve: slow sweeps and branches agree, and sweeps jump past the folds."""

import numpy as np
import pytest
from house import sdof
from scipy.interpolate import PchipInterpolator

import wirerope_mj as wr

LAW = wr.SymmetricBoucWen(alpha=1.0, beta=0.5, gamma=-0.2, n=2.0, k1=1.0, k2=0.0, k3=0.5)
LEVEL = 0.8
TIMESTEP = 1.0 / (0.3 * 140)  # 140 steps per period at the fold, as many as the branch has
RATES = (0.025, 0.0125, 0.00625)  # octaves per minute, of a mass that resonates at 0.3 Hz


@pytest.fixture(scope="module")
def branch():
    """A hardening mount at a level at which its resonance leans over."""
    return wr.follow_branch(
        sdof(LAW, mass=1.0), start=0.2, stop=0.4, acceleration=LEVEL, direction="z", payload="mass", largest_step=0.01
    )


@pytest.fixture(scope="module")
def sweeps(branch):
    """Sweeps up through the upper fold and down through the lower one, begun on the branch, at each rate."""
    up, down = branch.folds
    begin = int(np.argmin(np.abs(branch.frequency[: up.index] - 0.95 * up.frequency)))
    end = down.index + 1 + int(np.argmin(np.abs(branch.frequency[down.index + 1 :] - 1.05 * down.frequency)))
    return [
        (swept(branch, begin, 1.05 * up.frequency, rate), swept(branch, end, 0.96 * down.frequency, rate)) for rate in RATES
    ]


def swept(branch, index, stop, rate):
    orbit = branch.orbit(index)
    sweep = wr.Sweep(start=orbit.frequency, stop=stop, rate=rate, acceleration=LEVEL, direction="z")
    return wr.frequency_sweep(branch.system, sweep, payload="mass", initial=orbit.state, settled=None, timestep=TIMESTEP)


@pytest.mark.slow
def test_sweeps_jump_past_the_folds_and_nearer_the_slower_they_are(branch, sweeps):
    up, down = branch.folds
    past = []
    for rising, falling in sweeps:
        fallen = np.flatnonzero(rising.amplitude < 0.6 * np.maximum.accumulate(rising.amplitude))[0]
        risen = np.flatnonzero(falling.amplitude > 1.3 * down.amplitude)[0]
        past.append((rising.frequency[fallen] / up.frequency - 1.0, 1.0 - falling.frequency[risen] / down.frequency))
    past = np.array(past)
    assert (past > 0.0).all()
    assert (past[-1] < 0.01).all()
    # A fold that is passed at a rate r is left after a delay that falls as r^(2/3) in the limit: by 1.59 for half the rate.
    ratios = past[:-1] / past[1:]
    assert ((ratios > 1.4) & (ratios < 1.65)).all()


def test_slow_sweeps_lie_on_the_branch_away_from_the_jumps(branch, sweeps):
    up, down = branch.folds
    sheets = (slice(0, up.index + 1), slice(down.index, None))
    for found, sheet, away in zip(sweeps[-1], sheets, (0.98 * up.frequency, 1.02 * down.frequency), strict=True):
        order = np.argsort(branch.frequency[sheet])
        curve = PchipInterpolator(branch.frequency[sheet][order], branch.amplitude[sheet][order])
        kept = found.frequency < away if sheet.start == 0 else found.frequency > away
        assert np.count_nonzero(kept) > 100
        assert found.amplitude[kept] == pytest.approx(curve(found.frequency[kept]), rel=5e-3)


def test_folds_of_shooting_and_of_harmonic_balance_are_the_same(branch):
    balanced = wr.follow_harmonic_balance(LAW, mass=1.0, acceleration=LEVEL, start=0.25, stop=0.32, harmonics=15, samples=512)
    ours = sorted(fold.frequency for fold in branch.folds)
    theirs = sorted(fold.frequency for fold in balanced.folds)
    assert ours == pytest.approx(theirs, rel=2e-4)  # 128 steps per period; 15 harmonics
