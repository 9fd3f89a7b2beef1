"""Choice of law: the table says which law fits, which one generalises, and where one parameter set misses."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.mounts.identification import compare_laws
from wirerope_mj.mounts.test_rig import cyclic_test, measured

TRUTH = wr.EnhancedDryFriction(k=6e4, d=400.0, u_c=1e-3)
AMPLITUDES = 0.01 * np.array([0.1, 0.3, 1.0])


def noisy(law, amplitudes, seed, noise=0.01):
    """Return loops of 100 samples with noise of a share of half their force range."""
    loops = cyclic_test(law, amplitudes)
    return [
        measured([loop], points_per_cycle=100, force_noise=noise * np.ptp(loop.force) / 2.0, seed=seed + place)[0]
        for place, loop in enumerate(loops)
    ]


@pytest.fixture(scope="module")
def device():
    """Return the device of the benchmarks that no law of the house describes."""
    folder = models_folder().parent / "benchmarks"
    if not folder.is_dir():
        pytest.skip("benchmarks stand in a checkout only")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        from odd_device import OddDevice

        yield OddDevice()


def test_true_law_wins_over_one_that_contains_it_and_one_that_does_not():
    loops = noisy(TRUTH, AMPLITUDES, seed=1)
    table = compare_laws(loops, laws=[wr.Masing, wr.BoucWen, wr.EnhancedDryFriction], elements=1)
    # Bouc-Wen is the truth with sigma = n = 1: two parameters more gain about 2, and cost 2 ln 303 = 11.
    assert [row.law for row in table.rows] == ["enhanced-dry-friction", "bouc-wen", "masing"]
    assert [row.free for row in table.rows] == [3, 5, 3]
    assert table.best.law == "enhanced-dry-friction"
    assert table.best.behind == 0.0
    assert 0.0 < table.rows[1].behind < 2.0 * np.log(303)
    assert isinstance(table.best.fit.law, wr.EnhancedDryFriction)
    # White noise of 1 % of half the range: the rms of a hundred samples is within 3 of its errors, 7 % each, of that.
    np.testing.assert_allclose(table.best.errors, 0.01, rtol=0.21)
    # Amplitudes that were not seen are as good: what three parameters take from 200 samples' noise is a hundredth of it.
    np.testing.assert_allclose(table.best.errors_left_out, table.best.errors, rtol=0.05)
    assert table.most_general.law in ("enhanced-dry-friction", "bouc-wen")
    # One Jenkin element bends once, the truth everywhere.
    assert table.rows[2].errors.max() > 0.03


def test_loops_of_one_amplitude_are_left_out_together():
    first = noisy(TRUTH, AMPLITUDES, seed=1)
    again = noisy(TRUTH, 1.02 * AMPLITUDES, seed=7)
    table = compare_laws([*first, *again], laws=[wr.EnhancedDryFriction])
    np.testing.assert_allclose(table.amplitudes, 1.01 * AMPLITUDES, rtol=1e-3)
    assert table.rows[0].errors_left_out.shape == (3,)


def test_a_law_with_too_few_amplitudes_stands_last_and_says_why():
    table = compare_laws(noisy(TRUTH, AMPLITUDES[:2], seed=2), laws=[wr.AsymmetricBoucWen, wr.EnhancedDryFriction])
    last = table.rows[-1]
    assert last.law == "asymmetric-bouc-wen"
    assert "3 different amplitudes are needed, 2 given" in last.message
    assert last.fit is None
    assert last.behind == np.inf
    assert "enhanced-dry-friction" in str(table).splitlines()[1]


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="`laws` must name at least one law"):
        compare_laws(noisy(TRUTH, AMPLITUDES, seed=3), laws=[])
    with pytest.raises(ValueError, match="`weights` must be one of 'range', 'equal'"):
        compare_laws(noisy(TRUTH, AMPLITUDES, seed=3), weights="small")


def test_odd_device_keeps_its_balance_of_forces(device):
    # Virgin path without cubic spring, all sliders stuck: two springs in series.
    tiny = 1e-12  # the first slider slips at 1e-11 m
    inner = device.sliding + device.beside
    assert device.force(np.array([0.0, tiny]))[1] == pytest.approx(tiny / (1 / inner + 1 / device.series), rel=1e-6)
    # Fully slipping: the inner spring and the sliders' bounds carry what the outer spring does.
    force = device.force(np.linspace(0.0, device.travel, 50))[-1]
    share = (np.arange(device.elements) + 0.5) / device.elements
    bound = device.sliding * np.mean(device.slip * device.travel * share ** (1.0 / (1.0 + device.power)))
    stretch = device.travel - (force - bound) / device.beside
    assert device.series * stretch + device.cubic * stretch**3 == pytest.approx(force, rel=1e-9)


@pytest.mark.slow
def test_one_bouc_wen_misses_small_amplitudes_where_jenkin_elements_do_not(device):
    tested = device.travel * np.array([0.02, 0.03, 0.1, 0.4, 1.0])
    loops = [device.measured(a, noise=0.01, seed=place, points=100) for place, a in enumerate(tested)]
    # The thesis' problem, a newton counting alike: one parameter set follows large loops and misses small ones. The limits
    # are those that the law has to keep, over half of the force range; 1 % of it is the noise of the loop that judges.
    thesis = {row.law: row for row in compare_laws(loops, laws=[wr.BoucWen, wr.Masing], weights="equal").rows}
    assert thesis["bouc-wen"].errors_left_out[0] > 0.14
    assert thesis["bouc-wen"].errors[0] > 3.0 * thesis["bouc-wen"].errors[-1]
    assert thesis["masing"].errors_left_out[0] < thesis["bouc-wen"].errors_left_out[0] / 3.0
    # Loops counting alike, five elements follow them all.
    alike = compare_laws(loops, laws=[wr.Masing], weights="range").best
    assert alike.free <= 12
    assert alike.errors_left_out[0] < 0.035
