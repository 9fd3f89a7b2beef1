"""Superharmonic resonances that the whole amplitude hardly shows are listed, by the harmonic that they are of."""

import pytest

import wirerope_mj as wr
from wirerope_mj.dynamics.frequency_response.summary import peaks_of
from wirerope_mj.dynamics.periodic import resonances


@pytest.mark.slow
def test_shipped_shaker_lists_orders_2_and_3_at_the_ratios_of_the_thesis():
    """Its figure 3.22: 36.2 Hz over 18.2 and 12.2 Hz, 1.98 and 2.97. At 0.1 g, where the resonance has hardly softened."""
    branch = wr.follow_branch(
        wr.load_system("sdof_shaker"), start=11.0, stop=42.0, acceleration=0.1 * wr.STANDARD_GRAVITY, direction="z",
        payload="mass", accuracy=1e-3, tolerance=1e-4,
    )  # fmt: skip
    top, *others = peaks_of(branch)
    found = {peak.order: top.frequency / peak.frequency for peak in others}
    assert set(found) == {2.0, 3.0}
    assert found[2.0] == pytest.approx(1.98, rel=0.01)
    assert found[3.0] == pytest.approx(2.97, rel=0.01)
    assert min(peak.share for peak in others) > 0.01
    assert len(resonances(branch)) == 2  # the amplitude itself has no peak at order 2
