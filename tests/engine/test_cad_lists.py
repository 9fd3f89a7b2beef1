"""Masses from lists that CAD programs export, and from robots' descriptions (URDF)."""

import warnings

import numpy as np
import pytest
from commands import refused
from scipy.spatial.transform import Rotation

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.from_tables.cad_list import columns_of_masses
from wirerope_mj.engine.from_tables.read import read_masses
from wirerope_mj.engine.from_tables.sheet import BESIDE
from wirerope_mj.foundation.errors import RecordError, RecordWarning

pytestmark = pytest.mark.quick

TENSOR = np.array([[6e-3, -2e-4, 0.0], [-2e-4, 5e-3, 1e-4], [0.0, 1e-4, 4e-3]])  # elements: ixy = -sum x y dm
# The same part as three programs list it: SolidWorks' L are +sum x y dm, and its I stand at the origin.
LISTS = {
    "solidworks": (
        "Part Name,Material,Quantity,Mass (grams),Center of Mass X (mm),Center of Mass Y (mm),Center of Mass Z (mm),"
        "Lxx (g*mm^2),Lyy (g*mm^2),Lzz (g*mm^2),Lxy (g*mm^2),Lxz (g*mm^2),Lyz (g*mm^2),Ixx (g*mm^2)\n"
        "Housing,6061,1,1800,0,2,55,6e6,5e6,4e6,2e5,0,-1e5,9e9\n"
    ),
    "onshape": (
        "Item;Part number;Mass [kg];Center of mass X [mm];Center of mass Y [mm];Center of mass Z [mm];Inertia xx [kg mm^2];"
        "Inertia yy [kg mm^2];Inertia zz [kg mm^2];Inertia xy [kg mm^2];Inertia xz [kg mm^2];Inertia yz [kg mm^2]\n"
        "Housing;P-17;1,8;0,0;2,0;55,0;6000,0;5000,0;4000,0;-200,0;0,0;100,0\n"
    ),
    "own": (
        "name, mass [kg], x [mm], y [mm], z [mm], ixx [kg m^2], iyy [kg m^2], izz [kg m^2], ixy [kg m^2], ixz [kg m^2], "
        "iyz [kg m^2]\nHousing, 1.8, 0, 2, 55, 6e-3, 5e-3, 4e-3, -2e-4, 0, 1e-4\n"
    ),
}  # fmt: skip
LISTS["unknown"] = (
    "Part Name,Mass (grams),Center of Mass X (mm),Center of Mass Y (mm),Center of Mass Z (mm),Ixx (grams * mm^2),"
    "Iyy (grams * mm^2),Izz (grams * mm^2),Ixy (grams * mm^2),Ixz (grams * mm^2),Iyz (grams * mm^2)\n"
    "Housing,1800,0,2,55,6e6,5e6,4e6,-2e5,0,1e5\n"
)
SAID = {
    "solidworks": "as SolidWorks prints L",
    "onshape": "elements of the tensor, -sum x y dm",
    "own": None,
    "unknown": "elements of the tensor, -sum x y dm",
}


def written(folder, text, name="masses.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("program", LISTS)
def test_a_list_is_read_and_says_which_sign_of_products_is_taken(tmp_path, program):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        (mass,) = read_masses(written(tmp_path, LISTS[program]))
    assert mass.name == "Housing"
    assert mass.properties.mass == pytest.approx(1.8, rel=1e-12)
    assert mass.properties.centre == pytest.approx([0.0, 2e-3, 55e-3], rel=1e-12)
    assert mass.properties.inertia == pytest.approx(TENSOR, rel=1e-12)
    assert len(said) == (SAID[program] is not None)
    assert all(issubclass(one.category, RecordWarning) and SAID[program] in str(one.message) for one in said)
    # L are SolidWorks' about the centre of mass, and of a table the docs say it
    assert any("about each part's own centre of mass" in str(one.message) for one in said) == (
        program in ("onshape", "unknown")
    )


def test_the_option_for_products_does_not_say_about_which_point_moments_called_i_are(tmp_path):
    with pytest.warns(RecordWarning, match=r'moments of inertia are, "Ixx"; .* own centre of mass') as said:
        read_masses(written(tmp_path, LISTS["unknown"]), products="tensor")
    assert len(said) == 1
    assert "sign" not in str(said[0].message)


@pytest.mark.parametrize("program", sorted(LISTS.keys() - {"unknown"}))
def test_the_option_says_the_sign_without_a_word(tmp_path, program):
    path = written(tmp_path, LISTS[program])
    for products, sign in (("tensor", 1.0), ("positive", -1.0)):
        (mass,) = read_masses(path, products=products)
        listed = 2e-4 if program == "solidworks" else -2e-4
        assert mass.properties.inertia[0, 1] == pytest.approx(sign * listed, rel=1e-12)


def test_what_says_nothing_of_masses_is_left_out_and_part_numbers_name_parts_without_a_name():
    assert columns_of_masses(("Part Number", "Density", "MASS", "CoG x")) == ("name", BESIDE, "mass", "x")
    assert columns_of_masses(("Part Number", "Name")) == (BESIDE, "name")
    assert columns_of_masses(("Ixx", "Lxx")) == (BESIDE, "ixx")
    assert columns_of_masses(("frequency", "colour code")) == ("frequency", "colour code")  # which is then refused by name


def test_a_part_that_is_there_twice_is_refused(tmp_path):
    text = LISTS["solidworks"].replace("6061,1,", "6061,2,")
    with pytest.raises(RecordError, match=r"line 2: .Housing. is there 2 times"):
        read_masses(written(tmp_path, text), products="positive")


LINKS = {
    "base": (4.0, (0.0, 0.0, 0.05), (0.0, 0.0, 0.5), (0.02, 0.03, 0.04, 0.002, 0.001, -0.003)),
    "arm": (2.0, (0.1, 0.0, 0.0), (0.3, 0.0, 0.0), (0.01, 0.02, 0.02, 0.0, 0.0, 0.001)),
}  # mass, origin, roll pitch yaw, ixx iyy izz ixy ixz iyz
JOINT = ((0.05, 0.0, 0.1), (0.0, 0.2, 0.4))
URDF = """<robot name="camera">{links}
<link name="tip"/>
<joint name="pan" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0.05 0 0.1" rpy="0 0.2 0.4"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="weld" type="fixed"><parent link="arm"/><child link="tip"/></joint>
</robot>"""


def link(name, mass, origin, rpy, inertia):
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    values = " ".join(f'{key}="{value}"' for key, value in zip(names, inertia, strict=True))
    place = f'<origin xyz="{" ".join(map(str, origin))}" rpy="{" ".join(map(str, rpy))}"/>'
    mesh = '<visual><geometry><mesh filename="package://nowhere/part.stl"/></geometry></visual>'
    return f'<link name="{name}"><inertial>{place}<mass value="{mass}"/><inertia {values}/></inertial>{mesh}</link>'


ROBOT = URDF.format(links="\n".join(link(name, *values) for name, values in LINKS.items()))


def test_the_links_of_a_robot_are_masses_in_the_root_links_frame(tmp_path):
    """Against SciPy's rotations: URDF turns by roll, pitch and yaw about fixed axes."""
    with pytest.warns(RecordWarning, match="its joints pan are held at 0"):
        masses = read_masses(written(tmp_path, ROBOT, "robot.urdf"))
    assert [mass.name for mass in masses] == ["base", "arm"]
    frames = {"base": (Rotation.identity(), np.zeros(3)), "arm": (Rotation.from_euler("xyz", JOINT[1]), np.array(JOINT[0]))}
    for mass in masses:
        weight, origin, rpy, (xx, yy, zz, xy, xz, yz) = LINKS[mass.name]
        turned, place = frames[mass.name]
        axes = (turned * Rotation.from_euler("xyz", rpy)).as_matrix()
        assert mass.properties.mass == weight
        assert mass.properties.centre == pytest.approx(place + turned.apply(origin), abs=1e-15)
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        assert mass.properties.inertia == pytest.approx(axes @ tensor @ axes.T, abs=1e-12)  # by way of principal axes


def test_a_model_stands_on_a_robots_masses(tmp_path, capsys):
    written(tmp_path, ROBOT, "masses.urdf")
    places = "".join(f"m{i}{j}, {200 * i}, {150 * j}, -60, WR2-800\n" for i in (-1, 1) for j in (-1, 1))
    written(tmp_path, f"name, x [mm], y [mm], z [mm], isolator\n{places}", "mounts.csv")
    assert main(["new", str(tmp_path / "robot"), "--tables", str(tmp_path)]) == 0
    assert "are held at 0" in capsys.readouterr().err
    system = wr.load_system(tmp_path / "robot" / "robot.xml")
    assert float(system.model.body("robot").mass[0]) == pytest.approx(6.0, rel=1e-12)
    assert (tmp_path / "robot" / "tables" / "masses.urdf").is_file()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "not valid XML"), ("<robot", "not valid XML"), ("<mujoco/>", "no <robot>"), ('<robot name="a"/>', "xacro"),
        ('<robot name="a"><link name="b"/></robot>', "0 kg"),
        (ROBOT.replace('mass value="4.0"', 'mass value="-4"'), "mass of link .base. must"),
        (ROBOT.replace('ixx="0.02"', 'ixx="5"'), "inertia"),
        (ROBOT.replace('child link="arm"', 'child link="absent"'), "joint"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_robot_is_one_message(tmp_path, text, said):
    with pytest.raises(RecordError, match=said) as error:
        read_masses(written(tmp_path, text, "robot.urdf"))
    assert "robot.urdf" in str(error.value)


def test_a_robot_has_no_other_sign_of_products(tmp_path, capsys):
    mounts = written(tmp_path, "name, x [mm], y [mm], z [mm], isolator\nm1, 0, 0, 0, enidine_wr16_400\n", "mounts.csv")
    robot = written(tmp_path, ROBOT, "r.urdf")
    message = refused(capsys, "new", tmp_path / "m", "--mounts", mounts, "--masses", robot, "--products", "positive")
    assert "leave --products positive out" in message
