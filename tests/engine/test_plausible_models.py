"""What a model says that is perhaps not meant is said first, by every command; what was meant is left in peace."""

import json
import re
from dataclasses import replace

import pytest

import wirerope_mj as wr
from wirerope_mj.cli.app import main
from wirerope_mj.engine.statics import model_warnings
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import models_folder, shipped_models

GRAVITY = 'gravity="0 0 -9.80665"'
SPRING = wr.KelvinVoigt(k=5e4, c=200.0)
FEET = {f"m{number}": (x, y) for number, (x, y) in enumerate([(0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)], start=1)}


def stand(*, gravity=GRAVITY, joints="<freejoint/>", inertial="", isolator="rope"):
    """Return a block of 100 kg on four feet as MJCF."""
    sites = "".join(f'<site name="{{0}}{name}" pos="{x} {y} 0"/>' for name, (x, y) in FEET.items())
    inertial = inertial or '<inertial mass="100" pos="0 0 0.2" diaginertia="5 5 5"/>'
    mounts = "".join(
        f'<tuple name="mount/{name}"><element objtype="site" objname="p{name}"/><element objtype="site" objname="d{name}"/>'
        f'<element objtype="text" objname="isolator/{isolator}"/></tuple>'
        for name in FEET
    )
    slides = "".join(f'<joint name="deck_{axis}" type="slide" axis="{unit}"/>' for axis, unit in
                     (("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1")))  # fmt: skip
    return (
        f'<mujoco><option {gravity} integrator="RK4"/><worldbody><body name="deck" gravcomp="1">{slides}'
        f'<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>{sites.format("d")}</body>'
        f'<body name="block">{joints}{inertial}{sites.format("p")}</body></worldbody>'
        f'<custom><text name="isolator/{isolator}" data="isolators/{isolator}.toml"/>{mounts}</custom></mujoco>'
    )


def said(*, laws=("roll", "shear", "axial"), free=(), **model):
    rope = wr.Isolator(name="rope", free=free, **dict.fromkeys(laws, SPRING))
    return model_warnings(wr.load_system(stand(**model), isolators={"rope": rope}))


@pytest.mark.quick
@pytest.mark.parametrize("name", [*shipped_models(), str(models_folder() / "templates" / "two_stage.xml")])
def test_models_of_the_house_are_left_in_peace(name):
    assert model_warnings(wr.load_system(name)) == ()


@pytest.mark.quick
def test_an_axis_without_a_law_is_said_where_the_payload_can_move_along_it():
    assert said() == ()
    (words,) = said(laws=("shear", "axial"))
    assert words.startswith(
        "mounts m1, m2, m3, m4 have no law in roll (isolator 'rope'): they do not resist motion in that axis"
    )
    assert words.endswith('Add the table [roll] to the isolator, or free = ["roll"] if that is meant.')
    assert len(said(laws=("axial",))) == 2
    slide = '<joint type="slide" axis="0 0 1"/>'
    assert said(laws=("axial",), joints=slide) == ()  # nothing moves along the others
    assert said(laws=("shear", "axial"), joints=f'{slide}<joint type="slide" axis="0 1 0"/>') == ()
    assert len(said(laws=("shear", "axial"), joints=f'{slide}<joint type="slide" axis="1 0 0"/>')) == 1
    assert said(laws=("axial",), free=("roll", "shear")) == ()  # the isolator says that it is meant


@pytest.mark.quick
def test_what_an_isolator_lets_go_is_an_axis_without_a_law(tmp_path):
    free = wr.Isolator(name="a", axial=SPRING, free=["roll"])
    free.save(tmp_path / "a.toml")
    assert wr.load_isolator(tmp_path / "a.toml") == free
    assert free.free == ("roll",)
    with pytest.raises(ValueError, match="`free` names axial, which has a law"):
        replace(free, free=("axial",))
    with pytest.raises(ModelError, match=r"`free` must be a list of one of 'roll', 'shear', 'axial', got \['x'\]"):
        wr.Isolator.from_dict(free.to_dict() | {"free": ["x"]})
    with pytest.raises(ModelError, match="`free` must be a list of one of 'roll', 'shear', 'axial', got 'roll'"):
        wr.Isolator.from_dict(free.to_dict() | {"free": "roll"})


@pytest.mark.quick
@pytest.mark.parametrize(
    ("gravity", "words"),
    [
        ("0 0 9.80665", "gravity points upwards"),
        ("0 0 0", "there is no gravity, so that nothing has weight"),
        ("0 0 -9806.65", "gravity is that of the earth in mm/s^2"),
        ("0 0 -1", "gravity is 0.102 times the earth's"),
    ],
)
def test_a_gravity_that_is_not_the_earths_is_said(gravity, words):
    (warning,) = said(gravity=f'gravity="{gravity}"')
    assert warning.startswith(f'<option gravity="{gravity}">: ')
    assert words in warning
    assert GRAVITY in warning  # the remedy


@pytest.mark.quick
def test_no_place_on_the_earth_is_said():
    for gravity in (9.7639, 9.8337):  # Huascaran, the Arctic Ocean
        assert said(gravity=f'gravity="0 0 -{gravity}"') == ()


@pytest.mark.quick
def test_a_mass_far_away_is_said_with_its_body():
    (far,) = said(inertial='<inertial mass="100" pos="0 0 -90" diaginertia="5 5 5"/>')
    assert "body 'block': its centre of mass at (0, 0, -90) m is 90 m from the nearest mount" in far
    (turning,) = said(inertial='<inertial mass="600" pos="0 0 0.2" diaginertia="5e8 5e8 5e8"/>')
    assert "body 'block': its moment of inertia of 5e+08 kg m^2 at 600 kg is a radius of gyration of 912.9 m" in turning
    mast = '<inertial mass="100" pos="0 0 3" diaginertia="300 300 5"/>'
    assert said(inertial=mast) == ()


@pytest.mark.quick
def test_a_mass_in_another_unit_is_said_with_what_its_mounts_are_rated_for():
    def of(mass, rated=400.0):
        laws = dict.fromkeys(("roll", "shear", "axial"), SPRING)
        rope = wr.Isolator(name="rope", **laws, limits=wr.Limits(static_load=rated))
        inertial = f'<inertial mass="{mass}" pos="0 0 0.2" diaginertia="{" ".join([str(0.05 * mass)] * 3)}"/>'
        return model_warnings(wr.load_system(stand(inertial=inertial), isolators={"rope": rope}))

    assert of(100.0) == of(4.0) == of(240.0) == of(0.1, rated=None) == ()  # 61 %, 2.5 % and 147 % of 1600 N
    (tonnes,) = of(0.1)
    assert tonnes == (
        "body 'block': the 0.1 kg on its mounts weigh 0.061 % of the 1600 N that these are rated for together: is its mass "
        "in t, or are the isolators others, or their ratings not in N?"
    )
    assert "is its mass in g, or" in of(100e3)[0]
    assert "is its mass in lb or N, or" in of(400.0)[0]
    assert "is its mass in N, or" in of(1.5e3)[0]
    assert "is its mass in kg, or are the isolators others" in of(3e3)[0]


@pytest.mark.quick
def test_what_stands_on_a_payload_loads_its_mounts_too():
    two = wr.load_system(str(models_folder() / "templates" / "two_stage.xml"))
    (raft,) = {mount.payload_body for mount in two.mounts.values()} & {mount.base_body for mount in two.mounts.values()}
    model = two.model.__copy__()
    model.body_subtreemass[model.body(raft).id] = 1e-3
    assert model_warnings(replace(two, model=model)) == ()  # the engine stands on it
    upper = next(mount.payload_body for mount in two.mounts.values() if mount.base_body == raft)
    model.body_subtreemass[model.body(upper).id] = 1e-3
    assert {words.split("'")[1] for words in model_warnings(replace(two, model=model))} == {raft, upper}


def written(folder, laws=("shear", "axial"), **model):
    (folder / "isolators").mkdir()
    wr.Isolator(name="rope", **dict.fromkeys(laws, SPRING)).save(folder / "isolators" / "rope.toml")
    (folder / "block.xml").write_text(stand(**model))
    return str(folder / "block.xml")


FIRST = "warning: mounts m1, m2, m3, m4 have no law in roll"


@pytest.mark.parametrize("command", [["statics"], ["modes", "--out", "modes"]], ids=lambda command: command[0])
def test_statics_and_modes_say_it_first(tmp_path, monkeypatch, capsys, command):
    monkeypatch.chdir(tmp_path)
    # A joint's spring holds the block where its mounts do not.
    joints = '<joint type="slide" axis="0 0 1"/><joint type="slide" axis="1 0 0" stiffness="1e4"/>'
    main([command[0], written(tmp_path, joints=joints), *command[1:]])
    assert capsys.readouterr().out.startswith(FIRST)


def test_a_run_says_it_on_the_screen_in_its_summary_and_first_in_its_report(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    joints = '<joint type="slide" axis="0 0 1"/><joint type="slide" axis="1 0 0" stiffness="1e4"/>'
    model = written(tmp_path, joints=joints)
    main(["shock", model, "--half-sine", "1 g 11 ms z", "--duration", "0.05", "--timestep", "5e-4", "--out", "run"])
    out = capsys.readouterr().out
    assert FIRST in out
    assert out.index(FIRST) < out.index("NOT JUDGED")
    (warning,) = json.loads((tmp_path / "run" / "summary.json").read_text())["model_warnings"]
    assert f"warning: {warning}"[: len(FIRST)] == FIRST
    page = re.sub(r"<[^>]+>", " ", (tmp_path / "run" / "report.html").read_text())
    assert page.index("have no law in roll") < page.index("The worst of every criterion")


def test_a_new_model_says_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    wr.Isolator(name="rope", shear=SPRING, axial=SPRING).save(tmp_path / "rope.toml")
    rows = "".join(f"{name},{1e3 * x},{1e3 * y},0,rope.toml\n" for name, (x, y) in FEET.items())
    (tmp_path / "mounts.csv").write_text(f"name,x [mm],y [mm],z [mm],isolator\n{rows}")
    (tmp_path / "masses.csv").write_text(
        "name,mass [kg],x [mm],y [mm],z [mm],size_x [mm],size_y [mm],size_z [mm]\nblock,100,0,0,200,500,500,300\n"
    )
    main(["new", "stand", "--mounts", "mounts.csv", "--masses", "masses.csv"])
    assert FIRST in capsys.readouterr().out
