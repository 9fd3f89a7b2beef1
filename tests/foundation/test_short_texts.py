"""A cell of a notebook that ends in a public result prints at most two kilobytes of text."""

from dataclasses import replace

import numpy as np
import pytest
from one_scale import one_scale

import wirerope_mj as wr
from wirerope_mj.runs.scenario import load_scenario

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

MOST = 2000
PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01)
POINTS = ((5.0, 1.0), (50.0, 1.0))
LONG = np.linspace(5.0, 25.0, 300)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Return public results by what they are, of the floor where there may be many of something."""
    floor, table, shaker = (wr.load_system(name) for name in ("floating_floor", "shock_table", "sdof_shaker"))
    response = wr.simulate(floor, PULSE, duration=0.05, timestep=5e-4)
    law = one_scale("wr16_400")["wr16_400"].axial
    loops = wr.cyclic_test(law, [1e-3, 2e-3, 5e-3])
    deflection, force = (np.tile(values[:-1], 4) for values in (loops[0].deflection, loops[0].force))
    study = wr.Study(
        model="shock_table.xml", motion=PULSE, duration=0.05, timestep=5e-4, variants=4,
        vary={"motion/level": wr.Uniform(0.5, 1.0)},
    )  # fmt: skip
    sweep = wr.Sweep(start=20, stop=30, rate=60, acceleration=1.0, direction="z")
    return {
        "system": floor, "mount": floor.mounts["m01"], "mounts": floor.mounts, "isolator": floor.mounts["m01"].isolator,
        "law": law, "loop": law.trace(np.linspace(0.0, 1e-3, 300)), "loops": loops,
        "recorded": wr.steady_loops(deflection, force, time=np.arange(force.size) / 400),
        "identification": wr.identify(loops, law=wr.AsymmetricBoucWen), "equilibrium": wr.equilibrium(floor),
        "statics": wr.static_table(floor), "modes": wr.modes(floor), "changes": wr.varied(floor, masses={"floor": 1.1}).changes,
        "response": response, "peaks": response.peaks, "one peak": response.peaks.bodies["floor"].acceleration,
        "bodies": response.bodies, "body": response.bodies["floor"], "points": response.points,
        "point": next(iter(response.points.values())), "mount responses": response.mounts, "base": response.base,
        "mount response": response.mounts["m01"], "scene": response.scene, "numerics": response.numerics,
        "state": response.final_state, "verdicts": wr.judge(response), "verdict": wr.judge(response)[0],
        "batch": wr.simulate_batch([table], [PULSE], duration=0.02, timestep=5e-4),
        "spectrum": wr.shock_response_spectrum(
            response.time, response.bodies["floor"].acceleration[:, 2], np.geomspace(5, 90, 60)
        ),
        "density": wr.power_spectral_density(np.arange(5000) / 1000, np.random.default_rng(1).normal(size=5000)),
        "match": wr.match_spectrum([(1, 1.0), (33, 1.0)], duration=12, seed=1, direction="z"),
        "random": wr.RandomVibration(psd=[(5, 1.0), (50, 1.0)], duration=5, seed=1, direction="z"),
        "sum": PULSE + sweep, "force": wr.ForceTable(site="a", times=range(3000), loads=[[0.0] * 6] * 3000),
        "scenario": load_scenario("floating_floor_shock").make(),
        "sweep": wr.frequency_sweep(shaker, sweep, payload="mass", response_direction="z"),
        "orbit": wr.periodic_orbit(table, frequency=10.0, acceleration=1.0, direction="z"),
        "branch": wr.follow_branch(shaker, start=20, stop=30, acceleration=1.0, direction="z", payload="mass"),
        "many forces": wr.equilibrium(floor).mounts, "laws compared": wr.compare_laws(loops),
        "specimens": wr.identify_specimens([loops, wr.cyclic_test(replace(law, alpha=1.05 * law.alpha), [1e-3, 2e-3, 5e-3])]),
        "linearised": wr.equivalent_linear(law, mass=300.0, frequencies=LONG, acceleration=1.0),
        "selection": wr.select_isolators(mass=100.0, mounts=4, velocity=2.0, fragility=150.0),
        "curve": wr.Tabulated(deflection=LONG - 15.0, upper=LONG + 50.0, lower=LONG - 50.0, yield_deflection=1e-3),
        "long density": wr.RandomVibration(psd=[(f, 1.0) for f in LONG], duration=3.0, seed=1, direction="z"),
        "lines": wr.VibrationLines(acceleration=[(f, 1.0) for f in LONG], duration=3.0, seed=1, direction="z"),
        "many motions": sum((PULSE,) * 19, start=PULSE),
        "study": study, "study's result": study.run(tmp_path_factory.mktemp("studies") / "study", workers=1),
    }  # fmt: skip


@pytest.mark.slow
def test_every_result_says_itself_in_two_kilobytes(results):
    sizes = {name: len(repr(result)) for name, result in results.items()}
    assert {name: size for name, size in sizes.items() if size > MOST} == {}
    html = {name: len(result._repr_html_()) for name, result in results.items() if hasattr(result, "_repr_html_")}
    assert {name: size for name, size in html.items() if size > 2 * MOST} == {}  # tags and all


@pytest.mark.slow
def test_the_texts_say_what_there_is(results):
    assert repr(results["mounts"]).startswith("40 by name: m01, m02")
    assert "Enidine WR16-400" in repr(results["mount"])
    assert repr(results["verdicts"]).startswith(f"{len(results['verdicts'])} verdicts. ")
    assert "Position [m], (n_t, 3)" in repr(results["body"])
    assert "array of shape" in repr(results["base"])


@pytest.mark.quick
def test_a_short_motion_says_itself_as_the_call_that_makes_it_and_a_long_one_cuts_its_points():
    short, long = (
        wr.RandomVibration(psd=psd, duration=3.0, seed=1, direction="z") for psd in (POINTS, [(f, 1.0) for f in LONG])
    )
    assert "psd=((5.0, 1.0), (50.0, 1.0)), duration=3.0, seed=1, direction='z'" in repr(short)
    assert "duration=3.0, seed=1, direction='z'" in repr(long)
    assert "...," in repr(long)
    assert eval(repr(short), {"RandomVibration": wr.RandomVibration}) == short


@pytest.mark.slow
def test_a_comparison_of_laws_is_still_a_table_when_it_is_printed(results):
    assert str(results["laws compared"]).startswith("law ")
    assert "of LawRow" in repr(results["laws compared"])
