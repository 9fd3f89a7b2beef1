"""A bracket in series with a mount: against roots of the series itself, closed forms, both engines, and tables."""

import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from house import hysteresis, sdof_text
from laws_for_tests import example
from scipy.optimize import brentq
from table_study import PULSE, table_study

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.isolator import provenance_statement
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.laws import KelvinVoigt, OnBracket, Parallel, Zener, on_bracket
from wirerope_mj.mounts.vendor_parts import load_isolator
from wirerope_mj.studies.measures import measures
from wirerope_mj.studies.vary.quantity import acts

BRACKET = 3e5  # of the laws' own size, so that it takes a third of the deflection
PATH = [0.0, 0.01, -0.008, 0.006]
LAWS = {
    name: example(name)
    for name in ("bouc-wen", "ozdemir", "asymmetric-bouc-wen", "symmetric-bouc-wen", "tabulated", "vaiana-rosati")
} | {"parallel": Parallel(laws=(example("asymmetric-bouc-wen"), example("bouc-wen")))}


def in_series(law, stiffness, path):
    """Return the forces of a law and a spring in series, from the law's own deflections as roots one after another."""
    own, forces = [0.0], [0.0]
    for total in path[1:]:

        def gap(d, total=total):
            return d + law.trace([*own, d]).force[-1] / stiffness - total

        own.append(brentq(gap, -0.05, 0.05, xtol=1e-15, rtol=1e-15))
        forces.append(float(law.trace(own).force[-1]))
    return np.array(forces)


@pytest.mark.quick
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_force_is_that_of_law_and_spring_in_series(law):
    found, expected = OnBracket(law=law, stiffness=BRACKET).trace(PATH), in_series(law, BRACKET, PATH)
    # what traces without a closed form promise
    np.testing.assert_allclose(found.force, expected, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(OnBracket(law=law, stiffness=1e14).trace(PATH).force, law.trace(PATH).force, rtol=1e-8)


@pytest.mark.quick
@pytest.mark.parametrize("law", [KelvinVoigt(k=1e5, c=0.0), KelvinVoigt(k=1e5, c=300.0), Zener(k0=5e4, k1=5e4, c=800.0)])
@pytest.mark.parametrize("omega", [1.0, 60.0, 3000.0])
def test_a_linear_law_on_a_bracket_has_the_complex_stiffness_of_both_in_series(law, omega):
    def stiffness(one):
        if isinstance(one, KelvinVoigt):
            return one.k + 1j * omega * one.c
        return one.k0 + one.k1 * 1j * omega / (one.relaxation_rate + 1j * omega)

    own = stiffness(law)
    assert stiffness(on_bracket(law, BRACKET)) == pytest.approx(own * BRACKET / (own + BRACKET), rel=1e-12)


def one_mass(**parts):
    device = wr.Isolator(name="a", axial=wr.BoucWen(**hysteresis(alpha=2e4, z_max=40.0), k=4e3), **parts)
    return wr.load_system(sdof_text(mass=3.5, gravity=9.80665), isolators={"a": device})


def test_both_engines_agree_on_a_bracket_and_the_mass_swings_at_the_frequency_of_both():
    system = one_mass(bracket=wr.Bracket(axial=3e4))
    series = 24e3 * 3e4 / (24e3 + 3e4)
    # the tangent of a difference over a micrometre at rest, where the law's own force is nearly linear
    assert wr.modes(system).frequencies[0] == pytest.approx(np.sqrt(series / 3.5) / (2.0 * np.pi), rel=1e-5)
    pulse = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.02)
    kernel, mujoco = (
        wr.simulate(system, pulse, duration=0.2, timestep=1e-4, engine=engine).mounts["m1"].force
        for engine in ("kernel", "mujoco")
    )
    np.testing.assert_allclose(kernel, mujoco, atol=1e-9 * float(abs(mujoco).max()))
    rigid, stiff = (
        wr.simulate(one, pulse, duration=0.2, timestep=1e-4).mounts["m1"].force
        for one in (one_mass(), one_mass(bracket=wr.Bracket(axial=1e13)))
    )
    np.testing.assert_allclose(stiff, rigid, atol=1e-7 * float(abs(rigid).max()))  # the equilibria are found to 1e-8
    assert float(abs(mujoco - rigid).max()) > 0.05 * float(abs(rigid).max())


def test_tables_say_brackets_and_the_isolator_says_by_how_much_they_soften(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "masses.csv").write_text(
        "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]\nbox, 400, 0, 0, 500, 800, 600, 900\n"
    )
    header = "name, x [mm], y [mm], z [mm], isolator, bracket_shear [kN/mm]"
    rows = [f"m{i}, {x}, {y}, 0, enidine_wr16_400, {'5' if i < 2 else ''}" for i, (x, y) in enumerate(CORNERS)]
    (tmp_path / "mounts.csv").write_text("\n".join([header, *rows]) + "\n")
    assert main(["new", "box", "--mounts", "mounts.csv", "--masses", "masses.csv"]) == 0
    system = wr.load_system("box/box.xml")
    assert isinstance(system.mounts["m0"].isolator.shear, OnBracket)
    assert not isinstance(system.mounts["m2"].isolator.shear, OnBracket)
    file = tmp_path / "box" / "isolators" / "enidine_wr16_400_on_shear_5000.toml"
    assert tomllib.loads(file.read_text())["bracket"] == {"shear": 5e6}
    said = provenance_statement(load_isolator(file)).text
    own = load_isolator("enidine_wr16_400").shear.initial_stiffness
    assert f"Along shear on a bracket of 5 kN/mm, softer by {100.0 * own / (own + 5e6):.0f} % at small" in said


CORNERS = [(x, y) for x in (-300, 300) for y in (-200, 200)]


@pytest.mark.parametrize(
    ("axis", "stiffness", "said"),
    [
        ("axial", "-5", "`axial` must be"),
        ("shear", "0", "`shear` must be"),
        ("shear", "-5", "`shear` must be"),
    ],
)
def test_a_bracket_that_cannot_be_is_refused_with_file_row_and_column(axis, stiffness, said, tmp_path, capsys):
    (tmp_path / "masses.csv").write_text("name, mass [kg], x [mm], y [mm], z [mm]\nbox, 400, 0, 0, 500\n")
    (tmp_path / "mounts.csv").write_text(
        f"name, x [mm], y [mm], z [mm], isolator, bracket_{axis} [kN/mm]\nm0, 0, 0, 0, enidine_wr16_400, {stiffness}\n"
    )
    assert main(["new", str(tmp_path / "box"), "--mounts", str(tmp_path / "mounts.csv"), "--masses",
                 str(tmp_path / "masses.csv")]) == 2  # fmt: skip
    error = " ".join(capsys.readouterr().err.split())
    assert f'column "bracket_{axis}"' in error
    assert "mounts.csv, line 2" in error
    assert re.search(said, error)


def test_a_bracket_holds_no_law_whose_force_depends_on_the_rate_in_another_way():
    with pytest.raises(ValueError, match="not tinker-cutchins"):
        on_bracket(example("tinker-cutchins"), 1e6)
    with pytest.raises(ValueError, match="along which a has no law"):
        wr.Isolator(name="a", axial=example("bouc-wen"), bracket=wr.Bracket(roll=1e6))
    with pytest.raises((ValueError, ModelError), match="`bracket` must have a stiffness"):
        wr.Bracket()


def test_a_study_varies_what_stands_on_a_bracket_and_may_lose_it(tmp_path):
    device = wr.Isolator(name="a", axial=wr.BoucWen(**hysteresis(alpha=2e4, z_max=40.0), k=4e3), bracket=wr.Bracket(axial=3e4))
    given = {"model": sdof_text(), "isolators": {"a": device}, "variants": 4}
    study = table_study(**given, vary={"mount/m1/axial/alpha": wr.Uniform(0.5, 1.5, relative=True)})
    rows = study.run(tmp_path / "study", workers=1).table.to_pylist()
    alone = wr.load_system(
        sdof_text(),
        isolators={"a": replace(device, axial=replace(device.axial, alpha=2e4 * rows[2]["mount/m1/axial/alpha"]))},
    )
    response = wr.simulate(alone, PULSE, duration=0.05, timestep=1e-3)
    found = measures(alone, response.peaks, response.initial_state)
    assert {key: rows[2][key] for key in found} == pytest.approx(found, rel=0.0, abs=0.0, nan_ok=True)
    lost = table_study(**{**given, "variants": 1}, vary={"mount/m1/failed": wr.Choice(True)}).system(0)
    assert not acts(lost.mounts["m1"].isolator)


@pytest.mark.parametrize("axis", ["roll", "shear", "axial"])
def test_a_damper_on_a_bracket_shakes_in_both_engines_and_varies(axis):
    """It has a state that the law as written has not: whatever counts states counts those that act."""
    laws = {"axial": KelvinVoigt(k=2e4, c=40.0)} | {axis: KelvinVoigt(k=2e4, c=40.0)}
    device = wr.Isolator(name="a", bracket=wr.Bracket(**{axis: 1e5}), **laws)
    assert device.n_states == 1
    system = wr.load_system(sdof_text(), isolators={"a": device})
    pulse = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01)
    kernel, plain = (wr.simulate(system, pulse, duration=0.2, engine=engine) for engine in ("kernel", "mujoco"))
    peak = kernel.peaks.mounts["m1"].force.value
    assert plain.peaks.mounts["m1"].force.value == pytest.approx(peak, rel=1e-9)  # the same steps, but for rounding
    stiffer = replace(device, bracket=wr.Bracket(**{axis: 2e5}))
    varied = wr.varied(system, isolators={"m1": stiffer})
    expected = wr.simulate(wr.load_system(sdof_text(), isolators={"a": stiffer}), pulse, duration=0.2, timestep=1e-4)
    found = wr.simulate(varied, pulse, duration=0.2, timestep=1e-4)
    assert found.peaks.mounts["m1"].force.value == expected.peaks.mounts["m1"].force.value
