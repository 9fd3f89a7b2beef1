"""Sweeps against closed forms of linear mounts, and what they say where things go wrong."""

import json

import numpy as np
import pytest
from house import deck, hysteresis, mjcf, sdof, sdof_text
from shaken_mass import DAMPING, LEVEL, MASS, MOUNT, RESONANCE, hysteretic, linear, transmitted, up

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError, RecordError, SimulationError
from wirerope_mj.foundation.resources import models_folder

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def system():
    return sdof(linear(), mass=MASS)


COURSES = {"up": (6.5, 16.0), "down": (16.0, 6.5)}


@pytest.fixture(scope="module")
def swept(system):
    """Return sweeps by rate [octaves/min] and course."""
    return {
        (rate, course): wr.frequency_sweep(system, up(rate, *COURSES[course]), timestep=2e-3, **MOUNT)
        for rate, course in ((1.0, "up"), (2.0, "up"), (2.0, "down"), (4.0, "up"), (4.0, "down"))
    }


def error(r):
    """Return the relative difference from the steady response."""
    return r.transmissibility / transmitted(r.frequency) - 1


FLANKS = np.array([7.0, 8.0, 8.5, 13.0, 14.0, 15.0])  # where no crest is just passing from one cycle to the next


def on_flanks(r):
    order = np.argsort(r.frequency)
    return np.interp(FLANKS, r.frequency[order], error(r)[order])


def first_order(sweep):
    """Return the largest acceleration in every whole cycle of a sweep, up to first order in its rate.

    With phase(t - tau) = phase - w tau + w' tau^2 / 2 the response to sin(phase) is Im[(H - (i w' / 2) H'') e^(i phase)].
    """
    w0 = 2 * np.pi * RESONANCE

    def response(w):
        return (w0**2 + 2j * DAMPING * w0 * w) / (w0**2 - w**2 + 2j * DAMPING * w0 * w)

    instants = sweep.course.whole_cycles()
    time = np.linspace(instants[:-1], instants[1:], 601, axis=1)  # a crest is met within pi / 600, whose square is 3e-5
    w, h = 2 * np.pi * sweep.frequency(time.ravel()), 0.01
    bend = (response(w + h) - 2 * response(w) + response(w - h)) / h**2
    quickening = sweep.course.sign * sweep.course.growth * w
    motion = np.imag((response(w) - 0.5j * quickening * bend) * np.exp(1j * sweep.course.phase(time.ravel())))
    return LEVEL * np.abs(motion).reshape(time.shape).max(axis=1)


def test_a_slow_sweep_is_within_half_a_percent_of_the_steady_response(swept):
    # At one octave per minute the frequency grows by K / (zeta w) = 7e-4, K = ln 2 / 60 1/s, while transients decay. Where
    # the response is steepest, d ln T / d ln f = 2.8, that is 0.2 % behind; and a cycle's largest value stands up to half a
    # cycle beside its middle, K / (2 f) 2.8 = 0.16 %.
    assert np.abs(error(swept[1.0, "up"])).max() < 5e-3
    assert np.abs(error(swept[2.0, "up"])).max() > 5e-3  # the test can tell twice the rate


@pytest.mark.parametrize("rate", [2.0, 4.0])
@pytest.mark.parametrize("course", COURSES)
def test_a_sweep_lags_as_the_first_order_says(swept, rate, course):
    r = swept[rate, course]
    wrong = np.abs(r.amplitude / first_order(r.sweep) - 1)[3:]  # but for the change from the steady sine to the sweep
    # Second order: a few times (K / (zeta^2 w))^2 = 1.4e-4 at four octaves per minute; the lag itself is up to 1.4 %.
    assert np.quantile(wrong, 0.97) < 6e-4 * (rate / 4.0) ** 2 + 5e-5
    # A crest within half a step of a cycle's end is counted to one or the other: one cycle's growth, K / f 2.8.
    assert wrong.max() < rate * np.log(2) / 60 / 6.5 * 2.8


def test_the_lag_halves_with_the_rate_and_changes_sides_with_the_course(swept):
    lag = {rate: (on_flanks(swept[rate, "up"]) - on_flanks(swept[rate, "down"])) / 2 for rate in (2.0, 4.0)}
    np.testing.assert_allclose(lag[4.0] / lag[2.0], 2.0, rtol=0.03)  # what remains is of second order
    assert np.all(np.sign(lag[2.0]) == np.sign(FLANKS - RESONANCE))  # lower on the rising flank, higher on the falling one
    for rate in lag:
        # A cycle's largest value stands at its higher end in both courses: it is all that the two have in common.
        both = on_flanks(swept[rate, "up"]) + on_flanks(swept[rate, "down"])
        assert np.all(both > 0.0)
        assert np.all(both < rate * np.log(2) / 60 / FLANKS * 2.8)


@pytest.mark.parametrize(("quantity", "amplitude", "power"), [("velocity", 0.03, 1), ("displacement", 1e-3, 2)])
def test_sweeps_of_constant_velocity_or_displacement_shake_the_base_as_they_say(system, quantity, amplitude, power):
    r = wr.frequency_sweep(system, up(4.0, 5.0, 18.0, **{quantity: amplitude}), timestep=1e-3, **MOUNT)
    # The frequency grows by K / f = 0.9 % in a cycle at 5 Hz, and the base's acceleration by its power of that, from the
    # cycle's middle to its end by half of it: 1 %.
    np.testing.assert_allclose(r.base_amplitude, amplitude * (2 * np.pi * r.frequency) ** power, rtol=1.1e-2)
    np.testing.assert_allclose(r.transmissibility, transmitted(r.frequency), rtol=3e-2)  # the lag, four times that above
    np.testing.assert_allclose(r.amplitude, r.transmissibility * r.base_amplitude, rtol=1e-14)
    assert r.sweep == up(4.0, 5.0, 18.0, **{quantity: amplitude})


def test_a_cycle_holds_what_the_whole_history_has_in_it():
    system = hysteretic()
    sweep = up(30.0, 12.0, 40.0, acceleration=5.0)
    r = wr.frequency_sweep(system, sweep, timestep=2e-4, **MOUNT)
    instants = sweep.course.whole_cycles()
    assert r.final_state.time == instants[-1]
    history = wr.simulate(
        system, r.sweep, duration=r.final_state.time, initial=r.initial_state, timestep=2e-4, sample_rate=5000.0
    )
    cycle = np.searchsorted(instants, history.time, side="right") - 1
    values = np.abs(history.bodies["mass"].acceleration)
    deflections = history.mounts["m1"].deflection
    for number in range(1, instants.size - 1):
        inside = cycle == number
        # Steps at other instants, samples beside the crest, (w h)^2 / 8 = 3e-4 at 40 Hz and 2e-4 s, and kinks between steps.
        np.testing.assert_allclose(r.envelopes["mass"].acceleration[number, 2], values[inside, 2].max(), rtol=5e-4)
        np.testing.assert_allclose(r.mounts["m1"].minimum[number, 2], deflections[inside, 2].min(), rtol=2e-3)
        np.testing.assert_allclose(r.mounts["m1"].maximum[number, 2], deflections[inside, 2].max(), rtol=2e-3)
    middles = (instants[:-1] + instants[1:]) / 2
    np.testing.assert_array_equal(r.frequency, sweep.frequency(middles))
    np.testing.assert_array_equal(r.deflection[0], np.maximum(r.mounts["m1"].maximum, -r.mounts["m1"].minimum))


def test_a_sweep_begins_on_the_response_and_goes_on_from_the_end_of_another(system):
    rising = wr.frequency_sweep(system, up(6.0, 8.0, 20.0), timestep=1.2e-3, **MOUNT)
    down = up(6.0, 20.0, 10.0)
    options = {"timestep": 1.2e-3, **MOUNT}
    runs = {
        "led in": wr.frequency_sweep(system, down, **options),
        "gone on": wr.frequency_sweep(system, down, settled=None, initial=rising.final_state, **options),
        "at once": wr.frequency_sweep(system, down, settled=None, **options),
    }
    errors = {name: r.transmissibility[:3] / transmitted(r.frequency[:3]) - 1 for name, r in runs.items()}
    # From steady motion it is the lag, 2 % at this rate; a mass that at once moves with the base rings at its own frequency.
    assert np.abs(errors["led in"]).max() < 5e-3
    assert np.abs(errors["gone on"]).max() < 2e-2
    assert np.abs(errors["at once"]).max() > 0.3
    assert runs["led in"].model_steps > runs["at once"].model_steps
    # What has once decayed is forgotten: seven decay times later all are the same.
    late = runs["at once"].frequency < 17.0
    for name in ("led in", "gone on"):
        np.testing.assert_allclose(runs[name].amplitude[late], runs["at once"].amplitude[late], rtol=1e-3)


def test_bodies_on_a_payload_have_envelopes_of_their_own():
    lamp, stiffness, damping = 0.5, 0.5 * (2 * np.pi * 16.0) ** 2, 6.0
    world = deck({"b": 'pos="0 0 .2"'}, slides="z") + (
        f'<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="{MASS}"/>'
        '<site name="p" pos="0 0 -.1"/><body name="lamp" pos="0 0 .2"><joint type="slide" axis="0 0 1" '
        f'stiffness="{stiffness!r}" damping="{damping}"/><geom size=".05" mass="{lamp}"/></body></body>'
    )
    isolators = {"a": wr.Isolator(name="a", axial=linear())}
    system = wr.load_system(mjcf(world, [("m1", "p", "b", "a")]), isolators=isolators)
    frequencies = np.array([6.0, 9.0, 16.0, 19.0])
    r = wr.stepped_sine(system, frequencies=frequencies, acceleration=LEVEL, direction="z", payload="lamp", timestep=1e-3)
    assert list(r.envelopes) == ["mass", "lamp"]  # payloads first, the deck is none
    w = 2 * np.pi * frequencies
    mount, joint = linear().k + 1j * w * linear().c, stiffness + 1j * w * damping
    # Two masses in absolute coordinates per unit of the base: -w^2 m1 x1 = mount (1 - x1) + joint (x2 - x1), and so on.
    x1 = mount / (mount + joint - MASS * w**2 - joint**2 / (joint - lamp * w**2))
    x2 = x1 * joint / (joint - lamp * w**2)
    np.testing.assert_allclose(r.envelopes["mass"].transmissibility[:, 2], np.abs(x1), rtol=3e-4)
    np.testing.assert_allclose(r.transmissibility, np.abs(x2), rtol=3e-4)


def duffing(amplitude, stiffness, cubic, damping, forcing):
    """Return the two frequencies [Hz] at which a hardening mass swings by a deflection amplitude, by harmonic balance.

    (k + 3/4 k3 X^2 - m w^2)^2 + (c w)^2 = (m a / X)^2.
    """
    secant = stiffness + 0.75 * cubic * amplitude**2
    b = 2 * MASS * secant - damping**2
    root = np.emath.sqrt(b**2 - 4 * MASS**2 * (secant**2 - (MASS * forcing / amplitude) ** 2))
    return [np.sqrt((b + sign * root) / 2) / MASS / (2 * np.pi) for sign in (-1, 1)]


def test_a_hardening_mount_jumps_at_its_folds_later_on_the_way_up_than_on_the_way_down():
    linear_part, cubic, forcing = linear(damping=0.05), 1.4e8, 4.0
    hardening = wr.SymmetricBoucWen(**hysteresis(alpha=1e-3, z_max=1e-6), k1=0.0, k2=0.0, k3=cubic)
    world = deck({"b": 'pos="0 0 .2"'}, slides="z") + (
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/>'
        f'<geom size=".1" mass="{MASS}"/><site name="p" pos="0 0 -.1"/></body>'
    )
    isolators = {"a": wr.Isolator(name="a", axial=linear_part), "h": wr.Isolator(name="h", axial=hardening)}
    system = wr.load_system(mjcf(world, [("m1", "p", "b", "a"), ("m2", "p", "b", "h")]), isolators=isolators)
    low, high = duffing(np.linspace(1e-4, 1.2e-2, 20001), linear_part.k, cubic, linear_part.c, forcing)
    there = np.abs(np.imag(low)) < 1e-9
    folds = {"up": np.real(low[there]).max(), "down": np.real(high[there]).min()}
    options = {"timestep": 1e-3, **MOUNT}
    beyond = []
    for rate in (4.0, 1.0):
        rising = wr.frequency_sweep(system, up(rate, 10.0, 13.5, acceleration=forcing), **options)
        falling = wr.frequency_sweep(system, up(rate, 13.5, 10.0, acceleration=forcing), initial=rising.final_state, **options)
        # Between the folds the two are on different responses, outside on the same but for their lag, 4 % at most.
        both = [np.interp([10.1, 12.0], *by_frequency(r)) for r in (rising, falling)]
        assert both[0][1] > 2.0 * both[1][1]
        assert both[0][0] == pytest.approx(both[1][0], rel=0.05)
        beyond.append((jump(rising) / folds["up"] - 1, 1 - jump(falling) / folds["down"]))
    fast, slow = np.array(beyond)
    assert np.all(slow > 0.0)
    # At a fold the response is left behind by the power 2/3 of the rate: 4^(2/3) = 2.5.
    assert np.all(fast > 1.7 * slow)
    assert np.all(slow < 0.03)


def by_frequency(r):
    order = np.argsort(r.frequency)
    return r.frequency[order], r.amplitude[order]


def jump(r):
    return r.frequency[np.argmax(np.abs(np.diff(np.log(r.amplitude))))]


def test_the_hysteretic_share_of_the_load_leaks_away_from_a_virgin_start_only():
    system = hysteretic(gravity=wr.STANDARD_GRAVITY)
    sag = {h: -wr.equilibrium(system, history=h).mounts["m1"].deflection[2] for h in ("virgin", "relaxed")}
    assert sag["relaxed"] > 1.5 * sag["virgin"]
    for history in sag:
        r = wr.frequency_sweep(system, up(60.0, 10.0, 20.0), history=history, settled=None, timestep=5e-4, **MOUNT)
        mean = -(r.mounts["m1"].minimum[:, 2] + r.mounts["m1"].maximum[:, 2]) / 2
        if history == "virgin":
            assert mean[0] < 1.5 * sag["virgin"]
            assert mean[-1] > mean[0] + 0.2 * (sag["relaxed"] - sag["virgin"])  # it sinks towards the other
        else:
            np.testing.assert_allclose(mean, sag["relaxed"], rtol=0.05)


@pytest.fixture(scope="module")
def short(system):
    """Return a short sweep that went straight to its result."""
    return wr.frequency_sweep(system, up(60.0, 6.0, 18.0), timestep=1e-3, settled=None, **MOUNT)


def same(a, b):
    """Assert that two results are equal to the last bit."""
    for name in (
        "frequency",
        "base_amplitude",
        "amplitude",
        "transmissibility",
        "deflection",
        "cycles",
        "remaining",
        "settled",
    ):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    for name in a.envelopes:
        np.testing.assert_array_equal(a.envelopes[name].acceleration, b.envelopes[name].acceleration)
    np.testing.assert_array_equal(a.initial_state.values, b.initial_state.values)
    np.testing.assert_array_equal(a.final_state.values, b.final_state.values)
    for name in (
        "payload",
        "response_direction",
        "excitation",
        "timestep",
        "model_steps",
        "warnings",
        "direction",
        "sweep",
    ):
        assert getattr(a, name) == getattr(b, name)
    assert a.final_state.time == b.final_state.time


def test_a_sweep_comes_back_from_its_file_and_is_replaced_whole(short, tmp_path):
    short.save(tmp_path / "new" / "folder")
    same(wr.load_frequency_sweep(tmp_path / "new" / "folder"), short)
    short.save(tmp_path / "new" / "folder")
    names = sorted(path.name for path in (tmp_path / "new" / "folder").iterdir())
    assert names == ["frequency_sweep.json", "frequency_sweep.parquet"]
    summary = json.loads((tmp_path / "new" / "folder" / "frequency_sweep.json").read_text(encoding="utf-8"))
    assert summary["bodies"]["mass"]["z"]["largest_acceleration_m_s2"] == short.amplitude.max()
    assert summary["bodies"]["mass"]["z"]["at_Hz"] == short.frequency[np.argmax(short.amplitude)]
    assert summary["model_steps"] == short.model_steps


def test_a_sweep_that_streams_to_disk_is_the_same(system, short, tmp_path, monkeypatch):
    monkeypatch.setattr("wirerope_mj.dynamics.sweep.envelope.STREAM_ROWS", 10)  # several blocks
    monkeypatch.setattr("wirerope_mj.dynamics.sweep.sweeps.CHUNK", 4)
    options = {"timestep": 1e-3, "settled": None, **MOUNT}
    same(wr.frequency_sweep(system, up(60.0, 6.0, 18.0), out=tmp_path, **options), short)
    same(wr.load_frequency_sweep(tmp_path), short)
    with pytest.raises(RecordError, match="a sweep stands here already; give another `out`"):
        wr.frequency_sweep(system, up(60.0, 6.0, 18.0), out=tmp_path, **options)


def test_a_folder_without_a_sweep_says_so(tmp_path):
    with pytest.raises(RecordError, match=r"there is no frequency_sweep\.parquet here"):
        wr.load_frequency_sweep(tmp_path)
    (tmp_path / "frequency_sweep.parquet").write_bytes(b"not a table")
    with pytest.raises(RecordError, match="this is not a table that `FrequencySweep.save` wrote"):
        wr.load_frequency_sweep(tmp_path)


def limited(law, **travel):
    limits = wr.Limits(travel=wr.Travel(**travel))
    return wr.load_system(sdof_text(mass=MASS), isolators={"a": wr.Isolator(name="a", axial=law, limits=limits)})


def test_a_rated_travel_that_is_exceeded_is_a_warning_that_says_where():
    system = limited(linear(), compression=1e-3, tension=1.0)
    r = wr.frequency_sweep(system, up(60.0, 6.0, 18.0), timestep=1e-3, **MOUNT)
    (words,) = r.warnings
    lowest = r.mounts["m1"].minimum[:, 2]
    assert -lowest.min() > 1e-3
    where = f"{r.frequency[np.argmin(lowest)]:.5g} Hz"
    assert words == f"mount 'm1' goes {-lowest.min():.4g} m in compression at {where}, beyond its rated 0.001 m."
    r = wr.stepped_sine(system, frequencies=[2.0, 10.0], acceleration=2.0, direction="z", payload="mass", timestep=1e-3)
    assert "compression at 10 Hz" in r.warnings[0]


def test_what_leaves_its_law_is_an_error_that_names_the_frequency_and_leaves_no_file(tmp_path):
    law = wr.BoucWen(alpha=1e4, beta=1.0, gamma=-1.2, n=2.0, k=5e3)
    assert law.finite_travel < 0.05
    options = {"timestep": 5e-4, "out": tmp_path, **MOUNT}
    with pytest.raises(
        SimulationError,
        match=r"at \d+\.?\d* Hz.*mount 'm1' reached .* m on its axial axis, whose law holds up to 0\.03",
    ) as caught:
        wr.frequency_sweep(
            limited(law, compression=0.03, tension=0.03),
            up(60.0, 3.0, 40.0, acceleration=200.0),
            settled=None,
            **options,
        )
    assert 3.0 < float(str(caught.value).split(" Hz")[0].removeprefix("at ")) < 40.0
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"payload": "rack"}, r"`payload` must be a payload of the system, got 'rack'\. Payloads: \['mass'\]"),
        ({"payload": "deck"}, r"`payload` must be a payload of the system, got 'deck'"),
        ({"response_direction": "w"}, "`response_direction` must be one of 'x', 'y', 'z', got 'w'"),
        ({"direction": "z"}, "`direction` is the base's axis, .*; give `response_direction`"),
        (
            {"response_direction": (1.0, 1.0, 0.0)},
            "`response_direction` must lie along x, y or z",
        ),
        (
            {"sweep": wr.Sine(frequency=1.0, acceleration=1.0, direction="z")},
            "`sweep` must be a wirerope_mj.Sweep, got Sine",
        ),
        ({"sweep": up(600.0, 1.0, 1.01)}, "`sweep` ends after .* s, before its first cycle does"),
        ({"settled": 0.0}, "`settled` must be > 0"),
        ({"largest_cycles": 0}, "`largest_cycles` must be an integer >= 1, got 0"),
        ({"timestep": -1.0}, "`timestep` must be > 0"),
        ({"accuracy": 0.0}, "`accuracy` must be > 0"),
        ({"history": "old"}, "`history` must be one of 'virgin', 'relaxed', got 'old'"),
        (
            {"initial": wr.State(values=np.zeros(3), time=0.0)},
            "`initial` must be a State of this system, with .* values",
        ),
    ],
)
def test_bad_arguments_of_a_sweep_are_named(system, change, message):
    arguments = {"sweep": up(60.0), **MOUNT, **change}
    with pytest.raises(ValueError, match=message):
        wr.frequency_sweep(system, arguments.pop("sweep"), **arguments)


def test_a_base_that_cannot_follow_and_a_step_that_is_too_large_are_named(system):
    sideways = wr.Sweep(start=5.0, stop=6.0, rate=60.0, acceleration=1.0, direction="x")
    with pytest.raises(ModelError, match="the motion moves along x, but the base 'deck' has no driven slide there"):
        wr.frequency_sweep(system, sideways, **MOUNT)
    with pytest.raises(SimulationError, match="a step of 0.5 s is too large for the stiffest mount"):
        wr.frequency_sweep(system, up(60.0), timestep=0.5, **MOUNT)


def test_a_vector_along_an_axis_is_that_axis_and_progress_goes_to_standard_error(system, short, capsys):
    options = {"timestep": 1e-3, "settled": None, "payload": "mass"}
    same(wr.frequency_sweep(system, up(60.0, 6.0, 18.0), response_direction=(0, 0, -2), progress=True, **options), short)
    captured = capsys.readouterr()
    assert captured.out == ""
    wr.stepped_sine(system, frequencies=[6.0], acceleration=1.0, direction="z", payload="mass", timestep=1e-3, progress=True)


def test_the_floor_has_an_envelope_for_every_body_and_mount():
    floor = wr.load_system(models_folder() / "floating_floor.xml")
    sweep = wr.Sweep(start=9.0, stop=12.0, rate=60.0, velocity=5e-3, direction=(1.0, 0.0, 1.0))
    r = wr.frequency_sweep(floor, sweep, payload="floor", response_direction="x", settled=None, timestep=1e-3)
    n = r.frequency.size
    assert n == 4  # 3 Hz / (ln 2 1/s) = 4.3 cycles
    assert list(r.envelopes)[: len(floor.payloads)] == floor.payloads
    assert floor.base not in r.envelopes
    assert {"rack_1", "crew_4"} < set(r.envelopes)
    assert r.deflection.shape == (len(floor.mounts), n, 3)
    assert list(r.mounts) == list(floor.mounts)
    for envelope in r.envelopes.values():
        assert envelope.acceleration.shape == envelope.transmissibility.shape == (n, 3)
        assert np.all(envelope.acceleration[:, [0, 2]] > 1e-3)
    np.testing.assert_array_equal(r.amplitude, r.envelopes["floor"].acceleration[:, 0])
    # A crest stands up to a quarter of a cycle beside the middle: half of K / f = 8 % of frequency, the level's growth.
    np.testing.assert_allclose(r.base_amplitude, 5e-3 * 2 * np.pi * r.frequency, rtol=4e-2)


def test_peaks_of_a_law_that_turns_sharply_keep_the_accuracy_told():
    """Pure Bouc-Wen turns with a jump of its slope: z_max 0.73428704 (domain facts 6.2) is the mass' largest acceleration."""
    law = wr.BoucWen(alpha=1.0, beta=1.0, gamma=0.0, n=1.0)
    for accuracy, missed in ((1e-4, 3e-4), (1e-5, 3e-5)):
        found = wr.stepped_sine(
            sdof(law, mass=1.0), frequencies=[0.8 / (2 * np.pi)], acceleration=0.3, direction="z", payload="mass",
            accuracy=accuracy,
        )  # fmt: skip
        assert found.amplitude[0] == pytest.approx(0.73428704, rel=missed)
