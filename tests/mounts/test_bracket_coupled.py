"""Brackets under axes that are coupled: against mounts followed by themselves, closed forms, both engines, statics, modes."""

import re
from dataclasses import replace

import numpy as np
import pytest
from house import deck, hysteresis, mjcf
from laws_for_tests import path_through
from table_study import PULSE, table_study

import wirerope_mj as wr
from wirerope_mj.dynamics.modes.mount import closed_cycle, plane_stiffness, plane_tangents
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import close, monodromy, shot
from wirerope_mj.dynamics.periodic.variational import variational_of
from wirerope_mj.engine.kernel.equations import equations
from wirerope_mj.engine.kernel.variants import Numbers
from wirerope_mj.engine.statics.find import equilibrium_solver
from wirerope_mj.engine.system.varied import Changes
from wirerope_mj.mounts import laws
from wirerope_mj.mounts.laws import OnBracket
from wirerope_mj.mounts.laws.plane_kernels import forces_at_states
from wirerope_mj.studies.measures import measures

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

G = wr.STANDARD_GRAVITY
ROPE = wr.load_isolator("enidine_wr12_400")
ALIKE = {axis: wr.BoucWen(**hysteresis(alpha=9e4, z_max=60.0), k=3e4) for axis in ("roll", "shear")}
BIAXIAL = wr.Isolator(name="biaxial", **ALIKE, axial=ROPE.axial, coupling="biaxial")
SOFT = {  # of the mounts' own stiffness, so that they take a good part of the deflection
    "both": (5e5, 8e5), "the first": (5e5, np.inf), "the other": (np.inf, 8e5),
}  # fmt: skip
PATH = 1e-3 * np.array([[0.0, 0.0], [4.0, -6.0], [-5.0, 3.0], [2.0, 8.0], [0.0, -9.0], [4.0, -6.0]])


def text_of(mass=60.0, tilt=35.0):
    """Return a model of a mass on one tilted mount, which slides along the world's axes."""
    turn, slides = f'euler="0 {tilt} 10"', "".join(f'<joint type="slide" axis="{a}"/>' for a in ("1 0 0", "0 1 0", "0 0 1"))
    own = f'<geom size=".1" mass="{mass}"/><site name="p" {turn}/>'
    world = deck({"b": turn}) + f'<body name="mass" pos="0 0 0">{slides}{own}</body>'
    return mjcf(world, [("m", "p", "b", "i")], gravity=G)


def mass_on(isolator, **given):
    return wr.load_system(text_of(**given), isolators={"i": isolator})


def on(isolator=ROPE, **bracket):
    return replace(isolator, bracket=wr.Bracket(**bracket))


@pytest.mark.quick
@pytest.mark.parametrize("law", [ROPE.coupled, BIAXIAL.coupled], ids=["loop", "biaxial"])
@pytest.mark.parametrize("stiffness", SOFT.values(), ids=SOFT)
def test_the_force_is_that_of_the_mount_at_its_own_share_of_the_deflection(law, stiffness):
    """Own deflections chosen, those of both follow; a straight line between their samples costs the square of its length."""
    errors = []
    for samples in (200, 800):
        own = np.stack([path_through(axis, per_segment=samples) for axis in PATH.T], axis=1)
        expected = law.trace(own)
        found = replace(law, brackets=stiffness).trace(own + expected.force / stiffness)
        stored = 0.5 * (expected.force**2 / stiffness).sum(axis=1)
        states = found.hysteretic_state, expected.hysteretic_state
        pairs = (found.force, expected.force), states, (found.work - stored, expected.work)
        errors.append([np.abs(one - other).max() / np.abs(other).max() for one, other in pairs])
    print(errors)
    assert (np.array(errors[1]) < np.array(errors[0]) / 5.0).all()
    assert max(errors[1]) < 3e-5


@pytest.mark.quick
@pytest.mark.parametrize("law", [ROPE.coupled, BIAXIAL.coupled], ids=["loop", "biaxial"])
def test_a_rigid_bracket_changes_nothing(law):
    rigid, stiff = law.trace(PATH), replace(law, brackets=(1e16, 1e16)).trace(PATH)
    np.testing.assert_allclose(stiff.force, rigid.force, rtol=0, atol=1e-8 * np.abs(rigid.force).max())  # as traces promise


def test_a_rigid_bracket_changes_no_run():
    pulse = wr.HalfSine(peak=8.0 * G, duration=0.011, direction=[0.6, 0.2, 0.8], start=0.01)
    rigid, stiff = (
        wr.simulate(mass_on(one), pulse, duration=0.1, timestep=1e-4, initial="unloaded").mounts["m"].force
        for one in (ROPE, on(axial=1e16, roll=1e16))
    )
    np.testing.assert_allclose(stiff, rigid, rtol=0, atol=1e-9 * np.abs(rigid).max())


@pytest.mark.quick
def test_linear_mounts_and_brackets_are_springs_in_series():
    springs = {"roll": (3e4, 5e4), "shear": (7e4, 2e5)}  # mount, bracket [N/m]
    own = {axis: wr.BoucWen(alpha=k, beta=1e-12, gamma=0.0, n=1.0, k=0.0) for axis, (k, _) in springs.items()}
    device = on(wr.Isolator(name="linear", **own, coupling="biaxial"), **{axis: k for axis, (_, k) in springs.items()})
    series = np.array([k * bracket / (k + bracket) for k, bracket in springs.values()])
    found = device.conditioned.coupled.trace(PATH)
    np.testing.assert_allclose(found.force, series * PATH, rtol=0, atol=1e-9 * np.abs(series * PATH).max())


@pytest.mark.quick
@pytest.mark.parametrize("name", ["enidine_wr12_400", "CB1400-10", "WR16-850"])
def test_own_deflections_are_found_or_there_is_none(name):
    """Any states, deflections and brackets: within the rating always; a loop pressed beyond it may buckle on a soft bracket."""
    device, rng = wr.load_isolator(name), np.random.default_rng(5)
    law, rated = device.coupled, device.limits.travel.compression
    n, bounds = len(law.scales), law.rate_parameters().reshape(-1, 6)[:, 2:4]
    for reach, softest in ((2.0, 2.0), (1.0, 5.5)):
        for _ in range(300):
            stiffness, angle = 10.0 ** rng.uniform(softest, 10.0, 2), rng.uniform(0.0, 2.0 * np.pi, n)
            x, z = (
                rng.uniform(-reach, reach, 2) * rated,
                np.stack([np.cos(angle), np.sin(angle)]) * rng.uniform(size=n) * bounds.T,
            )
            soft = replace(law, brackets=tuple(stiffness))
            own = soft.own_deflection(x, z.ravel())
            force = np.array(forces_at_states(soft.mount_parameters(), 0, n, *own.tolist(), z.ravel(), 0, n))
            assert np.isfinite(own).all() or reach > 1.0
            assert not np.abs(own + force / stiffness - x).max() > 1e-8 * np.abs(x).max()


@pytest.mark.parametrize(
    "device",
    [on(axial=8e5), on(axial=8e5, roll=5e5, shear=4e5), on(BIAXIAL, roll=4e5, axial=9e5)],
    ids=["axial", "all", "biaxial"],
)
def test_both_engines_agree_and_converge(device):
    system, found = mass_on(device), {}
    pulse = wr.HalfSine(peak=8.0 * G, duration=0.011, direction=[0.6, 0.2, 0.8], start=0.01)

    def force(step, engine):
        return wr.simulate(system, pulse, duration=0.1, timestep=step, engine=engine, sample_rate=1e3).mounts["m"].force

    for step in (1e-4, 5e-5, 2.5e-5, 6.25e-6):
        found[step] = force(step, "kernel")
    fine = found.pop(6.25e-6)
    size = float(np.abs(fine).max())
    np.testing.assert_allclose(force(1e-4, "mujoco"), found[1e-4], rtol=0, atol=1e-9 * size)
    errors = [np.abs(one - fine).max() / size for one in found.values()]
    print(errors)
    assert errors[-1] < 1e-5
    assert errors[0] > 6.0 * errors[-1]  # of first order it would be 5: a mount turns round inside a step, which is of second


@pytest.mark.quick
def test_a_mount_sags_by_its_bracket_under_a_weight():
    rigid, soft = (wr.equilibrium(mass_on(one, tilt=0.0)).mounts["m"] for one in (ROPE, on(axial=8e5, roll=5e5)))
    assert soft.force[2] == pytest.approx(-60.0 * G, rel=1e-7)
    assert soft.deflection[2] == pytest.approx(rigid.deflection[2] - 60.0 * G / 8e5, rel=1e-7)


@pytest.mark.parametrize("device", [on(axial=8e5, roll=5e5), on(BIAXIAL, roll=4e5)], ids=["loop", "biaxial"])
def test_rests_that_are_found_together_are_those_of_one_model(device):
    system = mass_on(device)
    numbers = Numbers(system, equations(system))
    every = np.array([numbers.of(Changes(masses={"mass": factor})) for factor in (1.0, 1.5)])
    rests = equilibrium_solver(system).solve(every, "virgin")
    assert rests.found.all()
    for row, mass in enumerate((60.0, 90.0)):
        own = wr.equilibrium(mass_on(device, mass=mass)).mounts["m"].deflection
        np.testing.assert_allclose(rests.mounts[row, 0, 0], own, rtol=0, atol=1e-6 * np.abs(own).max())


@pytest.mark.slow
@pytest.mark.parametrize("key", ["axial/stiffness", "shear/friction"])
def test_a_study_varies_what_stands_on_brackets_and_what_stands_beside_them(key, tmp_path):
    device, name = on(axial=8e5, roll=5e5), f"mount/m/{key}"
    study = table_study(model=text_of(), isolators={"i": device}, variants=3, vary={name: wr.Uniform(0.7, 1.3)})
    axis, factor = key.split("/")
    for row in study.run(tmp_path / "study", workers=1).table.to_pylist():
        law = getattr(device, axis)
        alone = mass_on(replace(device, **{axis: replace(law, **law.completed({factor: row[name]}))}))
        response = wr.simulate(alone, PULSE, duration=0.05, timestep=1e-3)
        found = measures(alone, response.peaks, response.initial_state)
        assert {one: row[one] for one in found} == pytest.approx(found, rel=1e-6, nan_ok=True)  # rests are found to 1e-8


@pytest.mark.quick
def test_modes_have_the_stiffness_of_mount_and_bracket():
    rigid, soft = (wr.modes(mass_on(one, tilt=0.0), history="relaxed") for one in (ROPE, on(axial=8e5)))
    own = 60.0 * (2.0 * np.pi * rigid.frequencies[-1]) ** 2
    series = own * 8e5 / (own + 8e5)
    assert soft.frequencies[-1] == pytest.approx(np.sqrt(series / 60.0) / (2.0 * np.pi), rel=1e-7)


def test_tangents_are_those_of_short_paths():
    law = replace(ROPE.coupled, brackets=(5e5, 8e5))
    end, step = np.array([5e-3, -4e-3]), 1e-8
    # the own path of the mount, and of every scale its own state there
    own = path_through([0.0, 1.0], per_segment=400)[:, None] * end
    own = own - law.trace(own).force / law.brackets
    states = np.stack([scale.trace(own).hysteretic_state[-1] for scale in law.scales], axis=1).ravel()
    np.testing.assert_allclose(law.own_deflection(end, states), own[-1], rtol=1e-5)
    turns = np.array([[1.0, 0.0], [0.0, -1.0]])  # both load on both scales
    for tangent, sign in zip(plane_tangents(law, end, states), (1.0, -1.0), strict=True):
        slopes = [
            np.diff(law.trace([[0.0, 0.0], end, end + sign * step * turn]).force[1:], axis=0)[0] / (sign * step)
            for turn in turns
        ]
        slope = np.linalg.solve(turns, np.array(slopes)).T
        np.testing.assert_allclose(tangent, 0.5 * (slope + slope.T), rtol=0, atol=1e-4 * np.abs(slope).max())


def test_large_cycles_are_those_of_the_series_but_for_their_higher_harmonics():
    rest, amplitude = np.array([0.0, -2e-3]), np.array([0.0, 3e-3])
    exact = closed_cycle(OnBracket(law=ROPE.axial, stiffness=8e5), rest[1], amplitude[1], frequency=1.0)
    found = plane_stiffness(replace(ROPE.coupled, brackets=(5e5, 8e5)), rest, amplitude)[1, 1]
    print(found / exact)
    assert found.real == pytest.approx(exact.real, rel=5e-3)
    assert found.imag == pytest.approx(exact.imag, rel=5e-2)
    stiff = plane_stiffness(replace(ROPE.coupled, brackets=(1e16, 1e16)), rest + 1e-3, amplitude + 2e-3)
    np.testing.assert_allclose(stiff, plane_stiffness(ROPE.coupled, rest + 1e-3, amplitude + 2e-3), rtol=1e-8, atol=1e-6)


@pytest.mark.slow
def test_the_variational_equation_knows_the_states_behind_brackets():
    search = OrbitSearch(mass_on(on(axial=8e5, roll=5e5)), direction="z", history="relaxed", accuracy=1.5625e-6)
    with search.flow.ready():
        drive = search.drive(9.0, 3.0)
        x = search.settled(search.coordinates.rest(), drive, 20)
        found = close(search.flow, shot(search.flow, x, drive), tolerance=1e-6, iterations=10)
        columns, quick = monodromy(search.flow, found), variational_of(search.flow).matrix(found)
    error = np.abs(columns - quick).max() / np.abs(columns).max()
    print("variational against columns", error)
    assert error < 3e-3  # as without brackets both miss where a reversal stands within a step


@pytest.mark.quick
def test_brackets_and_their_coupling_are_kept_in_a_file(tmp_path):
    on(axial=5e6).save(tmp_path / "a.toml")
    read = wr.load_isolator(tmp_path / "a.toml")
    assert read.bracket == wr.Bracket(axial=5e6)
    assert read.conditioned.coupled.brackets == (np.inf, 5e6)
    assert read.conditioned.scaled(2.0).coupled.brackets == (np.inf, 1e7)
    assert isinstance(read.conditioned.axial, OnBracket)
    assert isinstance(read.coupled, laws.LoopBoucWen)
    assert read.coupled.brackets is None


def test_a_run_in_which_a_mount_buckles_on_its_bracket_names_both():
    """The loops are pressed to 46 mm to 48 mm, rated 40 mm, on a bracket along roll of a thousandth of their stiffness."""
    system = mass_on(on(roll=1e2), mass=100.0, tilt=0.0)
    pulse = wr.HalfSine(peak=100.0 * G, duration=0.011, direction=[0.3, 0.0, 1.0], start=0.01)
    with pytest.raises(wr.SimulationError, match="buckled on its bracket: no timestep mends") as raised:
        wr.simulate(system, pulse, duration=0.05, timestep=1e-4)
    assert re.search(
        r"Mount 'm' stood at .* mm roll and -4[4-9].* mm axial, on a bracket of 0.0001 kN/mm roll\.", str(raised.value)
    )
    with pytest.raises(wr.SimulationError) as other:  # without end, too, but by another's fault
        wr.simulate(system, wr.HalfSine(peak=1e12, duration=0.011, direction="y"), duration=0.05, timestep=1e-4)
    assert "buckled" not in str(other.value)
