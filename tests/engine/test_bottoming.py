"""Mounts that go solid: the stops of new models against an own integration, their energy, and what is judged and said."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge, verdict_lines
from wirerope_mj.cli import main
from wirerope_mj.engine.system import load_system
from wirerope_mj.engine.system.varied import varied
from wirerope_mj.mounts.isolator import Geometry, Limits, Provenance, Travel, bottom_stop
from wirerope_mj.studies.catalogue import mount_shifts, replacements
from wirerope_mj.studies.vary.variants import Maker

G, MASS, K, C = wr.STANDARD_GRAVITY, 80.0, 2.0e4, 60.0
SOLID = 0.06 - 2.0 * 0.01
PULSE = wr.HalfSine(peak=250.0, duration=0.011, direction="z")


@pytest.fixture
def made(tmp_path, monkeypatch):
    """Return a function that makes a model of a block on four linear mounts, its centre of mass at their height."""
    monkeypatch.chdir(tmp_path)

    def model(*options, c=C):
        spring = wr.KelvinVoigt(k=K, c=c)
        size = Geometry(height=0.06, width=0.08, bar=0.01, rope=0.006)
        limits = Limits(travel=Travel(compression=0.035, shear=0.03, roll=0.03))
        wr.Isolator(name="linear", roll=spring, shear=spring, axial=spring, geometry=size, limits=limits).save("linear.toml")
        feet = [f"m{n}, {x}, {y}, 0, linear" for n, (x, y) in enumerate([(x, y) for x in (-200, 200) for y in (-200, 200)], 1)]
        (tmp_path / "mounts.csv").write_text("\n".join(["name, x [mm], y [mm], z [mm], isolator", *feet]), encoding="utf-8")
        header = "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]"
        (tmp_path / "masses.csv").write_text(f"{header}\nblock, {MASS}, 0, 0, 0, 500, 500, 300\n", encoding="utf-8")
        assert main(["new", "block", "--mounts", "mounts.csv", "--masses", "masses.csv", "--force", *options]) == 0
        return wr.load_system("block/block.xml")

    return model


def pushed(stop, deflection):
    """Return force [N] and energy [J] of a stop at a deflection, both sides, written down anew from its definition."""
    r, k = stop.rounding, stop.k
    depth = np.maximum(-deflection - stop.gap_below, deflection - stop.gap_above)
    t = np.clip(depth / r, 0.0, 1.0)
    counted = np.where(depth >= r, depth - 0.5 * r, r * (t**3 - 0.5 * t**4))
    # integral of r (t^3 - t^4 / 2) over the depth, then of depth - r / 2
    energy = np.where(depth >= r, 0.15 * r**2 + 0.5 * ((depth - 0.5 * r) ** 2 - (0.5 * r) ** 2), r**2 * (t**4 / 4 - t**5 / 10))
    return np.sign(deflection) * k * counted, k * energy


@pytest.mark.slow
@pytest.mark.quick
@pytest.mark.parametrize("engine", ["kernel", "mujoco"])
def test_a_mount_that_bottoms_follows_an_own_integration_to_a_millionth(made, engine):
    system = made()
    stop = system.mounts["bottom_m1"].isolator.axial
    assert stop.gap_below == pytest.approx(SOLID, abs=1e-9)
    response = wr.simulate(system, PULSE, duration=0.12, timestep=1e-5, engine=engine)

    def slope(time, y):
        base = 250.0 * np.sin(np.pi * time / 0.011) if time < 0.011 else 0.0
        return [y[1], -G - base - 4.0 / MASS * (K * y[0] + C * y[1] + pushed(stop, y[0])[0])]

    times, start, states = [0.0], [-MASS * G / (4.0 * K), 0.0], []
    for end in (0.011, 0.12):  # never across the end of the pulse
        part = solve_ivp(slope, (times[-1], end), start, method="DOP853", rtol=1e-12, atol=1e-14, max_step=2e-5)
        times, start = [*times, *part.t], part.y[:, -1]
        states.append(part)
    x, v = (np.concatenate([part.y[i] for part in states]) for i in (0, 1))
    force = pushed(stop, x)[0]
    mount, contact = response.peaks.mounts["m1"], response.peaks.contacts["bottom_m1"]
    assert x.min() < -SOLID - 1e-3  # it does bottom
    assert mount.deflection.minimum[2] == pytest.approx(x.min(), rel=1e-6)
    assert contact.force == pytest.approx(np.abs(force).max(), rel=1e-6)
    acceleration = -4.0 / MASS * (K * x + C * v + force) - G
    assert response.peaks.bodies["block"].acceleration.value == pytest.approx(np.abs(acceleration).max(), rel=1e-6)


@pytest.mark.quick
@pytest.mark.parametrize("engine", ["kernel", "mujoco"])
def test_energy_is_kept_while_a_mount_is_solid(made, engine):
    """Kinetic energy, height, springs and stops, in the frame of the base after the pulse: nothing dissipates here."""
    system = made(c=0.0)
    stop = system.mounts["bottom_m1"].isolator.axial
    response = wr.simulate(system, PULSE, duration=0.2, timestep=1e-5, sample_rate=2e4, engine=engine)
    x = response.mounts["m1"].deflection[:, 2]
    v = response.bodies["block"].velocity[:, 2] - response.base.velocity[:, 2]
    force, stored = pushed(stop, x)
    energy = 0.5 * MASS * v**2 + MASS * G * x + 4.0 * (0.5 * K * x**2 + stored)
    free = response.time > 0.011
    assert np.count_nonzero(force[free]) > 20
    # Runge-Kutta of order 4 with steps of 10 us, of which the contact takes a hundred
    np.testing.assert_allclose(energy[free], energy[free][0], rtol=1e-7)
    contact = response.peaks.contacts["bottom_m1"]
    assert contact.energy == pytest.approx(0.0, abs=1e-3 * stored.max())  # given back; its work is summed over the steps


@pytest.mark.quick
def test_bottoming_is_judged_and_said_and_left_out_on_request(made, capsys):
    system = made()
    said = " ".join(capsys.readouterr().out.split())
    assert "Isolator linear goes solid at 40 mm of compression (its height less two bars) and is a straight rope at" in said
    assert "stops bottom_m1, bottom_m2, bottom_m3, bottom_m4 act there" in said
    response = wr.simulate(system, PULSE, duration=1.0)
    rows = {row.subject: row for row in judge(response) if row.criterion == "bottoming"}
    assert {row.verdict for row in rows.values()} == {"exceeded"}
    assert rows["m1"].limit == system.mounts["bottom_m1"].isolator.axial.gap_below
    lines = " ".join(verdict_lines(response, judge(response)))
    assert "Bottomed, pressed until solid: m1, m2, m3, m4." in lines
    assert "A stop is missing" not in lines
    plain = made("--no-bottoming")
    assert list(plain.mounts) == ["m1", "m2", "m3", "m4"]
    through = wr.simulate(plain, PULSE, duration=1.0)
    assert through.peaks.mounts["m1"].deflection.minimum[2] < response.peaks.mounts["m1"].deflection.minimum[2]
    assert "A stop is missing in the model" in " ".join(verdict_lines(through, judge(through)))


@pytest.mark.quick
def test_a_part_goes_solid_where_bars_meet_or_its_vendor_says_and_else_nowhere():
    spring, travel = wr.KelvinVoigt(k=K, c=C), Limits(travel=Travel(compression=0.035))

    def device(**more):
        return wr.Isolator(name="a", axial=spring, limits=travel, **more)

    bars = bottom_stop(device(geometry=Geometry(height=0.06, width=0.08, bar=0.01, rope=0.006)))
    assert bars.axial.gap_below == pytest.approx(0.04, abs=1e-9)
    # A half circle of 25 mm between level segments of 12 mm: 24 + 25 pi mm of rope, straight between its ends 50 mm apart.
    assert bars.axial.gap_above == pytest.approx(0.024 + 0.025 * np.pi - 0.05, abs=1e-9)
    # fifty times the secant of a spring whose viscous part is nothing at rest
    assert bars.axial.k == pytest.approx(50.0 * K, rel=1e-3)
    vendor = bottom_stop(device(provenance=Provenance(kind="catalogue", source="a sheet")))
    assert (vendor.axial.gap_below, vendor.axial.gap_above) == (0.035, None)
    assert bottom_stop(device()) is None  # a rating of one's own says nothing of where it goes solid
    assert bottom_stop(wr.Isolator(name="a", axial=wr.Stop(gap_below=0.01, k=1e5))) is None


@pytest.mark.quick
def test_where_a_part_takes_its_place_a_mount_goes_solid_where_the_part_does(made):
    system, part = made(), wr.load_isolator("enidine_wr16_400")
    placed = replacements(system, part)
    assert placed["m1"] is part
    assert placed["bottom_m1"].axial == bottom_stop(part).axial
    unknown = replacements(system, wr.Isolator(name="a", axial=wr.KelvinVoigt(k=K, c=C)))
    assert unknown["bottom_m1"].axial.gap_below == 1.0
    shifts = mount_shifts(system, placed)  # the payload's bar stays, the foundation follows the height: 60 to 89 mm
    assert shifts["m1"] == shifts["bottom_m1"] == pytest.approx([0.0, 0.0, -0.0145], abs=1e-12)
    bottoms = {name: one for name, one in placed.items() if name.startswith("bottom_")}
    assert varied(system, isolators=bottoms, positions=shifts).bottoms == {f"m{n}": f"bottom_m{n}" for n in range(1, 5)}
    assert load_system("block/block.xml").mounts["bottom_m1"].isolator.axial.gap_below == pytest.approx(SOLID)


@pytest.mark.quick
def test_stops_where_mounts_go_solid_follow_what_varies(made):
    system = made()
    higher = replace(
        system.mounts["m1"].isolator, name="higher", geometry=Geometry(height=0.08, width=0.08, bar=0.01, rope=0.006)
    )
    higher.save("block/isolators/higher.toml")
    vary = {
        "mount/m1/position_shift/z": wr.Choice(0.002), "mount/m2/isolator": wr.Choice("isolators/higher.toml"),
        "mount/m3/fitted": wr.Choice(False),
    }  # fmt: skip
    study = wr.Study(model="block/block.xml", motion=PULSE, vary=vary, variants=1, sampling="random", duration=0.1)
    work = study.work
    variant = Maker(work.system, work.motions, work.columns).system(study.table().to_pylist()[0])
    moved = {name: variant.mounts[name].position - mount.position for name, mount in system.mounts.items()}
    for mount, shift in (("m1", 0.002), ("m2", -0.01), ("m4", 0.0)):  # half of what the part is higher, downwards
        assert moved[mount] == pytest.approx([0.0, 0.0, shift], abs=1e-12)
        assert moved[f"bottom_{mount}"] == pytest.approx(moved[mount], abs=1e-15)
    assert variant.mounts["bottom_m2"].isolator.axial.gap_below == pytest.approx(0.06)
    assert not variant.mounts["bottom_m3"].isolator.stops
