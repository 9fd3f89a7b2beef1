"""Branches of periodic motions: closed forms, folds against harmonic balance, stability, files and words."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from house import sdof, sdof_text

import wirerope_mj as wr
from wirerope_mj.dynamics.arclength import corrected
from wirerope_mj.dynamics.periodic import backbone, harmonic_content, resonances
from wirerope_mj.dynamics.periodic.continuation import Continuation
from wirerope_mj.dynamics.periodic.growing import GrowingBranch
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import close, monodromy, shot
from wirerope_mj.dynamics.periodic.variational import variational_of

HARDENING = wr.SymmetricBoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0, k1=0.5, k2=0.0, k3=0.3)
ALONG = {"direction": "z", "payload": "mass"}


@pytest.fixture(scope="module")
def hardening():
    """The S of a hardening mount: two folds, 0.39 and 0.24 Hz."""
    return wr.follow_branch(sdof(HARDENING, mass=1.0), start=0.15, stop=0.5, acceleration=1.0, largest_step=0.05, **ALONG)


def test_a_linear_mount_has_its_transmissibility_all_along():
    mass, k, c = 3.5, 2.0e4, 60.0
    branch = wr.follow_branch(
        sdof(wr.KelvinVoigt(k=k, c=c), mass=mass), start=6.0, stop=24.0, acceleration=4.0, largest_step=0.1, **ALONG
    )
    omega = 2.0 * np.pi * branch.frequency
    exact = np.abs((k + 1j * omega * c) / (k - mass * omega**2 + 1j * omega * c))
    assert branch.transmissibility == pytest.approx(exact, rel=2e-5)  # RK4 with 128 steps, tolerance 1e-6 over the gap
    assert branch.complete
    assert branch.frequency[-1] == pytest.approx(24.0, rel=1e-12)
    assert branch.bifurcations == ()
    assert branch.stable.all()


def test_a_branch_passes_through_the_orbits_found_alone():
    system = sdof(HARDENING, mass=1.0)
    branch = wr.follow_branch(system, start=0.15, stop=0.2, acceleration=0.3, accuracy=1e-5, **ALONG)
    i = branch.frequency.size // 2
    alone = wr.periodic_orbit(
        system, frequency=branch.frequency[i], acceleration=0.3, direction="z", accuracy=1e-5, tolerance=1e-10
    )
    assert branch.amplitude[i] == pytest.approx(alone.response.peaks.bodies["mass"].acceleration.value, rel=1e-5)
    again = branch.orbit(i)
    assert again.response.peaks.bodies["mass"].acceleration.value == pytest.approx(branch.amplitude[i], rel=1e-6)
    # both by the variational equation, from motions that close to 1e-6 and 1e-10
    assert np.abs(branch.floquet_multipliers[i, :3]) == pytest.approx(np.abs(alone.floquet_multipliers), abs=1e-4)


def test_a_hardening_mount_has_two_folds_and_an_unstable_middle(hardening):
    upper, lower = hardening.folds
    # With 4048 steps of a period; the upper one, at the tip of a needle, is 1.15e-4 below it with the 128 taken here, 2.0e-5
    # below with 256, 2.4e-5 above with 406: the steps' own error, of 1e-4 of the motion. The lower one is 2.4e-6 below.
    assert upper.frequency == pytest.approx(0.3955667, rel=1.5e-4)
    assert lower.frequency == pytest.approx(0.2365912, rel=1e-5)
    middle = slice(upper.index + 1, lower.index)
    assert not hardening.stable[middle].any()
    assert np.abs(hardening.floquet_multipliers[middle, 0].real).min() > 1.0
    assert hardening.stable[: upper.index - 1].all()
    assert hardening.stable[lower.index + 1 :].all()
    assert np.count_nonzero(np.abs(hardening.floquet_multipliers[middle]) > 1.0) == lower.index - upper.index - 1
    assert (upper.before, upper.after, lower.before, lower.after) == (0, 1, 1, 0)


def test_jumps_land_on_the_other_stable_sheet(hardening):
    rising, falling = hardening.jumps
    assert rising.rising
    assert not falling.rising
    assert rising.landing < 0.02 * rising.amplitude
    assert falling.landing > 2.5 * falling.amplitude
    settled = wr.periodic_orbit(hardening.system, frequency=rising.parameter * 1.001, acceleration=1.0, direction="z")
    assert settled.response.peaks.bodies["mass"].acceleration.value == pytest.approx(rising.landing, rel=1e-2)


@pytest.mark.slow
def test_the_same_branch_is_found_backwards(hardening):
    back = wr.follow_branch(hardening.system, start=0.5, stop=0.15, acceleration=1.0, largest_step=0.05, **ALONG)
    found = sorted(fold.frequency for fold in back.folds)
    lower, upper = sorted(fold.frequency for fold in hardening.folds)
    assert found[0] == pytest.approx(lower, rel=1e-7)
    # The upper one is the tip of a needle: a residual of 1e-8, to which folds are corrected, moves it by 1e-7, and the search
    # ends within 1e-6 of where the tangent turns.
    assert found[1] == pytest.approx(upper, rel=1e-5)
    assert [jump.rising for jump in back.jumps] == [False, True]


def test_a_branch_in_the_level_meets_a_branch_in_the_frequency(hardening):
    level = wr.follow_branch(hardening.system, start=0.05, stop=3.0, frequency=0.26, largest_step=0.1, **ALONG)
    assert level.parameter == "acceleration"
    assert len(level.folds) == 2
    own = crossings(hardening.frequency, hardening.amplitude, 0.26)
    other = crossings(level.acceleration, level.amplitude, 1.0)
    assert len(own) == len(other) == 3
    assert own == pytest.approx(other, rel=5e-3)  # straight lines between points 5 and 10 % apart


def crossings(parameter, amplitude, value):
    """Return the amplitudes at which a branch passes a value of its parameter, sorted."""
    places = np.flatnonzero(np.diff(np.sign(parameter - value)))
    share = (value - parameter[places]) / (parameter[places + 1] - parameter[places])
    return sorted(amplitude[places] + share * (amplitude[places + 1] - amplitude[places]))


def test_symmetry_breaking_is_told_from_a_fold():
    branch = wr.follow_branch(sdof(HARDENING, mass=1.0), start=0.085, stop=0.12, acceleration=1.0, **ALONG)
    assert [b.kind for b in branch.bifurcations] == ["symmetry breaking"] * 2
    assert branch.folds == ()
    lost, regained = branch.bifurcations
    assert (lost.before, lost.after) == (0, 1)
    assert "stability is lost" in lost.description
    inside = (branch.frequency > lost.frequency * 1.001) & (branch.frequency < regained.frequency * 0.999)
    assert not branch.stable[inside].any()
    # at this frequency the motion that is reached by itself is another one, without the symmetry: even harmonics
    middle = float(np.sqrt(lost.frequency * regained.frequency))
    reached = wr.periodic_orbit(branch.system, frequency=middle, acceleration=1.0, direction="z")
    content = harmonic_content(reached, payload="mass")
    symmetric = harmonic_content(branch.orbit(int(np.argmin(np.abs(branch.frequency - middle)))), payload="mass")
    assert reached.stable
    assert content.of(2) > 0.1 * content.of(1)
    assert symmetric.of(2) < 1e-5 * symmetric.of(1)


def test_pure_bouc_wen_is_never_called_unstable():
    law = wr.BoucWen(alpha=1.0, beta=0.8, gamma=0.2, n=1.0)
    branch = wr.follow_branch(sdof(law, mass=1.0), start=0.08, stop=0.25, acceleration=0.3, **ALONG)
    assert (branch.neutral == 1).all()
    assert branch.stable.all()
    assert branch.bifurcations == ()
    # domain facts 6.2: peak 0.783 at omega = 0.84 on a grid of 0.01
    (peak,) = [r for r in resonances(branch) if r.ratio < 1.5]
    assert peak.frequency * 2.0 * np.pi == pytest.approx(0.84, abs=0.005)
    assert peak.amplitude == pytest.approx(0.783, abs=5e-4)


def test_the_backbone_of_a_softening_mount_falls():
    branches = [
        wr.follow_branch(
            sdof(wr.BoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0, k=0.1), mass=1.0),
            start=0.1, stop=0.2, acceleration=level, largest_step=0.04, **ALONG,
        )
        for level in (0.3, 0.1, 0.2)
    ]  # fmt: skip
    line = backbone(branches)
    assert line.acceleration.tolist() == [0.1, 0.2, 0.3]
    assert (np.diff(line.frequency) < 0.0).all()
    assert (np.diff(line.amplitude) > 0.0).all()


def test_smoothing_is_a_small_step_away_and_stays_stable():
    law = wr.BoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0, k=0.1)
    plain, smooth = (
        wr.follow_branch(sdof(law, mass=1.0), start=0.1, stop=0.2, acceleration=0.3, smoothing=s, **ALONG) for s in (None, 0.03)
    )
    assert smooth.amplitude[smooth.peak] == pytest.approx(plain.amplitude[plain.peak], rel=1e-3)
    assert smooth.stable.all()
    at_peak = smooth.orbit(smooth.peak)
    assert at_peak.smoothing_width == smooth.smoothing_width[smooth.peak] > 0.0
    velocity = np.abs(np.gradient(at_peak.response.mounts["m1"].deflection[:, 2], at_peak.response.time)).max()
    assert at_peak.smoothing_width == pytest.approx(0.03 * velocity, rel=0.05)  # the width is that of the point before


@pytest.mark.slow
def test_the_variational_equation_gives_the_columns_integrated_one_by_one():
    system = wr.load_system("models/floating_floor.xml")
    search = OrbitSearch(system, direction="z", history="relaxed", accuracy=1.5625e-6)  # 1024 steps per period
    with search.flow.ready():
        drive = search.drive(8.0, 1.0)
        x = search.settled(search.coordinates.rest(), drive, 20)
        found = close(search.flow, shot(search.flow, x, drive), tolerance=1e-6, iterations=10)
        before = search.flow.steps
        columns = monodromy(search.flow, found)
        middle = search.flow.steps
        quick = variational_of(search.flow).matrix(found)
        after = search.flow.steps
    assert after - middle < (middle - before) / 3.5  # a forward pass for each column where that takes four
    exact, ours = (np.linalg.eigvals(matrix) for matrix in (columns, quick))
    distance = [np.abs(ours - value).min() for value in exact]
    # Both miss where a reversal stands within a step, differently: 1.5e-2 with 128 steps, 1.2e-3 with 512, 9e-4 with 1024;
    # single entries by 3.9e-2, 8.6e-3 and 4.7e-3 of the largest. On one scale: 1.6e-2, 4.0e-3, 2.1e-3.
    assert max(distance) < 2e-3
    assert np.abs(columns - quick).max() < 6e-3 * np.abs(columns).max()


def test_states_near_their_bounds_do_not_grow_in_the_variational_equation():
    """Those of the floor along x settle within a step of 128; RK4 over two made multipliers of 500 000 of it."""
    search = OrbitSearch(wr.load_system("floating_floor"), direction="x", history="relaxed", accuracy=1e-4)
    with search.flow.ready():
        drive = search.drive(6.2673, 1.0)
        found = search.closed(shot(search.flow, search.settled(search.coordinates.rest(), drive, 60), drive), 1e-6)
        quick, columns = variational_of(search.flow).matrix(found), monodromy(search.flow, found)
    ours, exact = (np.abs(np.linalg.eigvals(matrix)).max() for matrix in (quick, columns))
    assert ours == pytest.approx(exact, abs=1e-4)  # 0.99832, no reversal within a step matters to the slowest


@pytest.mark.slow
def test_a_branch_that_is_interrupted_goes_on_from_its_last_point(tmp_path, monkeypatch):
    system = sdof(HARDENING, mass=1.0)
    asked = {"start": 0.2, "stop": 0.5, "acceleration": 1.0, "largest_step": 0.05, **ALONG}
    whole = wr.follow_branch(system, **asked)
    advance, taken = GrowingBranch._advance, [0]

    def interrupted(self, *arguments):
        taken[0] += 1
        if taken[0] % 9 == 0:
            raise KeyboardInterrupt
        return advance(self, *arguments)

    monkeypatch.setattr(GrowingBranch, "_advance", interrupted)
    for _attempt in range(30):
        try:
            parts = wr.follow_branch(system, out=tmp_path, **asked)
            break
        except KeyboardInterrupt:
            assert [p.name for p in tmp_path.iterdir()] == ["branch.parquet"]
    assert taken[0] > 18
    assert parts.complete
    assert [b.kind for b in parts.bifurcations] == [b.kind for b in whole.bifurcations] == ["fold", "fold"]
    # Points differ, and a fold is looked for between them: to the accuracy of the steps, 1e-4.
    assert [b.frequency for b in parts.folds] == pytest.approx([b.frequency for b in whole.folds], rel=1e-4)
    monkeypatch.setattr(GrowingBranch, "_advance", advance)
    again = wr.follow_branch(system, out=tmp_path, **asked)
    assert np.array_equal(again.unknowns, parts.unknowns)
    assert np.array_equal(again.floquet_multipliers, parts.floquet_multipliers, equal_nan=True)
    with pytest.raises(wr.RecordError, match=r"holds another branch: its stop is 0\.5, not 0\.6"):
        wr.follow_branch(system, out=tmp_path, **asked | {"stop": 0.6})


def test_a_branch_ends_where_a_mount_leaves_its_travel():
    isolator = wr.Isolator(name="a", axial=HARDENING, limits=wr.Limits(travel=wr.Travel(compression=2.0, tension=2.0)))
    system = wr.load_system(sdof_text(mass=1.0), isolators={"a": isolator})
    branch = wr.follow_branch(system, start=0.15, stop=0.5, acceleration=1.0, largest_step=0.05, **ALONG)
    assert not branch.complete
    assert "mount 'm1' reaches 200" in branch.message  # within 0.1 % of the frequency
    assert "rated for 2000 mm" in branch.message
    assert branch.frequency[-1] < 0.3


def test_continuation_steps_have_the_length_that_was_asked_for():
    """Predictor and corrector work in the same units: the arclength between two points is the step."""
    search = OrbitSearch(sdof(HARDENING, mass=1.0), direction="z", history="relaxed", accuracy=1e-4)
    path = Continuation(search, parameter="frequency", held=1.0, periods=1, unit=0.02, tolerance=1e-9)
    with search.flow.ready():
        x = search.settled(search.coordinates.rest(), path.drive(0.2), 30)
        found = close(search.flow, shot(search.flow, x, path.drive(0.2)), tolerance=1e-9, iterations=20)
        first = path.point(found, 0.2, before=None)
        second = path.step(first, 0.3)
    moved = np.append(
        (second.shot.x - first.shot.x) / first.shot.scale / (0.25 * np.sqrt(3)), np.log(second.parameter / 0.2) / 0.02
    )
    assert moved @ first.tangent == pytest.approx(0.3, rel=1e-9)


def test_a_payload_that_does_not_move_along_the_response_is_named():
    with pytest.raises(ValueError, match="`response_direction`: mass does not move along x"):
        wr.follow_branch(sdof(HARDENING), **BASE, response_direction="x")


def test_a_guess_of_another_system_is_refused():
    orbit = wr.periodic_orbit(sdof(HARDENING, mass=1.0), frequency=0.15, acceleration=0.3, direction="z")
    floor = wr.load_system("models/floating_floor.xml")
    with pytest.raises(ValueError, match="a state of this system has"):
        wr.periodic_orbit(floor, frequency=5.0, acceleration=0.3, direction="z", guess=orbit.state)
    with pytest.raises(ValueError, match="`guess` must be a State"):
        wr.periodic_orbit(floor, frequency=5.0, acceleration=0.3, direction="z", guess="x")


@pytest.mark.slow
def test_a_needle_of_a_superharmonic_resonance_is_followed():
    """The cabinet's fifth harmonic meets an undamped mode near 26.1 Hz, and the branch passes through its half percent.

    The mounts' friction yields over 8 mm here, so that small cycles lose nothing: with the catalogue's, which yields
    below a millimetre, there is no such needle.
    """
    across = wr.SymmetricBoucWen(alpha=180e3, beta=123.0, gamma=0.0, n=1.0, k1=78.4e3, k2=0.0, k3=45.4e6)
    axial = wr.AsymmetricBoucWen(
        alpha=751e3, beta=118.0, gamma=0.0, n=1.0, k1=392e3, k2=0.0, k3=0.0, b=np.e, c=5.70
    )  # fmt: skip
    late = wr.Isolator(name="late", axial=axial, shear=across, roll=across)
    branch = wr.follow_branch(
        wr.load_system("models/cabinet.xml", isolators={"cb1400_15": late}), start=5.14, stop=5.32, acceleration=1.0,
        direction="z", payload="rack", largest_step=0.05,
    )  # fmt: skip
    assert branch.complete
    assert branch.gaps == ()
    assert branch.stable.all()
    # Where the harmonic meets the mode it is higher than farther on, where the branch has long been rising again.
    assert branch.frequency[branch.amplitude[branch.frequency < 5.25].argmax()] == pytest.approx(26.1 / 5.0, rel=2e-3)


BASE = {"start": 0.1, "stop": 0.2, "acceleration": 0.3, "direction": "z", "payload": "mass"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"start": -1.0}, "`start` must be > 0"),
        ({"stop": 0.0}, "`stop` must be > 0"),
        ({"stop": 0.1}, "`stop` must differ from `start`.* periodic_orbit"),
        ({"payload": "table"}, "`payload` must be one of 'mass', got 'table'"),
        ({"direction": "w"}, "`direction` must be"),
        ({"response_direction": "w"}, "`response_direction` must be"),
        ({"frequency": 1.0}, "give either `acceleration`"),
        ({"acceleration": None}, "give either `acceleration`"),
        ({"largest_step": 1e-6}, "`smallest_step` must be below `largest_step`"),
        ({"largest_step": 1.5}, "and that below 1"),
        ({"most_points": 0}, "`most_points` must be an integer"),
        ({"smoothing": -0.1}, "`smoothing` must be > 0"),
    ],
)
def test_bad_arguments_are_named(change, message):
    with pytest.raises(ValueError, match=message):
        wr.follow_branch(sdof(HARDENING), **BASE | change)


def test_smoothing_needs_a_law_that_can_be_smoothed():
    with pytest.raises(ValueError, match="`smoothing` has nothing to smooth"):
        wr.follow_branch(sdof(wr.KelvinVoigt(k=1.0, c=0.1)), **BASE, smoothing=0.01)


@pytest.mark.slow
def test_the_floating_floor_is_followed_through_its_first_resonances():
    # With the axes of every mount by themselves.
    isolators = wr.load_system("models/floating_floor.xml").isolators
    apart = {name: dataclasses.replace(isolator, coupling=None, loop=None) for name, isolator in isolators.items()}
    system = wr.load_system("models/floating_floor.xml", isolators=apart)
    vertical = wr.follow_branch(system, start=4.0, stop=14.0, acceleration=1.0, direction="z", payload="floor")
    assert vertical.complete
    assert vertical.stable.all()
    main = max(resonances(vertical), key=lambda r: r.amplitude)
    assert main.frequency == pytest.approx(8.63, abs=0.1)
    settled = wr.stepped_sine(
        system, frequencies=main.frequency * np.array([0.99, 1.0, 1.01]), acceleration=1.0, direction="z",
        payload="floor", settled=1e-5,
    )  # fmt: skip
    assert settled.amplitude.argmax() == 1  # 4.4675, 4.4949 and 4.4709 m/s^2
    assert settled.amplitude[1] == pytest.approx(vertical.amplitude[vertical.peak], rel=1e-3)


def test_friction_that_yields_within_a_tenth_of_a_millimetre_is_stepped_as_it_settles():
    """With 128 steps a period it made RK4 grow: multipliers of 50 that are none, and the branch ended at 4.278 Hz."""
    system = wr.load_system("shock_table")
    table = {"acceleration": 3.0, "direction": "x", "payload": "block"}
    branch = wr.follow_branch(system, start=4.25, stop=4.7, **table)
    assert branch.complete
    assert branch.gaps == ()
    assert branch.stable.all()
    assert branch.steps[-1] > 500
    settled = wr.stepped_sine(system, frequencies=[4.7], **table)
    # 1e-4 of settling and of each integration; of 1000 cycles of settling the slowest mode leaves nothing.
    assert branch.amplitude[-1] == pytest.approx(settled.amplitude[0], rel=1e-3)


def test_axes_that_hardly_move_do_not_stop_a_branch():
    """Their friction has multipliers within 5e-7 of 1, along which a residual of 1e-6 is no error: it ended at 166.06 Hz."""
    system = wr.load_system("shock_table_frame")
    branch = wr.follow_branch(system, start=150.0, stop=170.0, acceleration=0.5, direction="z", payload="block")
    assert branch.complete
    assert branch.gaps == ()


@pytest.mark.slow
def test_a_branch_goes_on_where_slow_directions_hold_what_the_tolerance_leaves():
    """A gap of 3e-6 was corrected along a direction that takes 100 000 periods: the branch ended at 56.8 Hz."""
    system = wr.load_system("cabinet")
    asked = {"acceleration": 0.5, "direction": "x", "payload": system.payloads[0]}
    branch = wr.follow_branch(system, start=56.0, stop=58.3, **asked)
    assert branch.complete
    assert branch.gaps == ()
    assert branch.stable.all()


def test_friction_that_is_hardly_moved_does_not_end_a_branch():
    """In its own range of 1e-4 N, beside 40 N in shear, the axial friction closed to no more than 2e-6: it ended at 2.72 Hz."""
    system = wr.load_system("shock_table_frame")
    branch = wr.follow_branch(system, start=2.2, stop=2.8, acceleration=1.0, direction="y", payload="block")
    assert branch.complete
    assert branch.gaps == ()


def test_a_correction_that_leads_beyond_all_parameters_is_given_up():
    """Of a floor along x one led to a frequency of 4e12 Hz, and an error message about it."""
    asked = []

    def at(move):
        asked.append(move)
        return SimpleNamespace(residuals=np.array([1.0]))

    flat, row = np.array([[0.0, 1e-5]]), np.array([1.0, 0.0])
    assert corrected(at, lambda *_: flat, flat, np.zeros(2), row, 0.0, 1e-6) is None
    assert len(asked) == 1  # the next would be 100 000 steps away


@pytest.mark.slow
def test_a_branch_goes_on_past_stops_that_are_grazed():
    """At 49.6 Hz the resonance of the rig reaches its stops, 15 mm below, where the map of a period has a kink."""
    branch = wr.follow_branch(wr.load_system("sdof_shaker"), start=30.0, stop=60.0, acceleration=20.0, **ALONG)
    assert branch.complete
    assert branch.gaps, branch.message
    assert "not followed" in branch.message
    before, after = branch.frequency < 49.5, branch.frequency > 52.0
    assert branch.amplitude[before].max() > 1900.0  # m/s^2: large enough for the stops
    assert branch.amplitude[after].max() < 40.0  # the other stable motion, to which a table falls as well
    assert branch.stable[before | after].all()


def test_a_branch_that_ends_gives_no_advice_that_was_not_tried(monkeypatch):
    monkeypatch.setattr(GrowingBranch, "_search_beyond", lambda self, last: None)
    monkeypatch.setattr(Continuation, "step", lambda *a, **k: None)
    branch = wr.follow_branch(sdof(HARDENING, mass=1.0), start=0.15, stop=0.5, acceleration=1.0, **ALONG)
    assert not branch.complete
    assert branch.message == (
        "stopped at 0.15 Hz: no periodic motion was found within 1e-05 of it, nor up to 0.08 beyond it, also after 60 periods "
        "of settling there"
    )
