"""Results in a terminal and in a notebook: a few lines with units."""

import math

import pytest
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.foundation.summary import MOST_LINES, Summarised

pytestmark = pytest.mark.quick

LAW = wr.BoucWen(alpha=2e4, beta=30.0, gamma=10.0, n=1.0, k=5e3)


@pytest.fixture(scope="module")
def system():
    return wr.load_system(sdof_text(), isolators={"a": wr.Isolator(name="a", axial=LAW)})


@pytest.fixture(scope="module")
def results(system):
    pulse = wr.HalfSine(peak=30.0, duration=0.011, direction="z")
    response = wr.simulate(system, pulse, duration=0.1, timestep=1e-3)
    acceleration = response.bodies["mass"].acceleration[:, 2]
    return {
        "system": system,
        "equilibrium": wr.equilibrium(system),
        "modes": wr.modes(system),
        "response": response,
        "spectrum": wr.shock_response_spectrum(response.time, acceleration),
        "loop": wr.cyclic_test(LAW, [0.005])[0],
        "orbit": wr.periodic_orbit(system, frequency=5.0, acceleration=1.0, direction="z"),
        "harmonics": wr.harmonic_balance(LAW, mass=10.0, frequency=5.0, acceleration=1.0),
    }


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("system", ("System", "1 mounts", "kg")),
        ("equilibrium", ("virgin", "mm", "kN")),
        ("modes", ("Hz", "damping", "%")),
        ("response", ("0.1 s", "mass", " g at ", "largest deflection, m1", "1000 us", "no error estimated")),
        ("spectrum", ("Q = 10", "Hz", "m/s")),
        ("loop", ("-5 to 5 mm", "kN/m", "J")),
        ("orbit", ("stable", "5 Hz along z")),
        ("harmonics", ("10 kg", "BoucWen", "mm")),
    ],
)
def test_a_result_prints_a_few_lines_with_units(results, name, parts):
    text = repr(results[name])
    assert len(text.splitlines()) <= MOST_LINES
    for part in parts:
        assert part in text
    page = results[name]._repr_html_()
    assert page.startswith("<table>")
    assert page.count("<tr>") == len(text.splitlines()) - 1


def test_the_lines_hold_the_peaks_of_the_response(results):
    peak = results["response"].peaks.bodies["mass"].acceleration
    assert f"peak {peak.value / wr.STANDARD_GRAVITY:.4g} g at {peak.time:.4f} s" in repr(results["response"])


class Long(Summarised):
    def _summary(self):
        return "Long <b>", {f"<i>{k}": "x" for k in range(40)}


def test_a_long_summary_says_how_much_it_leaves_out_and_names_are_text():
    lines = repr(Long()).splitlines()
    assert len(lines) == MOST_LINES
    assert "and 30 more" in lines[-1]
    assert "<i>" not in Long()._repr_html_()
    assert "<b>" not in Long()._repr_html_()


def test_what_is_not_known_is_said():
    from wirerope_mj.foundation.summary import quantity

    assert quantity(math.nan, "m") == "not known"
    assert quantity(0.0312, "m") == "31.2 mm"
