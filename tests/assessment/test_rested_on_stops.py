"""Isolation that rests on its stops is short-circuited: said first in `new`, `statics`, `shock` and `cases`."""

import json
import math
import re

import pytest
from house import deck, mjcf

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import rested_verdicts
from wirerope_mj.cli import main
from wirerope_mj.content.study import study_content
from wirerope_mj.engine.statics import static_table
from wirerope_mj.studies.catalogue import try_parts
from wirerope_mj.studies.results.study_summary import summary_of

G, MASS, K, STOP = 9.80665, 20.0, 4e4, 1e6
SAG = MASS * G / K  # 4.9 mm
LAW = wr.KelvinVoigt(k=K, c=100.0)
GAP = 0.5 * SAG
# By hand: beyond the gap both springs carry, K x + STOP (x - GAP) = m g.
SHARE = STOP * ((MASS * G + STOP * GAP) / (K + STOP) - GAP) / (MASS * G)


def stand(stop="", plate="", inside=""):
    sites = {"b": 'pos="0 0 .2"'}
    body = (
        f'<body name="box" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".05" mass="{MASS}"/>'
        f'<site name="p" pos="0 0 -.1"/>{plate}</body>'
    )
    mounts = [("m1", "p", "b", "a"), *([("s1", "p", "b", "s")] if stop else [])]
    return mjcf(deck(sites, slides="z", inside=inside) + body, mounts, gravity=G)


def on_stop(gap):
    """Return the box with a stop of its own, in its mount, or as a contact, each closing over the same gap."""
    mount = wr.Isolator(name="a", axial=LAW, limits=wr.Limits(static_load=250.0))
    stop = wr.Stop(gap_below=gap, k=STOP)
    touch = 'contype="1" conaffinity="1" condim="1" solref="-5e4 -100" solimp="0.5 0.5"'
    contact = {
        "plate": f'<geom name="foot" type="sphere" size=".02" pos=".2 0 {gap - 0.08!r}" mass="0" {touch}/>',
        "inside": f'<geom name="pad" type="box" size=".05 .05 .01" pos=".2 0 .19" mass="1" {touch}/>',
    }
    return {
        "own": wr.load_system(stand(stop="s1"), isolators={"a": mount, "s": wr.Isolator(name="s", axial=stop)}),
        "in the mount": wr.load_system(
            stand(), isolators={"a": wr.Isolator(name="a", axial=wr.Parallel(laws=(LAW, stop)), limits=mount.limits)}
        ),
        "contact": wr.load_system(stand(**contact), isolators={"a": mount}),
    }  # fmt: skip


@pytest.mark.parametrize("kind", ["own", "in the mount", "contact"])
def test_stops_that_carry_weight_at_rest_are_an_exceeded_check(kind):
    rows = rested_verdicts(static_table(on_stop(GAP)[kind]))
    assert {row.criterion.sense for row in rows} == {"virgin", "relaxed"}
    for row in rows:
        assert row.verdict == "exceeded"
        assert (row.utilisation, row.margin) == (None, None)  # its limit is only from when on stops carry anything
        if kind != "contact":
            assert row.value == pytest.approx(SHARE, rel=1e-6)  # of the search's own tolerance, on a stiff stop
        assert f"carries {100 * row.value:.2g} % of the weight" in row.note
    assert rested_verdicts(static_table(on_stop(1.5 * SAG)[kind])) == ()


def test_only_what_a_stop_carries_along_gravity_counts_as_weight():
    """A stop inclined by 45 degrees, alone and inside a mount: of its force 1/sqrt(2) is along gravity."""
    stop = wr.Stop(gap_below=GAP / math.sqrt(2.0), k=STOP)
    text = stand(stop="s1").replace(
        '<site name="b" pos="0 0 .2"/>', '<site name="b" pos="0 0 .2"/><site name="t" pos="0 0 .2" euler="0 45 0"/>'
    )
    text = re.sub(r'objname="b"(?=/>\s*<element objtype="text" objname="isolator/s")', 'objname="t"', text)
    mount = wr.Isolator(name="a", axial=LAW)
    # K x + STOP (x - GAP) / 2 = m g
    share = 0.5 * STOP * ((MASS * G + 0.5 * STOP * GAP) / (K + 0.5 * STOP) - GAP) / (MASS * G)
    for law in (stop, wr.Parallel(laws=(stop, wr.KelvinVoigt(k=1e-6, c=0.0)))):
        rows = rested_verdicts(
            static_table(wr.load_system(text, isolators={"a": mount, "s": wr.Isolator(name="s", axial=law)}))
        )
        assert [row.value for row in rows] == pytest.approx([share, share], rel=1e-6)


@pytest.fixture(scope="module")
def short_circuited(tmp_path_factory):
    """Write tables of a machine on four mounts whose stops close after long vibration, and the model that `new` makes."""
    folder = tmp_path_factory.mktemp("tables")
    corners = [(x, y) for x in (-250, 250) for y in (-150, 150)]
    rows = [f"m{n},{x},{y},0,WR16-400" for n, (x, y) in enumerate(corners, 1)]
    (folder / "mounts.csv").write_text("\n".join(["name,x [mm],y [mm],z [mm],isolator", *rows]))
    (folder / "masses.csv").write_text(
        "name,mass [kg],x [mm],y [mm],z [mm],size_x [mm],size_y [mm],size_z [mm]\nbox,800,0,0,500,800,600,900\n"
    )
    rows = [f"s{n},{0.8 * x},{0.8 * y},0,4,5" for n, (x, y) in enumerate(corners, 1)]
    (folder / "stops.csv").write_text("\n".join(["name,x [mm],y [mm],z [mm],gap [mm],stiffness [MN/m]", *rows]))
    return folder


@pytest.mark.slow
def test_it_is_said_first_by_every_command(short_circuited, capsys, monkeypatch):
    monkeypatch.chdir(short_circuited)
    said = "isolation is short-circuited at rest, after long vibration: s1, s2, s3, s4 carry 3"
    assert main(["new", "rack", "--tables", "."]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert next(number for number, line in enumerate(lines) if said in line.lower()) < 3
    assert main(["statics", "rack/rack.xml"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert said in next(line for line in lines[1:] if line.strip()).lower()
    shock = ["shock", "rack/rack.xml", "--half-sine", "5 g 11 ms z", "--duration", "0.2"]
    assert main([*shock, "--out", "run", "--initial", "relaxed"]) in (0, 1)
    out = capsys.readouterr().out
    assert f"FAIL: {said}" in out
    assert not re.search(r"\d{4} %", out)  # of a limit of 1 % of the weight
    headline = json.loads((short_circuited / "run" / "summary.json").read_text())["headline"]
    assert said in json.dumps(headline)
    (short_circuited / "job.toml").write_text(
        'question = "Does it hold?"\nmodel = "rack/rack.xml"\n[[case]]\nname = "up"\nhalf-sine = "3 g 11 ms z"\n'
    )
    assert main(["cases", "job.toml", "--out", "cases"]) in (0, 1)
    assert f"FAIL: {said}" in capsys.readouterr().out


def test_a_study_says_it_before_that_its_limits_are_kept(tmp_path):
    system, pulse = on_stop(GAP)["own"], wr.HalfSine(peak=0.1 * G, duration=0.011, direction="z")
    isolators = {name: system.isolators[name] for name in ("a", "s")}
    vary = {"motion/level": wr.Uniform(0.5, 1.0)}
    study = wr.Study(model=system.mjcf, isolators=isolators, motion=pulse, vary=vary, variants=2, duration=0.05)
    verdict = study_content(summary_of(study.run(tmp_path / "study", workers=1))).verdict
    assert verdict.tone == "exceeded"
    assert verdict.text.startswith("Isolation is short-circuited at rest, ")


def test_a_part_that_leaves_the_weight_on_stops_keeps_no_limits():
    system, pulse = on_stop(GAP)["own"], wr.HalfSine(peak=0.1 * G, duration=0.011, direction="z")
    laws = {"soft": LAW, "stiff": wr.KelvinVoigt(k=4 * K, c=100.0)}
    parts = {name: wr.Isolator(name=name, roll=law, shear=law, axial=law) for name, law in laws.items()}
    soft, stiff = sorted(try_parts(system, parts, {"up": pulse}), key=lambda part: part.name)
    assert soft.reason.startswith("isolation is short-circuited at rest, ")
    assert stiff.reason == ""


def test_what_stands_on_its_mounts_alone_has_no_such_check():
    for name in ("shock_table", "cabinet", "floating_floor"):
        assert rested_verdicts(static_table(wr.load_system(name))) == ()
