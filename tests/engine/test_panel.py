"""A deck panel of one mode under a model: two masses in closed form, statics, the rigid limit, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from house import hysteresis, sdof, sdof_text
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from wirerope_mj.content.modes import modes_content
from wirerope_mj.dynamics.modes.rest import strain_energy
from wirerope_mj.engine.flexible import Panel, panel_of_phrase
from wirerope_mj.engine.simulation.engines import unsupported_system
from wirerope_mj.engine.system import load_on_deck, on_deck
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.views.terminal import show

pytestmark = pytest.mark.quick

M, K, C = 3.5, 8e3, 30.0  # a mass on a linear mount [kg, N/m, N s/m]
PANEL = Panel(frequency=10.0, mass=8.0, damping=0.04)
PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.02)


@pytest.fixture(scope="module")
def linear():
    return sdof(wr.KelvinVoigt(k=K, c=C), mass=M)


def matrices(panel=PANEL):
    """Return mass, damping and stiffness of panel and mass, (2, 2) each, displacements relative to the base."""
    on, coupling = np.diag([panel.mass, M]), np.array([[1.0, -1.0], [-1.0, 1.0]])
    own = np.diag([1.0, 0.0])
    return on, C * coupling + panel.damper * own, K * coupling + panel.stiffness * own


def test_two_masses_swing_at_the_frequencies_of_their_quadratic(linear):
    wp, we, ratio = 2 * math.pi * PANEL.frequency, math.sqrt(K / M), M / PANEL.mass
    middle = 0.5 * (wp**2 + (1 + ratio) * we**2)
    root = math.sqrt(middle**2 - (wp * we) ** 2)
    expected = np.sqrt([middle - root, middle + root]) / (2 * math.pi)
    # 1e-8: central differences of accelerations leave 1e-9 of the stiffness
    np.testing.assert_allclose(wr.modes(on_deck(linear, PANEL)).frequencies, expected, rtol=1e-8)


def test_a_pulse_moves_two_masses_as_the_equations_of_both_say(linear):
    on, damping, stiffness = matrices()

    def rate(time, y):
        x, v = y[:2], y[2:]
        return np.concatenate(
            [v, np.linalg.solve(on, -damping @ v - stiffness @ x) - PULSE.acceleration(np.array([time]))[0, 2]]
        )

    response = wr.simulate(on_deck(linear, PANEL), PULSE, duration=0.4, timestep=2e-5, initial="unloaded")
    y, expected = np.zeros(4), np.zeros(response.time.size)
    for start, stop in ((0.0, 0.02), (0.02, 0.031), (0.031, 0.4)):  # between the corners of the pulse
        part = solve_ivp(rate, (start, stop), y, method="DOP853", rtol=1e-12, atol=1e-14, dense_output=True)
        inside = (response.time >= start) & (response.time <= stop)
        expected[inside] = np.diff(part.sol(response.time[inside])[:2], axis=0)[0]
        y = part.y[:, -1]
    got = response.mounts["m1"].deflection[:, 2]
    # what RK4 leaves at this step is below 1e-9, what the dense output of the reference does 1e-8
    np.testing.assert_allclose(got, expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())


def test_kernel_and_mujoco_compute_the_same_on_a_panel():
    system = on_deck(sdof(wr.BoucWen(**hysteresis(alpha=2e4, z_max=40.0), k=4e3), gravity=9.80665), PANEL)
    assert unsupported_system(system) == ""
    how = {"duration": 0.3, "timestep": 1e-4}
    one, other = (wr.simulate(system, PULSE, engine=engine, **how) for engine in ("kernel", "mujoco"))
    for name in ("mass", "deck_panel"):
        expected = other.bodies[name].acceleration
        np.testing.assert_allclose(one.bodies[name].acceleration, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


def test_the_panel_carries_its_own_weight_as_drawn_and_sags_under_what_stands_on_it():
    system = on_deck(sdof(wr.KelvinVoigt(k=K, c=C), mass=M, gravity=9.80665), PANEL)
    state = wr.equilibrium(system)
    assert state.mounts["m1"].deflection[2] == pytest.approx(-M * 9.80665 / K, rel=1e-9)
    q = wr.simulate(system, wr.Sine(frequency=1.0, acceleration=1e-9, direction="z"), duration=0.01, timestep=1e-3)
    assert q.bodies["deck_panel"].position[0, 2] == pytest.approx(-M * 9.80665 / PANEL.stiffness, rel=1e-9)


def test_panel_and_mass_on_a_stiff_mount_swing_as_one_mass():
    # on a mount a thousand times stiffer both masses swing as one
    stiff = sdof(wr.KelvinVoigt(k=1e3 * K, c=0.0), mass=M)
    expected = PANEL.frequency * math.sqrt(PANEL.mass / (PANEL.mass + M))
    # the mount's own give adds ratio * (wp / we)^2 / 2, 1e-4 here
    assert wr.modes(on_deck(stiff, PANEL)).frequencies[0] == pytest.approx(expected, rel=1e-3)


def test_stiffer_decks_come_to_the_rigid_one(linear):
    how = {"duration": 0.3, "timestep": 2.5e-5, "initial": "unloaded"}
    rigid = wr.simulate(linear, PULSE, **how).peaks.bodies["mass"].acceleration.value
    off = []
    for frequency in (200.0, 400.0, 800.0):
        system = on_deck(linear, Panel(frequency=frequency, mass=8.0, damping=0.3))
        off.append(abs(wr.simulate(system, PULSE, **how).peaks.bodies["mass"].acceleration.value / rigid - 1.0))
    assert off[0] < 0.05
    assert off[1] < 0.6 * off[0]
    assert off[2] < 0.6 * off[1]


def test_the_deck_of_a_phrase_is_the_panel_that_it_says():
    assert panel_of_phrase("10 Hz 800 kg 4 %") == Panel(frequency=10.0, mass=800.0, damping=0.04)
    assert panel_of_phrase("0.8 t 10 Hz") == Panel(frequency=10.0, mass=800.0)
    assert panel_of_phrase("10 Hz 800 kg x").direction == "x"
    for panel in (PANEL, Panel(frequency=12.5, mass=800.0, direction="y")):
        assert panel_of_phrase(panel.description) == panel


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("10 Hz", "one mass"), ("800 kg", "one frequency"), ("10 Hz 12 Hz 800 kg", "one frequency"),
        ("10 Hz 800 kg 4 mm", "one frequency"), ("10 Hz 0 kg", "`mass` must be > 0"), ("10 Hz 800 kg 120 %", "ratio from 0"),
        ("10 Hz 800", "has no unit"), ("10 Hz 800 kg xz", "one direction"), ("", "one frequency"),
    ],
)  # fmt: skip
def test_a_deck_that_is_none_is_refused(text, message):
    with pytest.raises(ValueError, match=message) as error:
        panel_of_phrase(text)
    assert '"10 Hz 800 kg 4 %"' in str(error.value)


def test_a_deck_stands_on_a_driven_base_and_once(linear):
    fixed = sdof_text().replace('<joint name="deck_z" type="slide" axis="0 0 1"/>', "")
    isolators = {"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=K, c=C))}
    with pytest.raises(ModelError, match="has no slides"):
        load_on_deck(fixed, PANEL, isolators=isolators)
    with pytest.raises(ModelError, match="'deck_panel' already"):
        on_deck(on_deck(linear, PANEL), PANEL)


def test_a_variant_stays_one_on_its_deck(linear):
    heavier = wr.varied(linear, masses={"mass": 1.5})
    assert on_deck(heavier, PANEL).model.body("mass").mass[0] == pytest.approx(1.5 * M, rel=1e-12)


def test_a_scenario_on_a_deck_says_so_among_its_options():
    made = Scenario(question="?", model="cabinet", motion=PULSE, simulate={"duration": 0.1}).on_deck(PANEL)
    assert made.options["deck"] == "10 Hz 8 kg 4 %"
    system = wr.load_system(made.model, isolators=made.isolators)
    assert system.name == "cabinet"
    assert system.model.body("deck_panel").mass[0] == 8.0


def test_a_panel_tuned_to_another_frequency_is_the_panel_of_that_frequency():
    base = sdof(wr.BoucWen(**hysteresis(alpha=2e4, z_max=40.0), k=4e3), gravity=9.80665)
    other = Panel(frequency=18.0, mass=PANEL.mass, damping=PANEL.damping)
    tuned = wr.varied(on_deck(base, PANEL), tunings={"deck_panel": 1.8})
    how = {"duration": 0.2, "timestep": 1e-4}
    expected = wr.simulate(on_deck(base, other), PULSE, **how).peaks.bodies["mass"].acceleration.value
    assert wr.simulate(tuned, PULSE, **how).peaks.bodies["mass"].acceleration.value == pytest.approx(expected, rel=1e-12)
    with pytest.raises(ModelError, match="no joint 'mass_z' with a spring. Joints with one: \\['deck_panel'\\]"):
        wr.varied(tuned, tunings={"mass_z": 2.0})


def test_a_frequency_and_a_damping_ratio_hold_for_the_mass_of_the_variant(linear):
    heavy = replace(PANEL, frequency=1.8 * PANEL.frequency, mass=1.5 * PANEL.mass)
    changes = {"tunings": {"deck_panel": 1.8}, "masses": {"deck_panel": 1.5}}
    tuned, expected = wr.varied(on_deck(linear, PANEL), **changes), on_deck(linear, heavy)
    for name in ("jnt_stiffness", "dof_damping", "body_mass"):
        np.testing.assert_allclose(getattr(tuned.model, name), getattr(expected.model, name), rtol=1e-12)
    np.testing.assert_allclose(wr.modes(tuned).frequencies, wr.modes(expected).frequencies, rtol=1e-9)


@pytest.mark.slow
def test_a_study_varies_the_frequency_of_a_deck(tmp_path):
    made = Scenario(question="?", model="cabinet", motion=PULSE, simulate={"duration": 0.1}).on_deck(
        Panel(frequency=10.0, mass=1700.0)
    )
    study = wr.Study(
        model=made.model, isolators=made.isolators, motion=PULSE, duration=0.1, timestep=5e-5, sampling="grid",
        vary={"joint/deck_panel/frequency": wr.Choice([8.0, 25.0])}, name="deck",
    )  # fmt: skip
    rows = study.run(tmp_path / "study", workers=1).table.to_pylist()
    # Steps of 0.2 ms are near the stability of the mounts' finer scale: there a difference in the last digit grows to 2e-6.
    for row in rows:
        panel = Panel(frequency=row["joint/deck_panel/frequency"], mass=1700.0)
        alone = wr.simulate(on_deck(wr.load_system("cabinet"), panel), PULSE, duration=0.1, timestep=5e-5)
        assert row["acceleration/rack"] == pytest.approx(alone.peaks.bodies["rack"].acceleration.value, rel=1e-9)


def test_the_strain_energy_of_two_masses_is_shared_as_their_shapes_say(linear, capsys):
    system, (on, _, stiffness) = on_deck(linear, PANEL), matrices()
    shares = strain_energy(system, wr.modes(system))
    values, shapes = scipy.linalg.eigh(stiffness, on)
    deck = PANEL.stiffness * shapes[0] ** 2 / values
    np.testing.assert_allclose(shares, np.column_stack([1.0 - deck, deck, 0.0 * deck]), atol=1e-7)
    assert strain_energy(linear, wr.modes(linear)) is None
    show(modes_content(system, wr.modes(system)))
    assert "Where the strain energy sits" in capsys.readouterr().out


@pytest.mark.slow
def test_a_branch_is_followed_through_the_resonance_of_a_panel():
    """States of small scales settle within a step there: the variational equation once blew up, and points were leapt over."""
    system = load_on_deck("shock_table", panel_of_phrase("12 Hz 100 kg 4 %"))
    branch = wr.follow_branch(
        system, start=7.5, stop=8.3, acceleration=0.2 * wr.STANDARD_GRAVITY, direction="z", payload="block"
    )
    assert branch.gaps == ()
    assert branch.stable.all()
    around = np.array([7.7, 8.0, 8.2])
    stepped = wr.stepped_sine(
        system, frequencies=around, acceleration=0.2 * wr.STANDARD_GRAVITY, direction="z", payload="block"
    )
    # settled to 1e-4, and straight between points of the branch that are a percent apart
    assert np.interp(around, branch.frequency, branch.amplitude) == pytest.approx(stepped.amplitude, rel=2e-3)
