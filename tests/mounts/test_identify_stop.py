"""A bump stop found from cyclic tests: bare, on both sides, and beside the known law of the isolator that strikes it."""

import re

import numpy as np
import pytest
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.mounts.test_rig import cyclic_test, measured, steady_loops

STOP = wr.Stop(gap_below=5e-3, k=5e5, loss=0.3, reversal=5e-4)
ROPE = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.4, k=5e4)


def loops_of(law, amplitudes, *, noise=0.0, seed=1, operating_point=0.0):
    """Return loops as a rig records them, with noise relative to half the largest force range."""
    loops = cyclic_test(law, amplitudes, operating_point=operating_point)
    size = 0.5 * max(np.ptp(loop.force) for loop in loops)
    return measured(loops, seed=seed, points_per_cycle=200, force_noise=noise * size)


def assert_found(found, law, *names, errors=4.0, slack=0.0):
    """Compare parameters: within so many standard errors, beside which `slack` allows for what is no noise, relative."""
    for name in names:
        p, true = found.parameters[name], getattr(law, name)
        print(name, p.value, "+-", p.standard_error, "true", true)
        assert abs(p.value - true) <= errors * p.standard_error + slack * abs(true), name


NAMES = ("k", "loss", "reversal")
SIDES = {
    "below": (STOP, ("gap_below",), 0.0),
    "above": (wr.Stop(gap_above=2e-3, k=2e6, loss=0.6, reversal=3e-4), ("gap_above",), 0.0),
    "both": (wr.Stop(gap_below=5e-3, gap_above=3e-3, k=5e5, loss=0.3, reversal=5e-4), ("gap_below", "gap_above"), 0.0),
    "closed at rest": (wr.Stop(gap_below=1e-3, k=5e5, loss=0.3, reversal=5e-4), ("gap_below",), -5e-3),
}


@pytest.mark.parametrize("case", SIDES)
def test_a_stop_is_found_from_loops_without_noise(case):
    law, gaps, point = SIDES[case]
    found = wr.identify(loops_of(law, [6e-3, 8e-3], operating_point=point), law=wr.Stop)
    assert (found.law.gap_below is None, found.law.gap_above is None) == (law.gap_below is None, law.gap_above is None)
    # A search ends where its gradient is 1e-10 of the forces' square: 1e-4 of a parameter leaves 1e-9 of it.
    assert_found(found, law, *gaps, *NAMES, errors=0.0, slack=1e-4)
    assert found.parameters["exponent"].fixed


@pytest.mark.parametrize("case", SIDES)
def test_a_stop_is_found_within_its_errors_from_noisy_loops(case):
    law, gaps, point = SIDES[case]
    found = wr.identify(loops_of(law, [6e-3, 8e-3], noise=0.01, operating_point=point), law=wr.Stop)
    # Four standard errors: 6e-5 by chance, for each of some 20 values.
    assert_found(found, law, *gaps, *NAMES)
    assert found.converged
    assert not found.non_identifiable
    gap = found.parameters[gaps[0]]
    assert gap.standard_error < 2e-5  # 1 % of 2 kN over 500 kN/m is 40 um in one sample, and there are some ten near the knee


@pytest.mark.slow
def test_exponent_and_rounding_are_searched_for_when_asked():
    rubber = wr.Stop(gap_below=3e-3, k=5e5 * 1e-3**-0.5, exponent=1.5, loss=0.2, reversal=1e-3)
    found = wr.identify(loops_of(rubber, [5e-3, 8e-3], noise=0.002), law=wr.Stop, free=["exponent"])
    assert_found(found, rubber, "gap_below", "k", "exponent", "loss", "reversal")
    # The other way round, a stop of exponent 1 does not follow these loops: ten times the noise is left.
    straight = wr.identify(loops_of(rubber, [5e-3, 8e-3], noise=0.002), law=wr.Stop)
    assert straight.residual > 5.0 * found.residual
    soft = wr.Stop(gap_below=3e-3, k=5e5, rounding=1e-3, loss=0.2, reversal=1e-3)
    found = wr.identify(loops_of(soft, [5e-3, 8e-3], noise=0.002), law=wr.Stop, free=["rounding"])
    assert_found(found, soft, "gap_below", "k", "rounding", "loss", "reversal")
    given = wr.identify(loops_of(soft, [5e-3, 8e-3], noise=0.002), law=wr.Stop, fixed={"rounding": 1e-3})
    assert given.law.rounding == 1e-3
    assert given.parameters["gap_below"].standard_error < found.parameters["gap_below"].standard_error


def test_an_elastic_stop_has_no_loss():
    spring = wr.Stop(gap_below=5e-3, k=5e5)
    found = wr.identify(loops_of(spring, [6e-3, 8e-3], noise=0.01), law=wr.Stop, fixed={"loss": 0.0})
    assert found.law.state_names == ()
    assert "reversal" not in found.parameters
    assert_found(found, spring, "gap_below", "k")


def test_loops_within_the_gap_do_not_count():
    loops = loops_of(STOP, [2e-3, 4e-3, 6e-3, 8e-3], noise=0.01)
    found = wr.identify(loops, law=wr.Stop)
    assert [round(1e3 * loop.amplitude) for loop in found.loops] == [6, 8]
    assert_found(found, STOP, "gap_below", *NAMES)


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize("known", [None, ROPE])
def test_a_record_that_never_closes_is_refused_with_what_it_reached(noise, known):
    law = STOP if known is None else wr.Parallel(laws=[known, STOP])
    loops = (
        loops_of(law, [2e-3, 4e-3], noise=noise)
        if known
        else measured(cyclic_test(law, [2e-3, 4e-3]), seed=1, force_noise=1e3 * noise)
    )
    with pytest.raises(ValueError, match=r"no loop closes a stop: between -4 and 4 mm no force is left.*larger amplitudes"):
        wr.identify(loops, law=wr.Stop, beside=known)


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_stop_is_found_beside_the_known_law_of_its_isolator(noise):
    both = wr.Parallel(laws=[ROPE, wr.Stop(gap_below=12e-3, k=5e5, loss=0.3, reversal=5e-4)])
    loops = loops_of(both, [6e-3, 10e-3, 15e-3], noise=noise)
    found = wr.identify(loops, law=wr.Stop, beside=ROPE)
    known, stop = found.law.components
    assert known == ROPE
    assert stop.gap_above is None
    assert_found(found, both.laws[1], "gap_below", *NAMES, slack=0.0 if noise else 1e-4)
    assert found.residuals[-1] < 1.2 * noise + 1e-4  # the noise is relative to the largest loop


def test_an_isolator_is_found_beside_a_known_stop():
    both = wr.Parallel(laws=[STOP, wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=5e4)])
    found = wr.identify(loops_of(both, [1e-3, 4e-3, 7e-3], noise=0.002), law=wr.BoucWen, beside=STOP, fixed={"n": 1.0})
    assert found.law.laws[0] == STOP
    for name, true in {"z_max": 800.0, "x_y": 2e-3, "sigma": 0.7, "k": 5e4}.items():
        p = found.parameters[name]
        assert abs(p.value - true) < 4.0 * p.standard_error


@pytest.mark.slow
def test_a_start_joins_the_grid_and_must_say_what_the_loops_show():
    loops = loops_of(STOP, [6e-3, 8e-3], noise=0.01)
    near = wr.Stop(gap_below=4.5e-3, k=4e5, loss=0.2, reversal=1e-3)
    found = wr.identify(loops, law=wr.Stop, start=near, grid=False)
    assert found.started == "given"
    assert_found(found, STOP, "gap_below", *NAMES)
    with pytest.raises(ValueError, match=r"`start` must give gap_below, .*which the loops show"):
        wr.identify(loops, law=wr.Stop, start=wr.Stop(gap_above=1e-3, k=4e5, loss=0.2, reversal=1e-3))
    with pytest.raises(ValueError, match=r"`start` must give k, "):
        wr.identify(loops, law=wr.Stop, start=wr.Stop(gap_below=1e-3, depths=[1e-3], forces=[1e3], loss=0.2, reversal=1e-3))
    with pytest.raises(ValueError, match=r"`fixed` and `free` both name exponent"):
        wr.identify(loops, law=wr.Stop, fixed={"exponent": 1.5}, free=["exponent"])
    with pytest.raises(ValueError, match=r"`free` names 'hardness', which stop does not have; it has gap_below, k, "):
        wr.identify(loops, law=wr.Stop, free=["hardness"])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys, *arguments, code=0):
    """Return what `wirerope identify` prints, its cells apart by single spaces."""
    assert main(["identify", *[str(argument) for argument in arguments]]) == code
    caught = capsys.readouterr()
    return re.sub(r"[ \n]+", " ", caught.out if code == 0 else caught.err)


def bare_record(folder, amplitudes, *, noise=15.0, step=0.0):
    """Write a record of the bare stop with noise [N], a zero of 40 N and the steps of a converter [N]."""
    time, x, force = rig_record(STOP, amplitudes, noise=0.0)
    force = force + noise * np.random.default_rng(3).standard_normal(force.size) + 40.0
    force = np.round(force / step) * step if step else force
    return write_record(folder / "bare.csv", time, x, force)


@pytest.mark.slow
@pytest.mark.parametrize(("noise", "step"), [(15.0, 0.0), (0.5, 4.0)])
def test_records_of_a_bare_stop_become_an_isolator(folder, capsys, noise, step):
    bare_record(folder, [3e-3, 6e-3, 8e-3], noise=noise, step=step)
    out = run(capsys, "bare.csv", "--law", "stop", "--out", "bumper.toml")
    assert "2 loops of 1 file" in out
    assert "bare.csv: ±3 mm about 0 mm stays within the gap and is not fitted" in out
    assert "c = 0 N s/m" in out
    assert "saturated" not in out
    stop = wr.load_isolator("bumper.toml").axial
    # Standard errors of the gap are 3 um, of k 0.6 %; bins of 1/200 of a cycle round the knee by as much.
    assert stop.gap_below == pytest.approx(5e-3, abs=2e-5)
    assert stop.k == pytest.approx(5e5, rel=0.03)
    assert stop.gap_above is None
    assert (folder / "bumper-report" / "report.html").read_text(encoding="utf-8").count("<svg") == 3


def test_a_record_of_a_stop_without_loss(folder, capsys):
    time, x, force = rig_record(wr.Stop(gap_below=5e-3, k=5e5), [6e-3, 8e-3], noise=0.0)
    write_record(folder / "bare.csv", time, x, force + 0.5 * np.random.default_rng(3).standard_normal(force.size))
    run(capsys, "bare.csv", "--law", "stop", "--fix", "loss=0", "--out", "bumper.toml")
    stop = wr.load_isolator("bumper.toml").axial
    assert stop.state_names == ()
    # bins of 1/200 of a cycle round the knee by some 20 um
    assert stop.gap_below == pytest.approx(5e-3, abs=5e-5)
    assert stop.k == pytest.approx(5e5, rel=0.03)


def test_a_record_of_a_bare_stop_that_never_closes(folder, capsys):
    bare_record(folder, [2e-3, 4e-3])
    out = run(capsys, "bare.csv", "--law", "stop", "--out", "bumper.toml", code=2)
    assert "no loop closes a stop: between -4 and 4 mm no force is left that grows towards an end." in out
    assert not (folder / "bumper.toml").exists()


def test_a_stop_whose_load_cell_was_cut_off_is_refused():
    time, x, force = rig_record(STOP, [8e-3], noise=0.0)
    force = force + np.random.default_rng(3).standard_normal(force.size)
    with pytest.raises(ValueError, match="saturated"):
        steady_loops(x, np.maximum(force, -1000.0), time=time, stop=True)
    with pytest.raises(ValueError, match="play in the rig"):
        steady_loops(x, force, time=time)
    assert len(steady_loops(x, force, time=time, stop=True)) == 1


@pytest.mark.slow
def test_an_isolator_that_bottoms_gets_its_stop_beside_its_law(folder, capsys):
    limits = wr.Limits(static_load=500.0)
    wr.Isolator(name="rope", axial=ROPE, shear=ROPE, limits=limits).save("rope.toml")
    both = wr.Parallel(laws=[ROPE, wr.Stop(gap_below=12e-3, k=5e5, loss=0.3, reversal=5e-4)])
    write_record(folder / "bottoming.csv", *rig_record(both, [6e-3, 10e-3, 15e-3], seed=3, noise=0.005, zero=30.0))
    out = run(
        capsys,
        "bottoming.csv",
        "--law",
        "stop",
        "--beside",
        "rope.toml",
        "--fix",
        "reversal=5e-4",
        "--out",
        "both.toml",
    )
    assert "bouc-wen: alpha = 400000 N/m, " in out
    assert "and stop: gap_below = 0.01" in out
    isolator = wr.load_isolator("both.toml")
    known, stop = isolator.axial.components
    assert known == ROPE
    assert (isolator.shear, isolator.limits) == (ROPE, limits)
    assert stop.gap_below == pytest.approx(12e-3, abs=3e-5)  # as for the bare one
    assert stop.k == pytest.approx(5e5, rel=0.03)
    assert "the law of rope.toml beside it: given, not fitted" in isolator.provenance.assumed
    assert main(["loops", "both.toml", "--amplitudes", "5", "15"]) == 0
    assert "and stop: gap_below" in re.sub(r"[ \n]+", " ", capsys.readouterr().out)
    (folder / "empty.toml").write_text('name = "e"\n[shear]\nlaw = "kelvin-voigt"\nk = 1.0\nc = 0.0\n')
    out = run(capsys, "bottoming.csv", "--law", "stop", "--beside", "empty.toml", "--out", "b.toml", code=2)
    assert "empty.toml: [axial] is missing; nothing is known beside what the tests moved." in out
