"""Sag and load of every mount: closed forms, the weight that adds up, ratings, and equilibria that do not exist."""

import json

import numpy as np
import pytest
from house import deck, hysteresis, mjcf, rack_on_floor_text, sdof, sdof_text

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import starting_load_verdicts, static_load_verdicts
from wirerope_mj.cli.app import main
from wirerope_mj.content.blocks import Statement
from wirerope_mj.content.statics import statics_blocks
from wirerope_mj.engine.statics import static_table
from wirerope_mj.foundation.resources import models_folder

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
PLACES = {"p1": (0.5, 0.4), "p2": (0.5, -0.4), "p3": (-0.5, 0.4), "p4": (-0.5, -0.4)}


def offset_box(*, offset, mass=100.0, k=5e4):
    """Return a box on four equal springs whose centre of mass stands `offset` from their middle, in their plane."""
    sites = {f"b{name}": f'pos="{x} {y} 1"' for name, (x, y) in PLACES.items()}
    points = "".join(f'<site name="{name}" pos="{x} {y} 0"/>' for name, (x, y) in PLACES.items())
    where = f"{offset[0]} {offset[1]} 0"
    box = f'<body name="box" pos="0 0 1"><freejoint/><inertial pos="{where}" mass="{mass}" diaginertia="9 9 9"/>{points}</body>'
    text = mjcf(deck(sites) + box, [(f"m{n}", n, f"b{n}", "a") for n in PLACES], gravity=G)
    laws = dict.fromkeys(("roll", "shear", "axial"), wr.KelvinVoigt(k=k, c=0.0))
    rated = wr.Isolator(name="a", **laws, limits=wr.Limits(static_load=280.0))
    return wr.load_system(text, isolators={"a": rated})


def test_an_offset_centre_splits_the_weight_as_the_textbook_says():
    """N_i = W [1/n + ex xi / sum x^2 + ey yi / sum y^2], four mounts at +-0.5, +-0.4 m."""
    table = static_table(offset_box(offset=(0.06, -0.03)))
    for sag in (table.virgin, table.relaxed):
        for name, (x, y) in PLACES.items():
            expected = 0.25 + 0.06 * x / 1.0 - 0.03 * y / 0.64
            row = sag.mounts[f"m{name}"]
            # Tilts of a milliradian turn forces by its square.
            assert row.split == pytest.approx(expected, rel=1e-4)
            assert row.carries == pytest.approx(expected * 100.0 * G, rel=1e-4)
            assert row.deflection[2] == pytest.approx(-expected * 100.0 * G / 5e4, rel=1e-4)
            assert row.utilisation == pytest.approx(expected * 100.0 * G / 280.0, rel=1e-4)


def test_the_payload_tilts_towards_its_heavy_side():
    sag = static_table(offset_box(offset=(0.06, -0.03))).virgin
    payload = sag.payloads["box"]
    load = 100.0 * G
    assert payload.displacement[2] == pytest.approx(
        -load / 2e5 - 0.06 * payload.rotation[1] - 0.03 * payload.rotation[0], rel=1e-3
    )
    # Heavy to the front (x > 0): the front sinks, a positive turn about y; heavy to the right (y < 0): positive about x.
    assert payload.rotation[1] == pytest.approx(load * 0.06 / (5e4 * 1.0), rel=1e-3)
    assert payload.rotation[0] == pytest.approx(load * 0.03 / (5e4 * 0.64), rel=1e-3)
    np.testing.assert_allclose(payload.centre, [0.06, -0.03, 1.0])


@pytest.mark.parametrize("name", ["sdof_shaker", "shock_table", "cabinet"])
def test_loads_add_up_to_the_weight(name):
    table = static_table(wr.load_system(models_folder() / f"{name}.xml"))
    assert set(table.sags) == {"virgin", "relaxed"}
    assert not table.missing
    for sag in table.sags.values():
        assert sag.on_mounts == pytest.approx(sag.weight, rel=1e-9)
        assert sum(row.split for row in sag.mounts.values()) == pytest.approx(1.0, rel=1e-9)
        assert abs(sag.elsewhere) < 1e-8 * sag.weight


def test_a_payload_on_its_stops_leaves_the_rest_to_contacts():
    stop = '<geom name="s" type="sphere" size=".02" pos="0 0 -.1" mass="0"/>'
    pad = '<geom name="t" type="box" size=".1 .1 .01" pos="0 0 .165" mass="1"/>'  # its top lies 5 mm below the stop
    mass = (
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="30"/>'
        f'<site name="p" pos="0 0 -.1"/>{stop}</body>'
    )
    pair = '<contact><pair geom1="s" geom2="t" condim="1" solref="-20000 -35" solimp="0.001 0.001 0.001"/></contact>'
    text = mjcf(deck({"b": 'pos="0 0 .2"'}, slides="z", inside=pad) + mass, [("m1", "p", "b", "a")], gravity=G, other=pair)
    law = wr.KelvinVoigt(k=2e4, c=0.0)
    sag = static_table(wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=law)})).virgin
    assert sag.on_mounts == pytest.approx(2e4 * -sag.mounts["m1"].deflection[2], rel=1e-9)
    assert 1.0 < sag.on_mounts < 0.5 * sag.weight
    assert sag.on_contacts == pytest.approx(sag.weight - sag.on_mounts, rel=1e-6)


def test_springs_of_joints_are_what_carries_the_rest():
    mass = (
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1" stiffness="30000"/><geom size=".1" mass="30"/>'
        '<site name="p" pos="0 0 -.1"/></body>'
    )
    text = mjcf(deck({"b": 'pos="0 0 .2"'}, slides="z") + mass, [("m1", "p", "b", "a")], gravity=G)
    sag = static_table(wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=1e4, c=0.0))})).virgin
    assert sag.elsewhere == pytest.approx(0.75 * 30.0 * G, rel=1e-9)


def test_the_wr12_400_sags_at_its_rating_where_its_law_carries_it():
    """Rated load of 1068 N: relaxed where F2 F1 = -W; virgin on the loading path of its fit."""
    isolator = wr.load_isolator(models_folder() / "isolators" / "enidine_wr12_400.toml")
    law = isolator.axial
    text = sdof(law, mass=1068.0 / G, gravity=G)
    table = static_table(text)
    relaxed, virgin = (sag.mounts["m1"].deflection[2] for sag in (table.relaxed, table.virgin))
    spring = law.laws[0]  # both scales have one asymmetry, the first the spring
    elastic = spring.k1 * relaxed + spring.k3 * relaxed**3
    assert spring.b ** (spring.c * relaxed) * elastic == pytest.approx(-1068.0, rel=1e-9)
    path = law.trace(np.array([0.0, virgin]))
    assert path.force[-1] == pytest.approx(-1068.0, rel=1e-8)
    assert 1e3 * relaxed == pytest.approx(-10.37, abs=0.01)  # both of the catalogue's fit as it ships
    assert 1e3 * virgin == pytest.approx(-6.16, abs=0.01)


def frame_text():
    """Return 50 kg on a mount on a frame of 5 kg whose own spring is softer than the mount."""
    frame = (
        '<body name="frame" pos="0 0 .2"><joint type="slide" axis="0 0 1" stiffness="20000"/>'
        '<geom size=".05" mass="5"/><site name="b"/></body>'
    )
    mass = (
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="50"/>'
        '<site name="p" pos="0 0 -.1"/></body>'
    )
    return mjcf(deck({}, slides="z", inside=frame) + mass, [("m1", "p", "b", "a")], gravity=G)


def test_a_mount_on_a_soft_frame_lies_on_its_loading_path():
    """Trial positions of two bodies deflect the mount both ways, where its law has two slopes."""
    isolator = wr.load_isolator(models_folder() / "isolators" / "enidine_wr12_400.toml")
    sag = static_table(wr.load_system(frame_text(), isolators={"a": isolator})).virgin
    row = sag.mounts["m1"]
    assert row.force[2] == pytest.approx(-50.0 * G, rel=1e-9)
    assert isolator.axial.trace(np.array([0.0, row.deflection[2]])).force[-1] == pytest.approx(-50.0 * G, rel=1e-8)
    # The frame sinks by both weights over its spring; its joint is what carries the frame itself.
    assert sag.payloads["mass"].displacement[2] == pytest.approx(row.deflection[2] - 55.0 * G / 20000.0, rel=1e-9)
    assert sag.on_mounts == pytest.approx(sag.weight, rel=1e-9)


def test_shares_of_stacked_payloads_are_of_the_weight_of_all_and_a_statement_says_so():
    def stage(name, below, z, mass, site):
        return (
            f'<body name="{name}" pos="0 0 {z}"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="{mass}"/>'
            f'<site name="{below}" pos="0 0 -.1"/>{site}</body>'
        )

    upper = stage("rack", "pr", 0.5, 20, "")
    world = deck({"b": 'pos="0 0 .2"'}, slides="z") + stage("floor", "pf", 0.3, 50, '<site name="bf" pos="0 0 .1"/>')
    text = mjcf(world + upper, [("m1", "pf", "b", "a"), ("m2", "pr", "bf", "a")], gravity=G)
    text = text.replace("</custom>", '<tuple name="base"><element objtype="body" objname="deck"/></tuple></custom>')
    isolator = wr.Isolator(name="a", axial=wr.KelvinVoigt(k=2e4, c=0.0))
    table = static_table(wr.load_system(text, isolators={"a": isolator}))
    splits = {name: row.split for name, row in table.relaxed.mounts.items()}
    assert splits == pytest.approx({"m1": 1.0, "m2": 20.0 / 70.0}, rel=1e-9)
    assert table.relaxed.on_mounts == pytest.approx(70.0 * G, rel=1e-9)
    alone = static_table(offset_box(offset=(0.0, 0.0)))
    said = [[one.id for one in statics_blocks(of, ()) if isinstance(one, Statement)] for of in (table, alone)]
    assert ["stacked" in ids for ids in said] == [True, False]


def test_without_elastic_part_the_relaxed_column_says_why():
    system = sdof(wr.BoucWen(**hysteresis(alpha=1e5, z_max=100.0)), mass=3.5, gravity=G)
    table = static_table(system)
    assert table.relaxed is None
    assert table.virgin is not None
    assert "no elastic part" in table.missing["relaxed"]
    assert table.to_dict()["missing"] == table.missing


def test_what_cannot_be_carried_at_all_is_an_error():
    with pytest.raises(wr.ConvergenceError, match="carries at most"):
        static_table(sdof(wr.BoucWen(**hysteresis(alpha=1e5, z_max=20.0)), mass=3.5, gravity=G))


def test_verdicts_judge_what_is_rated():
    verdicts = static_load_verdicts(static_table(offset_box(offset=(0.06, -0.03))))
    assert len(verdicts) == 8
    by_name = {v.subject: v for v in verdicts if "virgin" in v.criterion}
    assert by_name["mp2"].verdict == "exceeded"  # 0.299 of 981 N over 280 N
    assert by_name["mp3"].verdict == "within"


def test_unrated_mounts_are_not_judged():
    verdicts = static_load_verdicts(static_table(sdof(wr.KelvinVoigt(k=1e4, c=0.0), gravity=G)))
    assert {v.verdict for v in verdicts} == {"not judged"}
    assert {v.note for v in verdicts} == {"no static load is rated"}


def test_mounts_that_hang_or_carry_across_are_judged_as_a_run_judges_them():
    """The stabilisers of the cabinet stand across the weight; the run's first sample is the virgin position."""
    system = wr.load_system(models_folder() / "cabinet.xml")
    table = static_table(system)
    found = {v.subject: v for v in static_load_verdicts(table) if "virgin" in v.criterion}
    motion = wr.HalfSine(peak=1.0, duration=0.01, direction="z", start=0.005)
    of_run = {v.subject: v for v in starting_load_verdicts(wr.simulate(system, motion, duration=0.01, timestep=1e-3))}
    assert {name: (v.verdict, v.note) for name, v in found.items()} == {name: (v.verdict, v.note) for name, v in of_run.items()}
    assert found["s1"].note.startswith("the load is across the axis")
    assert table.virgin.mounts["s1"].utilisation is None
    assert table.virgin.mounts["m01"].utilisation == found["m01"].utilisation > 0.3
    rated = wr.Isolator(name="a", axial=wr.KelvinVoigt(k=1e4, c=0.0), limits=wr.Limits(static_load=100.0))
    hung = static_table(wr.load_system(sdof_text(gravity=-G), isolators={"a": rated}))
    assert {v.note for v in static_load_verdicts(hung)} == {"the mount hangs, and the rating holds for compression"}
    assert hung.virgin.mounts["m1"].utilisation is None


def test_the_command_prints_both_histories_and_writes_plain_figures(capsys, tmp_path):
    path = tmp_path / "statics.json"
    assert main(["statics", "shock_table", "--json", str(path)]) == 0
    shown = capsys.readouterr().out
    words = " ".join(shown.split())
    assert "m1 virgin -1.985 0.000 -490.3 490.3 100.0 45.9 within m1 relaxed -4.695" in words
    assert "Stability: stable, large margin." in shown
    content = json.loads(path.read_text())
    assert content["virgin"]["mounts"]["m1"]["deflection_m"][2] == pytest.approx(-1.98511e-3, rel=1e-5)
    assert content["stability"]["virgin"]["gravity_factor"] is None
    assert content["verdicts"][0]["verdict"] == "within"


@pytest.mark.parametrize("mass", [10.0, 45.0, 60.0])
def test_the_command_judges_the_travel_at_rest_and_says_where_stability_is_extrapolated(capsys, tmp_path, mass):
    sag = 1e3 * mass * G / 1e4  # the spring's closed form [mm]
    rated = wr.Limits(static_load=100.0, travel=wr.Travel(compression=0.04))
    shape = wr.Geometry(height=0.07, bar=0.01)  # its bars meet at 50 mm
    laws = dict.fromkeys(("roll", "shear", "axial"), wr.KelvinVoigt(k=1e4, c=0.0))
    wr.Isolator(name="a", **laws, limits=rated, geometry=shape).save(tmp_path / "a.toml")
    (tmp_path / "rig.xml").write_text(sdof_text(mass=mass, gravity=G))
    assert main(["statics", str(tmp_path / "rig.xml"), "--json", str(tmp_path / "rig.json")]) == 0
    shown = capsys.readouterr().out
    answer = "exceeded in compression by m1" if sag > 40.0 else "within at every mount"
    assert f"Travel along single axes: {answer}; most used m1, {sag / 0.4:.0f} % in compression." in shown
    assert ("Pressed until the bars meet and beyond, which cannot be: m1. A stop is missing" in shown) is (sag > 50.0)
    assert ("Position of rest and stability are extrapolated" in shown) is (sag > 40.0)
    rows = json.loads((tmp_path / "rig.json").read_text())["verdicts"]
    (row,) = (one for one in rows if one["criterion"] == "travel in compression" and one["note"] == "at rest, virgin")
    assert row["value"] == pytest.approx(1e-3 * sag, rel=1e-6)


def test_the_command_says_what_there_is_no_equilibrium_for(capsys, tmp_path):
    wr.Isolator(name="a", axial=wr.BoucWen(**hysteresis(alpha=1e5, z_max=100.0))).save(tmp_path / "a.toml")
    (tmp_path / "rig.xml").write_text(sdof_text(gravity=G))
    assert main(["statics", str(tmp_path / "rig.xml")]) == 1
    shown = capsys.readouterr().out
    assert "Relaxed: there is no relaxed equilibrium: the axial law of mount 'm1' has no elastic part" in shown
    assert " relaxed " not in " ".join(shown[shown.index("Sag and load") :].split())


def test_the_command_shows_no_share_for_what_is_not_judged(capsys):
    assert main(["statics", "cabinet"]) == 0
    shown = capsys.readouterr().out
    row = next(line for line in shown.splitlines() if line.startswith("s1"))
    assert row.rstrip().endswith("-  not judged")
    assert "Not judged, because the load is across the axis, and the rating holds for compression: s1, s2, s3, s4." in shown


def test_a_place_that_cannot_be_written_is_said_before_anything_is_printed(capsys, tmp_path, monkeypatch):
    assert main(["statics", "cabinet", "--json", str(tmp_path / "new" / "statics.json")]) == 2
    captured = capsys.readouterr()
    assert "there is no folder" in captured.err
    assert not captured.out
    assert not (tmp_path / "new").exists()
    monkeypatch.setattr("os.access", lambda *_: False)
    assert main(["statics", "cabinet", "--json", str(tmp_path / "statics.json")]) == 2
    captured = capsys.readouterr()
    place = tmp_path / "statics.json"
    assert captured.err == f"wirerope: {place}: cannot write here (Permission denied). Choose another place.\n"
    assert not captured.out


def test_a_mount_between_two_payloads_carries_the_upper_one():
    law = wr.KelvinVoigt(k=2e4, c=0.0)
    isolators = {name: wr.Isolator(name=name, axial=law) for name in ("floor", "rack")}
    sag = static_table(wr.load_system(rack_on_floor_text(gravity=G), isolators=isolators)).virgin
    assert sag.mounts["m2"].carries == pytest.approx(3.0 * G, rel=1e-9)
    assert sag.mounts["m1"].carries == pytest.approx(11.0 * G, rel=1e-9)
    assert sag.on_mounts == pytest.approx(sag.weight, rel=1e-9)
    assert sag.payloads["rack"].displacement[2] == pytest.approx(-14.0 * G / 2e4, rel=1e-9)


def test_an_unknown_model_is_one_message(capsys):
    assert main(["statics", "no_such_model"]) == 2
    assert "ships with the package: cabinet" in capsys.readouterr().err
