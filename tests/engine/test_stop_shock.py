"""A mass that is shocked onto a stop, against a solution split at its events; order, energy, rest and modes on the stop."""

import numpy as np
import pytest
from house import deck, mjcf, sdof
from references import Pulse
from scipy.integrate import cumulative_simpson, solve_ivp
from scipy.optimize import brentq

import wirerope_mj as wr

G = wr.STANDARD_GRAVITY
MASS = 50.0
ROPE = {"alpha": 2.4e5, "beta": 200.0, "gamma": 100.0, "n": 1.0, "k": 8e4}
STOPS = {
    "sharp": {"k": 4e6},
    "round": {"k": 4e6, "rounding": 1e-3},
    "viscous": {"k": 4e6, "rounding": 1e-3, "c": 7e3},
    "lossy": {"k": 4e6, "rounding": 1e-3, "loss": 0.3, "reversal": 1e-3},
    "hardening": {"k": 2e8, "exponent": 1.5, "loss": 0.2, "reversal": 1e-3, "rounding": 1e-3, "c": 3e3},
}
GAP = 0.0256
PULSE = Pulse("half-sine", 40 * G, 0.011, 0.01)
DURATION = 0.12


def guided(stop, *, gravity=0.0):
    """Return the mass on a Bouc-Wen mount with a stop beside it, both vertical."""
    world = (
        deck({"b": 'pos="0 0 .2"', "c": 'pos=".1 0 .2"'}, slides="z")
        + '<body name="mass" pos="0 0 .3"><joint name="mass_z" type="slide" axis="0 0 1"/>'
        f'<geom size=".1" mass="{MASS}"/><site name="p" pos="0 0 -.1"/><site name="q" pos=".1 0 -.1"/></body>'
    )
    text = mjcf(world, [("m1", "p", "b", "rope"), ("s1", "q", "c", "stop")], gravity=gravity)
    laws = {"rope": wr.BoucWen(**ROPE), "stop": wr.Stop(gap_below=GAP, **stop)}
    return wr.load_system(text, isolators={name: wr.Isolator(name=name, axial=law) for name, law in laws.items()})


def solved(*, k, exponent=1.0, rounding=0.0, loss=0.0, reversal=1.0, c=0.0):
    """Return the largest acceleration of the mass and force of the stop of the same without the library, and its contacts.

    x is the deflection, v its rate, z and w the states. Between events the signs of v and z, the region of the stop and
    whether it pushes are constants.
    """
    y, sv, sz, region, pushes = np.zeros(4), -1.0, -1.0, 0, True
    largest, closed = [0.0, 0.0], 0

    def press(y):
        depth = -y[0] - GAP
        if region == 1:
            part = depth / rounding
            counted, share = rounding * (part**3 - part**4 / 2), 3 * part**2 - 2 * part**3
        else:
            counted, share = depth - rounding / 2, 1.0
        return k * max(counted, 0.0) ** exponent * (1 - loss * y[3]) - c * share * y[1]

    def forces(y):
        stop = press(y) if region and pushes else 0.0
        return -(ROPE["k"] * y[0] + y[2] - stop) / MASS, stop

    for begin, end, inside in PULSE.segments(DURATION)[1:]:
        t = begin
        while t < end:

            def rates(t, y, inside=inside, sv=sv, sz=sz):
                bend = ROPE["gamma"] + ROPE["beta"] * sv * sz
                push = PULSE.acceleration(t, inside=inside)
                return [
                    y[1],
                    forces(y)[0] - push,
                    (ROPE["alpha"] - bend * abs(y[2])) * y[1],
                    (sv - y[3]) * abs(y[1]) / reversal if loss else 0.0,
                ]

            # What ends a region, each with the direction in which it does: a state on its own border does not end at once.
            events = [(lambda t, y: y[1], -sv), (lambda t, y: y[2], -sz)]
            events.append((lambda t, y: -y[0] - GAP, 1.0 if region == 0 else -1.0))
            events.append((lambda t, y: -y[0] - GAP - rounding, 1.0 if region < 2 else -1.0) if rounding else None)
            events.append((lambda t, y: press(y), -1.0 if pushes else 1.0) if region else None)
            for event in filter(None, events):
                event[0].terminal, event[0].direction = True, event[1]
            run = solve_ivp(
                rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-14, max_step=2e-4, dense_output=True,
                events=[event[0] for event in events if event], first_step=min(1e-7, (end - t) / 2),
            )  # fmt: skip
            assert run.success, run.message
            # A viscous stop pushes hardest on the way in: a peak between two of 2000 instants is missed by 1e-7 of itself.
            for state in run.sol(np.linspace(t, run.t[-1], 2000)).T:
                acceleration, force = forces(state)
                largest = [max(largest[0], abs(acceleration)), max(largest[1], force)]
            t, y = run.t[-1], run.y[:, -1].copy()
            kinds = [kind for kind, event in enumerate(events) if event]
            hit = [kind for kind, found in zip(kinds, run.t_events, strict=True) if found.size]
            if not hit:
                break
            if hit[0] == 0:
                sv, y[1] = -sv, 0.0
            elif hit[0] == 1:
                sz, y[2] = -sz, 0.0
            elif hit[0] == 2:
                region = (1 if rounding else 2) if region == 0 else 0
                closed, pushes = closed + (region > 0), True
            elif hit[0] == 3:
                region = 2 if region < 2 else 1
            else:
                pushes = not pushes
    return largest[0], largest[1], closed


def shock(level=40.0):
    return wr.HalfSine(peak=level * G, duration=0.011, direction="z", start=0.01)


def run(name, **settings):
    return wr.simulate(guided(STOPS[name]), shock(), duration=DURATION, initial="unloaded", **settings)


def peak_errors(r, reference):
    acceleration, force, _ = reference
    return (
        abs(r.peaks.bodies["mass"].acceleration.value / acceleration - 1.0),
        abs(r.peaks.mounts["s1"].force.value / force - 1.0),
    )


@pytest.mark.parametrize("name", STOPS)
def test_peaks_at_the_step_chosen_for_1e_3_are_within_1e_3(name):
    reference = solved(**STOPS[name])
    assert reference[2] >= 1
    assert reference[1] > 0.5 * MASS * 40 * G / 9.0  # it is struck, not grazed
    r = run(name, accuracy=1e-3)
    found = peak_errors(r, reference)
    print(name, f"step {r.timestep:.3g} s, acceleration {found[0]:.1e}, force {found[1]:.1e}", reference)
    assert max(found) < 1e-3


@pytest.mark.parametrize("name", STOPS)
def test_errors_fall_with_the_square_of_the_step_or_faster(name):
    """The corners of the stop cost no more than those that reversals of the mount have: order 2."""
    steps = np.array([5e-4, 2.5e-4, 1.25e-4, 6.25e-5, 3.125e-5])
    exact = run(name, timestep=2e-6).mounts["s1"].deflection[:, 2]
    found = [np.abs(run(name, timestep=h).mounts["s1"].deflection[:, 2] - exact).max() for h in steps]
    order = np.polyfit(np.log(steps), np.log(found), 1)[0]
    print(name, f"order {order:.2f}", [f"{error / np.abs(exact).max():.1e}" for error in found])
    # Where a corner falls inside its step scatters each error by a factor of a few, over a factor of 16 in the step.
    assert order > 1.8


@pytest.mark.parametrize("name", STOPS)
def test_the_energy_that_the_base_supplies_is_in_the_mass_and_the_laws(name):
    r = run(name, timestep=1e-5, sample_rate=1e5)
    body, work, supplied = r.bodies["mass"], 0.0, 0.0
    velocity = r.base.velocity[:, 2]
    for mount, law in (("m1", wr.BoucWen(**ROPE)), ("s1", wr.Stop(gap_below=GAP, **STOPS[name]))):
        m = r.mounts[mount]
        rate = body.velocity[:, 2] - velocity
        # Along the law's own segments: closed forms and sums between its corners, not those of the engine.
        work = work + law.trace(m.deflection[:, 2], time=r.time, rate=rate).work
        supplied = supplied - m.force[:, 2] * velocity
    put_in = cumulative_simpson(supplied, x=r.time, initial=0.0)
    balance = 0.5 * MASS * body.velocity[:, 2] ** 2 + work - put_in
    peak = np.abs(put_in).max()
    print(name, f"energy balance {np.abs(balance).max() / peak:.1e} of {peak:.0f} J")
    assert np.abs(balance).max() < 1e-6 * peak


@pytest.mark.parametrize("name", STOPS)
def test_a_mass_rests_and_swings_on_its_stop_as_by_hand(name):
    gravity = 80.0  # m/s^2, so that the stop carries the most
    system, stop = guided(STOPS[name], gravity=gravity), wr.Stop(gap_below=GAP, **STOPS[name])
    bound = ROPE["alpha"] / (ROPE["beta"] + ROPE["gamma"])

    def carried(sag):
        rope = ROPE["k"] * sag + bound * (1.0 - np.exp(-(ROPE["beta"] + ROPE["gamma"]) * sag))
        # Let down, the stop is pressed: with its loss when it has been so for several of its lengths.
        return rope + stop.pressed(sag - GAP) * (1.0 + stop.loss * (1.0 - np.exp(-sag / (stop.reversal or 1.0))))

    sag = brentq(lambda x: carried(x) - MASS * gravity, 0.0, 0.1, xtol=1e-15)
    rest = wr.equilibrium(system)
    print(name, f"sag {1e3 * sag:.4f} mm, {rest.mounts['s1'].force[2]:.1f} N on the stop")
    assert rest.mounts["m1"].deflection[2] == pytest.approx(-sag, rel=1e-9)
    assert sag > GAP
    # After long vibration both hysteretic forces are gone, and small cycles have the slopes of what is left.
    relaxed = wr.equilibrium(system, history="relaxed")
    low = brentq(lambda x: ROPE["k"] * x + stop.pressed(x - GAP) - MASS * gravity, 0.0, 0.1, xtol=1e-15)
    assert relaxed.mounts["m1"].deflection[2] == pytest.approx(-low, rel=1e-9)
    step = 1e-6
    slope = (stop.pressed(low - GAP + step) - stop.pressed(low - GAP - step)) / (2.0 * step)
    found = wr.modes(system, history="relaxed").frequencies
    # A pressed stop with loss is stiffer in small cycles: its state turns within `reversal`, the rope's in z_max / alpha.
    turning = stop.pressed(low - GAP) * stop.loss / (stop.reversal or 1.0)
    expected = np.sqrt((ROPE["k"] + ROPE["alpha"] + slope + turning) / MASS) / (2.0 * np.pi)
    assert found[-1] == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow  # shooting at 1e-4 beside corners: 15 s each
@pytest.mark.parametrize("name", ["round", "lossy", "hardening"])
def test_vibration_against_stops_is_the_same_by_harmonic_balance_and_by_shooting(name):
    law = wr.Parallel(laws=[wr.BoucWen(**ROPE), wr.Stop(gap_below=0.01, gap_above=0.01, **STOPS[name])])
    asked = {"frequency": 8.0, "acceleration": 15.0}
    balanced = wr.harmonic_balance(law, mass=MASS, harmonics=63, **asked)
    shot = wr.periodic_orbit(sdof(law, mass=MASS), direction="z", accuracy=1e-4, **asked)
    peak = shot.response.peaks.mounts["m1"]
    one, other = balanced.largest_deflection, peak.deflection.maximum[2]
    print(name, f"amplitude {1e3 * one:.4f} mm, {1e3 * other:.4f} mm by shooting, residual {shot.residual:.1e}")
    assert one > 0.0105  # the stops are struck
    # Harmonics beyond the 63rd of a force with corners, and order 2 of the steps.
    assert one == pytest.approx(other, rel=1e-4)
