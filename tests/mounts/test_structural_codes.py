"""Isolators as entries of structural codes: read back by the codes' own formats, their tables are the laws' static curves."""

import math

import numpy as np
import pytest
from commands import refused

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.mounts.isolator import AXES, Isolator, Limits, Rotation, Travel

pytestmark = pytest.mark.quick

NAME, AMPLITUDE = "enidine_wr12_400", 2e-3
PRINTED = 1e-9  # relative: tables print ten digits
LENGTH = {"N-m-kg": 1.0, "N-mm-t": 1e3}  # of the file, in one metre


def bulk(text):
    """Return the entries of bulk data in large or free fields: their names, and all fields behind, as texts."""
    entries = []
    for line in (line for line in text.splitlines() if not line.startswith("$")):
        if "," in line:
            name, *cells = line.split(",")
        else:
            name, cells = line[:8].strip(" *"), [line[start : start + 16].strip() for start in range(8, 72, 16)]
        if name:
            entries.append((name, []))
        entries[-1][1].extend(cells)
    return entries


def nastran(text):
    """Return tables by axis, and the constants of PBUSH by their flags."""
    entries = bulk(text)
    (properties,) = [cells for name, cells in entries if name == "PBUSH"]
    (tables,) = [cells for name, cells in entries if name == "PBUSHT"]
    assert tables[1] == "KN"
    by_number = {}
    for name, cells in entries:
        if name == "TABLED1":
            values = cells[8 : cells.index("ENDT")]
            by_number[cells[0]] = np.array(values, dtype=float).reshape(-1, 2)
    constants = {
        flag: [float(one) for one in properties[row + 1 : row + 7]]
        for row, flag in enumerate(properties)
        if flag in ("K", "GE", "B")
    }
    return {axis: by_number[number] for axis, number in zip(AXES, tables[2:5], strict=True) if number}, constants


def abaqus(text):
    lines, tables, constants = [line for line in text.splitlines() if not line.startswith("**")], {}, {}
    for row, line in enumerate(lines):
        if "COMPONENT=" not in line:
            continue
        below = lines[row + 1 :]
        data = below[: next((k for k, one in enumerate(below) if one.startswith("*")), len(below))]
        component = int(line.partition("COMPONENT=")[2])
        if "NONLINEAR" in line:
            tables[AXES[component - 1]] = np.array([one.split(",") for one in data], dtype=float)[:, ::-1]
        else:
            constants[line.split(",")[0], component] = float(data[0])
    return tables, constants


def ansys(text):
    """Return tables by axis and dampers: real constants by the type that they belong to."""
    types, reals = {}, {}
    for line in (line.partition("!")[0].strip() for line in text.splitlines()):
        command, *cells = line.split(",")
        if command == "ET":
            types[cells[0]] = cells[1]
        elif command == "R":
            number, *values = cells
            reals[number] = values
        elif command == "RMORE":
            reals[number] += cells
    tables = {
        AXES[int(n) - 1]: np.array(reals[n], dtype=float).reshape(-1, 2) for n, kind in types.items() if kind == "COMBIN39"
    }
    return tables, {AXES[int(n) - 4]: float(reals[n][1]) for n, kind in types.items() if kind == "COMBIN14" and int(n) < 7}


READERS = {"bdf": nastran, "inp": abaqus, "mac": ansys}


def exported(tmp_path, ending, *options, name=NAME):
    path = tmp_path / f"mount.{ending}"
    assert main(["isolators", "export", name, str(path), "--amplitude-mm", str(1e3 * AMPLITUDE), "--force", *options]) == 0
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("units", LENGTH)
@pytest.mark.parametrize("ending", READERS)
def test_the_static_curve_comes_back(tmp_path, ending, units):
    tables = READERS[ending](exported(tmp_path, ending, "--units", units))[0]
    isolator = wr.load_isolator(NAME)
    assert tables.keys() == {axis for axis, law in isolator.axes.items() if law is not None}
    for axis, table in tables.items():
        law, rated = isolator.axes[axis], isolator.limits.travel
        way, force = table[:, 0] / LENGTH[units], table[:, 1]
        assert np.all(np.diff(way) > 0.0)
        assert [0.0, 0.0] in table.tolist()
        assert -way[0] == pytest.approx(rated.compression if axis == "axial" else getattr(rated, axis), rel=PRINTED)
        largest = np.abs(force).max()
        for sign in (-1.0, 1.0):  # from rest to each side
            side = sign * way > 0.0
            points = np.concatenate([[0.0], sign * np.sort(sign * way[side])])
            there = law.trace(points).force[1:]
            assert np.abs(np.sort(there) - np.sort(force[side])).max() < 1e-6 * largest
            if ending != "mac":  # between them too, at deflections that are none of them
                path = np.linspace(0.0, points[-1], 7919)
                assert np.abs(law.trace(path).force - np.interp(path, way, force)).max() < 1e-6 * largest * (1.0 + 1e-3)


def test_an_ansys_table_has_no_more_points_than_a_combin39_and_says_what_it_misses(tmp_path, capsys):
    text = exported(tmp_path, "mac")
    tables, _ = ansys(text)
    said = " ".join(line.lstrip("! ") for line in text.splitlines() if line.startswith("!"))
    for axis, table in tables.items():
        assert len(table) == 20
        law = wr.load_isolator(NAME).axes[axis]
        misses = []
        for end in table[[0, -1], 0]:
            path = np.linspace(0.0, end, 5001)
            misses.append(np.abs(law.trace(path).force - np.interp(path, *table.T)).max())
        stated = float(said.partition(f"{axis}: secant")[2].partition("misses the curve by up to ")[2].split(" %")[0])
        # two digits are printed, and both look at the curve at thousands of deflections
        assert stated == pytest.approx(100.0 * max(misses) / np.abs(table[:, 1]).max(), rel=0.05)
    assert " ".join(capsys.readouterr().out.split()).count("misses the curve by up to") == len(tables)


@pytest.mark.parametrize("ending", READERS)
def test_the_loop_that_a_table_leaves_out_is_said(tmp_path, capsys, ending):
    text = exported(tmp_path, ending)
    said = " ".join(line.lstrip("!*$ ") for line in text.splitlines())
    printed = " ".join(capsys.readouterr().out.split())
    for axis, law in wr.load_isolator(NAME).axes.items():
        loop = wr.cyclic_test(law, AMPLITUDE)[0]
        sentence = f"{axis}: a loop of 2 mm dissipates {loop.dissipated_energy:.6g} J a cycle"
        assert sentence in said
        assert sentence in printed


@pytest.mark.parametrize("units", LENGTH)
@pytest.mark.parametrize("ending", ["inp", "mac"])
def test_a_file_without_stiffness_of_the_cycles_says_what_a_linear_analysis_needs(tmp_path, ending, units):
    text = exported(tmp_path, ending, "--units", units)
    said = " ".join(line.lstrip("!* ") for line in text.splitlines() if line[0] in "!*")
    tables, stiff, slopes = READERS[ending](text)[0], [], []
    for axis, law in wr.load_isolator(NAME).axes.items():
        loop, (origin,) = wr.cyclic_test(law, AMPLITUDE)[0], np.flatnonzero(tables[axis][:, 0] == 0.0)
        stiff.append(f"{axis} {loop.secant_stiffness / LENGTH[units]:.6g}")
        way, force = np.diff(tables[axis][origin - 1 : origin + 2], axis=0).T
        slopes.append((force / way).max() * LENGTH[units] / loop.secant_stiffness)
        if ending == "inp":  # thousands of points are as near as their first chord is short
            tangent = law.trace([0.0, 1e-9]).force[1] / 1e-9  # friction has not yielded
            assert slopes[-1] == pytest.approx(tangent / loop.secant_stiffness, rel=0.01)
    unit = {"N-m-kg": "N/m", "N-mm-t": "N/mm"}[units]
    assert f"needs this stiffness in place of the tables: {', '.join(stiff)} {unit}" in said
    stated = [float(said.partition("first loading, ")[2].split()[place]) for place in (0, 2)]
    assert stated == pytest.approx([min(slopes), max(slopes)], rel=5e-3)  # three digits are printed


def test_abaqus_goes_on_with_the_last_slope_and_keeps_the_points(tmp_path):
    """By default *CONNECTOR BEHAVIOR extrapolates at a constant force, and Abaqus/Explicit regularizes tables."""
    (line,) = [line for line in exported(tmp_path, "inp").splitlines() if line.startswith("*CONNECTOR BEHAVIOR")]
    assert line.split(", ")[1:] == ["NAME=MOUNT_LAW", "EXTRAPOLATION=LINEAR", "REGULARIZE=OFF"]


@pytest.mark.parametrize("ending", READERS)
def test_secants_stand_in_the_order_of_their_amplitudes(tmp_path, capsys, ending):
    text = exported(tmp_path, ending)
    said, softer = " ".join(line.lstrip("!*$ ") for line in text.splitlines()), []
    for axis, table in READERS[ending](text)[0].items():
        shorter = min(-table[0, 0], table[-1, 0])
        loops = wr.cyclic_test(wr.load_isolator(NAME).axes[axis], [0.1 * shorter, shorter])
        small, whole = (1e-3 * loop.secant_stiffness for loop in loops)
        assert f"{small:.4g} N/mm at a tenth of the table's range and {whole:.4g} N/mm at all of it" in said
        softer.append(whole < small)
    assert any(softer)
    assert " ".join(capsys.readouterr().out.split()).count("N/mm at all of it") == len(softer)


@pytest.mark.parametrize("units", LENGTH)
def test_stiffness_and_damping_are_those_of_the_loop(tmp_path, units):
    """K of the secant, loss factor W / (pi K A^2), damper W / (pi omega A^2)."""
    isolator, frequency, per_metre = wr.load_isolator(NAME), 8.0, 1.0 / LENGTH[units]
    loops = {axis: wr.cyclic_test(law, AMPLITUDE)[0] for axis, law in isolator.axes.items()}
    stiff = [loops[axis].secant_stiffness for axis in AXES]
    lost = [loops[axis].dissipated_energy / (math.pi * AMPLITUDE**2) for axis in AXES]
    options = ("--units", units, "--frequency", str(frequency))
    constants = nastran(exported(tmp_path, "bdf", *options))[1]
    assert constants["K"] == pytest.approx([*(per_metre * k for k in stiff), 0.0, 0.0, 0.0], rel=PRINTED)
    assert constants["GE"] == pytest.approx([*(w / k for w, k in zip(lost, stiff, strict=True)), 0.0, 0.0, 0.0], rel=PRINTED)
    dampers = [per_metre * w / (2.0 * math.pi * frequency) for w in lost]
    constants = nastran(exported(tmp_path, "bdf", "--damping", "viscous", *options))[1]
    assert constants["B"] == pytest.approx([*dampers, 0.0, 0.0, 0.0], rel=PRINTED)
    assert "GE" not in constants
    assert list(ansys(exported(tmp_path, "mac", *options))[1].values()) == pytest.approx(dampers, rel=PRINTED)
    constants = abaqus(exported(tmp_path, "inp", "--damping", "viscous", *options))[1]
    assert [constants["*CONNECTOR DAMPING", k] for k in (1, 2, 3)] == pytest.approx(dampers, rel=PRINTED)


def test_what_an_isolator_lacks_is_left_out_and_said(tmp_path):
    """Two axes, a rotational stiffness, a rate-dependent law whose static curve is its spring, and no rated load."""
    isolator = Isolator(
        name="two axes", axial=wr.KelvinVoigt(k=2e5, c=40.0), shear=wr.BoucWen(alpha=1e5, beta=50.0, gamma=0.0, n=1.0, k=2e4),
        rotation=Rotation(roll=10.0, shear=20.0, axial=30.0), limits=Limits(travel=Travel(compression=0.02)),
    )  # fmt: skip
    file = tmp_path / "two.toml"
    isolator.save(file)
    tables, constants = nastran(exported(tmp_path, "bdf", "--frequency", "10", name=str(file)))
    assert tables.keys() == {"shear", "axial"}
    assert tables["axial"][:, 1] == pytest.approx(2e5 * tables["axial"][:, 0], rel=PRINTED)
    assert constants["K"][3:] == [10.0, 20.0, 30.0]
    assert constants["K"][0] == 0.0
    # of a Kelvin-Voigt law the loss factor is omega c / k
    assert constants["GE"][2] == pytest.approx(2.0 * math.pi * 10.0 * 40.0 / 2e5, rel=1e-6)
    for ending in ("inp", "mac"):
        text = exported(tmp_path, ending, "--frequency", "10", name=str(file))
        assert "no law along roll" in text
        assert READERS[ending](text)[0].keys() == {"shear", "axial"}
    assert abaqus(exported(tmp_path, "inp", "--frequency", "10", name=str(file)))[1]["*CONNECTOR ELASTICITY", 6] == 30.0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["m.txt", "--amplitude-mm", "2"], ".bdf"), (["m.bdf", "--amplitude-mm", "0"], "--amplitude-mm"),
        (["m.bdf", "--amplitude-mm", "-2"], "--amplitude-mm"), (["m.bdf", "--amplitude-mm", "50"], "within the range"),
        (["m.bdf", "--amplitude-mm", "2", "--frequency", "0"], "--frequency"),
        (["m.mac", "--amplitude-mm", "2", "--damping", "structural"], "COMBIN14"), (["m.bdf"], "--amplitude-mm"),
    ],
)  # fmt: skip
def test_what_cannot_be_written_is_one_message(tmp_path, capsys, arguments, said):
    out, *rest = arguments
    assert said in refused(capsys, "isolators", "export", NAME, tmp_path / out, *rest)


def test_no_frequency_without_a_rated_load(tmp_path, capsys):
    file = tmp_path / "free.toml"
    Isolator(name="free", axial=wr.KelvinVoigt(k=2e5, c=40.0)).save(file)
    assert "`frequency` must be given" in refused(
        capsys, "isolators", "export", file, tmp_path / "m.bdf", "--amplitude-mm", "1"
    )
