"""What takes more memory, disk or time than there is is refused before it begins, with the figure and the remedy."""

import shutil
from types import SimpleNamespace

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.dynamics.sweep import frequency_sweep, stepped_sine
from wirerope_mj.foundation import budget
from wirerope_mj.foundation.errors import BudgetError
from wirerope_mj.motions import HalfSine, Sweep
from wirerope_mj.motions.spectrum_match import match_spectrum
from wirerope_mj.studies.vary.distributions import Choice, Uniform

pytestmark = pytest.mark.quick

SYSTEM = wr.load_system("sdof_shaker")
PULSE = HalfSine(peak=10.0, duration=0.011, direction="z")
FREE = 8e9
"""Memory that the tests say is free [B]: the refusals must not depend on the computer."""


@pytest.fixture(autouse=True)
def free(monkeypatch):
    monkeypatch.setattr(budget, "_free_memory", lambda: FREE)


def test_sizes_are_said_with_the_unit_that_suits_them():
    assert [budget.bytes_text(size) for size in (12, 7.2e12, 999.6e6, 1e24)] == ["12 B", "7.2 TB", "1 GB", "1e+06 EB"]


def test_free_memory_is_a_part_of_what_the_machine_has(monkeypatch):
    monkeypatch.undo()
    assert 1e7 < budget._free_memory() < 1e14


def test_memory_is_limited_by_the_group_of_the_process(monkeypatch, tmp_path):
    monkeypatch.undo()
    most, used = tmp_path / "max", tmp_path / "current"
    most.write_text("50000000\n"), used.write_text("10000000\n")
    monkeypatch.setattr(budget, "_GROUPS", ((most, used), (tmp_path / "no", used)))
    assert budget._free_memory() == 4e7
    most.write_text("max\n")
    assert budget._free_memory() != 4e7


def test_half_of_what_is_free_may_be_taken():
    budget.require_memory("it", 0.499 * FREE, "")
    with pytest.raises(BudgetError, match=r"it would take 4.01 GB of memory; the limit is 4 GB, 50% of what is free. Less."):
        budget.require_memory("it", 0.501 * FREE, "Less.")


@pytest.mark.parametrize(("duration", "rate"), [(1e9, 1000.0), (0.3, 1e9), (1e300, 1e300)])
def test_a_run_whose_samples_do_not_fit_is_refused_at_once(duration, rate):
    with pytest.raises(BudgetError, match=r"would take .* the limit is .*Use a lower `sample_rate` or a shorter `duration`"):
        wr.simulate(SYSTEM, PULSE, duration=duration, sample_rate=rate)


def test_samples_that_are_streamed_are_held_against_the_disk(monkeypatch, tmp_path):
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=5e9))
    with pytest.raises(BudgetError, match=r"6\d\.\d GB of disk; the limit is 4.5 GB, 90% of what is free"):
        wr.simulate(SYSTEM, PULSE, duration=1e5, sample_rate=1000.0, out=tmp_path / "run")
    assert list(tmp_path.iterdir()) == []


def test_pilots_are_held_against_memory_too(monkeypatch, tmp_path):
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=1e15))
    with pytest.raises(BudgetError, match="the runs by which a step is chosen.*or give the `timestep`"):
        wr.simulate(SYSTEM, PULSE, duration=0.3, sample_rate=1e8, out=tmp_path / "run")


def test_a_run_of_more_than_a_week_is_refused():
    with pytest.raises(BudgetError, match=r"1e\+14 steps, 116 days of computing at the very least; the limit is 7 days"):
        wr.simulate(SYSTEM, PULSE, duration=1e14, sample_rate=1.0)


def test_a_batch_keeps_all_its_responses_at_once():
    with pytest.raises(BudgetError, match="samples of this run"):
        wr.simulate_batch([SYSTEM] * 300, PULSE, duration=100.0, timestep=1e-3, responses=True)


def test_a_sweep_is_refused_by_its_cycles():
    sweep = Sweep(start=5.0, stop=50.0, rate=1e-9, acceleration=1.0, direction="z")
    with pytest.raises(BudgetError, match="cycles, would take .* of memory.*Sweep faster"):
        frequency_sweep(SYSTEM, sweep, payload="mass")


@pytest.mark.parametrize(
    ("vary", "arguments"),
    [
        ({"motion/level": Uniform(0.5, 1.0)}, {"variants": 10**9}),
        ({"motion/level": Uniform(0.5, 1.0)}, {"variants": 10**9, "sampling": "latin-hypercube"}),
        ({"motion/level": Uniform(0.5, 1.0, points=30_000), "body/mass/mass": Uniform(0.9, 1.1, points=30_000, relative=True)},
         {"sampling": "grid"}),
    ],
)  # fmt: skip
def test_a_study_is_refused_by_the_table_of_its_inputs(vary, arguments):
    with pytest.raises(BudgetError, match="the inputs of .* variants would take .* of memory.*fewer `variants`"):
        wr.Study(model="sdof_shaker", motion=PULSE, duration=0.1, vary=vary, **arguments)


def test_a_study_is_refused_by_the_time_of_its_variants():
    with pytest.raises(BudgetError, match="a study of 1000 variants .* days of computing"):
        wr.Study(
            model="sdof_shaker",
            motion=PULSE,
            duration=1e9,
            vary={"motion/level": Choice(*range(1, 1001))},
            sampling="grid",
        )


def test_matching_a_spectrum_is_refused_by_lines_and_samples():
    with pytest.raises(BudgetError, match=r"matching a spectrum by \d+ lines over 1e.07 s"):
        match_spectrum([(1.0, 3.0), (30.0, 3.0)], duration=1e7, seed=1, direction="z")


def test_a_search_is_refused_by_the_time_of_all_its_generations():
    vary = {"motion/level": Uniform(0.5, 1.0)}
    study = wr.Study(model="sdof_shaker", motion=PULSE, duration=0.1, vary=vary, variants=10)
    with pytest.raises(BudgetError, match=r"a search of 1\d* generations of 10 designs of 0.1 s .* fewer `generations`"):
        wr.Search(study, minimise=["acceleration"], generations=10**12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"periods": 10**12}, "following 149.8 periodic motions of .* steps would take .* days of computing"),
        ({"periods": 10**7}, "one of these periodic motions, .* would take .* of memory.*Take fewer `periods`"),
        ({"accuracy": 1e-24, "largest_step": 2e-5}, "following 3000 periodic motions"),
        ({"start": 1e-300}, "a period of 1e-300 Hz would take .* days of computing"),
    ],
)
def test_continuation_is_refused_by_points_and_steps(arguments, message):
    given = {"start": 1.0, "stop": 20.0, "acceleration": 1.0, "direction": "z", "payload": "mass"}
    with pytest.raises(BudgetError, match=message):
        wr.follow_branch(SYSTEM, **given | arguments)
    if "periods" in arguments:
        with pytest.raises(BudgetError, match="of memory|days of computing"):
            wr.periodic_orbit(SYSTEM, frequency=10.0, acceleration=1.0, direction="z", **arguments)


def test_steady_sines_are_refused_by_the_steps_of_their_cycles():
    with pytest.raises(BudgetError, match="a cycle at each of 3 frequencies would take .* larger `timestep`"):
        stepped_sine(SYSTEM, frequencies=[1.0, 2.0, 3.0], direction="z", payload="mass", acceleration=1.0, timestep=1e-13)


def test_a_shock_spectrum_is_refused_by_its_lines(monkeypatch):
    time = np.arange(1000) / 1e3
    with pytest.raises(BudgetError, match="spectrum of 20000000 lines would take .* of memory.*fewer `frequencies`"):
        wr.shock_response_spectrum(time, time, np.broadcast_to(10.0, 20_000_000))
    monkeypatch.setattr(budget, "LONGEST", 1e-6)
    with pytest.raises(BudgetError, match="spectrum of 100 lines over 1000 samples would take 1e.05 steps"):
        wr.shock_response_spectrum(time, time, np.full(100, 10.0))


@pytest.mark.parametrize("arguments", [{"cycles": 10**12}, {"points_per_cycle": 4 * 10**12}])
def test_cyclic_tests_are_refused_by_their_points(arguments):
    law = wr.BoucWen(alpha=1e5, beta=1.0, gamma=1.0, n=1.0)
    with pytest.raises(BudgetError, match="loops of"):
        wr.cyclic_test(law, [0.001, 0.002], **arguments)


def test_what_is_usual_is_not_refused():
    response = wr.simulate(SYSTEM, PULSE, duration=0.05)
    assert np.isfinite(response.mounts[next(iter(response.mounts))].force).all()
