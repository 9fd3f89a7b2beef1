"""Laws whose force falls as the deflection grows: said at the fit, in the file, in runs and where one ends."""

import numpy as np
import pytest
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.travel import falling_line
from wirerope_mj.content.modes import below_tests
from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.mounts.identification.records import identified_isolator
from wirerope_mj.mounts.isolator.travel import falling_from, falling_text

SOFT = wr.SymmetricBoucWen.from_normalised(z_max=100.0, x_y=1e-4, sigma=0.7, n=1.0, k1=6e4, k2=0.0, k3=-1e8)
TOP = np.sqrt(6e4 / 3e8)  # where k1 + 3 k3 x^2 is zero; by then the hysteretic force has long saturated


@pytest.fixture(scope="module")
def fit():
    time = np.arange(0.0, 15.0, 1.0 / 200.0)
    deflection = np.repeat([2e-3, 5e-3, 9e-3], 5)[time.astype(int)] * np.sin(2.0 * np.pi * time)
    return wr.identify(wr.steady_loops(deflection, SOFT.trace(deflection).force, time=time), law=wr.SymmetricBoucWen)


def test_the_top_of_a_softening_spring_is_found_on_both_sides():
    assert falling_from(SOFT, -0.03, 0.03) == pytest.approx({-1.0: -TOP, 1.0: TOP}, rel=1e-4)
    assert falling_from(SOFT, -0.03, 0.9 * TOP) == pytest.approx({-1.0: -TOP}, rel=1e-4)
    assert falling_from(SOFT, -0.0, 0.0) == {}


def test_a_force_that_saturates_or_hardens_does_not_fall():
    for law in (
        wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.4, k=0.0),
        wr.AsymmetricBoucWen(alpha=4e5, beta=200.0, gamma=60.0, n=1.0, k1=4e4, k2=1e6, k3=2e8, b=1.0, c=1.0),
        wr.KelvinVoigt(k=1e4, c=10.0),
    ):
        assert falling_text(law, -0.02, 0.02) == ""


def test_fit_and_file_say_it(fit):
    assert "the tangent stiffness is negative below -14.1 mm and above 14.1 mm" in str(fit)
    isolator = identified_isolator(fit, name="rig", axis="axial", files=[], given=[])
    assert any("negative below -14.1 mm" in text for text in isolator.provenance.assumed)
    rated = wr.Isolator(name="r", axial=SOFT, limits=wr.Limits(travel=wr.Travel(compression=0.03, tension=0.03)))
    joined = identified_isolator(fit, name="rig", axis="axial", files=[], given=[], whole=rated)
    assert any("negative below" in text for text in joined.provenance.assumed)


def test_a_run_that_ends_there_names_mount_axis_and_deflection_and_no_smaller_timestep(fit):
    isolator = identified_isolator(fit, name="rig", axis="axial", files=[], given=[])
    system = wr.load_system(sdof_text(mass=20.0), isolators={"a": isolator})
    shock = wr.HalfSine(peak=100.0, duration=0.02, direction="z", start=0.01)
    with pytest.raises(
        SimulationError,
        match=r"no timestep mends that.* Mount 'm1' stood at .* mm on its axial axis, where the tangent .* -14\.2 mm",
    ):
        wr.simulate(system, shock, duration=2.0, timestep=5e-4, engine="mujoco")


def test_a_run_that_comes_back_names_them_too(fit):
    isolator = identified_isolator(fit, name="rig", axis="axial", files=[], given=[])
    system = wr.load_system(sdof_text(mass=20.0), isolators={"a": isolator})
    lines = []
    for level in (20.0, 34.0):
        shock = wr.HalfSine(peak=level, duration=0.02, direction="z", start=0.01)
        response = wr.simulate(system, shock, duration=0.3, timestep=5e-4)
        lowest = float(response.peaks.mounts["m1"].deflection.minimum[2])
        line = falling_line({"m1": isolator}, response)
        assert (lowest < -TOP) == ("m1 axial: the tangent stiffness is negative below -14.1 mm" in line)
        lines.append(line)
    assert lines[0] == ""
    assert "2 mm" in next(iter(below_tests(system)))
