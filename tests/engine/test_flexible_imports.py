"""Parts from finite-element programs: one plate through OP4, OP2, universal, punch and f06 files, and what damaged ones say."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import pyuff
import pyyeti
import scipy.linalg
from fe_plate import plate, whole_plate
from nastran_files import op2_of_matrices, op2_of_modes, printed, punched
from pyyeti.nastran import bulk, op4

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.flexible import import_part
from wirerope_mj.engine.flexible.files import units_in
from wirerope_mj.foundation.errors import RecordError

A, B, H, NX, NY = 1.8, 1.5, 0.006, 6, 5
FEET = {"m1": (2, 1), "m2": (4, 1), "m3": (2, 4), "m4": (4, 4)}
COUNT, MM, TONNE, ZETA = 8, 1e3, 1e-3, 0.03  # modes; millimetres of a metre, tonnes of a kilogram
UNITS = units_in("mm,t,s")


def at(i, j):
    return np.array([A * (i / NX - 0.5), B * (j / NY - 0.5), 0.0])


@pytest.fixture(scope="module")
def truth():
    """Return the part of the plate's lowest modes on its clamped edge, in SI, straight from its matrices."""
    fe = plate(A, B, H, NX, NY, clamped=True)
    omega, shapes, gamma = fe.modes(COUNT)
    up = np.array([0.0, 0.0, 1.0])
    return wr.FlexiblePart(
        frequencies=omega / (2 * np.pi), damping=ZETA, participation=np.outer(gamma, up),
        points={name: at(*node) for name, node in FEET.items()},
        shapes={name: np.outer(shapes[fe.deflection[node]], up) for name, node in FEET.items()},
    )  # fmt: skip


def craig_bampton():
    """Return K and M in mm, t, s: a rigid edge and the feet with six coordinates each, then all fixed-interface modes."""
    mass, stiffness = whole_plate(A, B, H, NX, NY)
    nodes = [(i, j) for j in range(NY + 1) for i in range(NX + 1)]
    edge = [n for n, (i, j) in enumerate(nodes) if i in (0, NX) or j in (0, NY)]
    feet = [nodes.index(node) for node in FEET.values()]
    rest = [n for n in range(len(nodes)) if n not in (*edge, *feet)]
    boundary = np.zeros((3 * len(nodes), 30))  # w, dw/dx, dw/dy of every node by x, y, z, and turns of edge and feet
    for n in edge:
        x, y, _ = at(*nodes[n])
        boundary[3 * n : 3 * n + 3, 2:5] = [[1.0, y, -x], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    for number, n in enumerate(feet, 1):
        first = 6 * number
        boundary[3 * n : 3 * n + 3, first + 2 : first + 5] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    inner = [3 * n + c for n in rest for c in range(3)]
    own = np.ix_(inner, inner)
    boundary[inner] = -np.linalg.solve(stiffness[own], stiffness[inner] @ boundary)
    modes = np.zeros((3 * len(nodes), len(inner)))
    modes[inner] = scipy.linalg.eigh(stiffness[own], mass[own])[1]
    length = np.array([MM, MM, MM, 1.0, 1.0, 1.0] * 5)  # of a coordinate in the file's units
    basis = np.hstack([boundary / length, modes / (np.sqrt(TONNE) * MM)])
    return basis.T @ stiffness @ basis * TONNE * MM**2, basis.T @ mass @ basis * TONNE * MM**2


def with_files(folder, truth):
    """Write the plate in every format with the tables and the bulk text beside them, in mm, t, s."""
    folder.mkdir(exist_ok=True)
    matrices = dict(zip(("kaa", "maa"), craig_bampton(), strict=True))
    op4.write(str(folder / "cb.op4"), matrices)
    k, m = matrices.values()
    (folder / "cb.op2").write_bytes(op2_of_matrices(kxx=k, k4xx=0.02 * k, mxx=m, mug1=m[:7]))  # as of an external superelement
    rows = "".join(f"{name},{x * MM:.9g},{y * MM:.9g},{z * MM:.9g}," + "\n" for name, (x, y, z) in truth.points.items())
    (folder / "boundary.csv").write_text("point,x,y,z,held\nedge,0,0,0,yes\n" + rows)
    nodes = {name: 100 + n for n, name in enumerate(FEET)}
    rows = "".join(f"{name},{nodes[name]},{x * MM:.9g},{y * MM:.9g},{z * MM:.9g}\n" for name, (x, y, z) in truth.points.items())
    (folder / "points.csv").write_text("point,node,x,y,z\n" + rows)
    rows = "".join(
        f"{n},{f:.12g},{ZETA},0,0,{gamma * np.sqrt(TONNE):.12g}\n"
        for n, (f, gamma) in enumerate(zip(truth.frequencies, truth.participation[:, 2], strict=True), 1)
    )
    header = "mode,frequency_Hz,damping,participation_x,participation_y,participation_z\n"
    (folder / "modes.csv").write_text(header + rows)
    shapes = np.array([truth.shapes[name] for name in FEET]) / np.sqrt(TONNE)  # (n, m, 3)
    write_uff(folder / "plate.unv", nodes, truth, shapes)
    (folder / "plate.pch").write_text(punched(nodes, truth.frequencies, shapes))
    (folder / "plate.f06").write_text(printed(nodes, truth.frequencies, shapes))
    (folder / "plate.op2").write_bytes(op2_of_modes(nodes, truth.frequencies, shapes))
    numbers, places = [99, *nodes.values()], np.array([[0.0, 0.0, 0.0], *truth.points.values()]) * MM
    bulk.wtgrids(str(folder / "plate.bdf"), numbers, xyz=places)  # with one more grid point than the modes have
    return folder


def write_uff(path, nodes, truth, shapes, *, modal_mass=1.0, **changes):
    file, places = pyuff.UFF(str(path)), np.array(list(truth.points.values())) * MM
    numbers = list(nodes.values())
    file.write_sets(
        pyuff.prepare_2411(
            node_nums=numbers, def_cs=[1] * 4, disp_cs=[1] * 4, color=[1] * 4, x=places[:, 0], y=places[:, 1],
            z=places[:, 2],
        ), "overwrite",
    )  # fmt: skip
    for mode, frequency in enumerate(truth.frequencies):
        x, y, z = (np.sqrt(modal_mass) * shapes[:, mode]).T
        given = {
            "model_type": 1, "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "data_type": 2, "n_data_per_node": 3,
            "r1": x, "r2": y, "r3": z, "node_nums": numbers, "load_case": 1, "mode_n": mode + 1, "freq": frequency,
            "modal_m": modal_mass, "modal_damp_vis": ZETA, "modal_damp_his": 0.0,
        }  # fmt: skip
        file.write_sets(pyuff.prepare_55(**given | changes), "add")


@pytest.fixture(scope="module")
def folder(tmp_path_factory, truth):
    return with_files(tmp_path_factory.mktemp("plate"), truth)


def same(part, truth, digits):
    """Hold a part against another up to the signs of its modes, each against the largest of its kind."""
    signs = np.sign(np.sum(part.participation * truth.participation, axis=1))
    still = np.abs(truth.participation[:, 2]) < 1e-6
    shapes = np.array([part.shapes[name] for name in FEET])
    expected = np.array([truth.shapes[name] for name in FEET])
    signs[still] = np.sign(np.sum(shapes * expected, axis=(0, 2)))[still]
    np.testing.assert_allclose(part.frequencies, truth.frequencies, rtol=digits)
    np.testing.assert_allclose(part.damping, truth.damping, rtol=1e-12)
    np.testing.assert_allclose(shapes * signs[:, np.newaxis], expected, atol=digits * np.abs(expected).max())
    largest = np.abs(truth.participation).max()
    np.testing.assert_allclose(part.participation * signs[:, np.newaxis], truth.participation, atol=digits * largest)
    for name, place in truth.points.items():
        np.testing.assert_allclose(part.points[name], place, atol=1e-12)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("files", "points", "digits"),
    [
        (["cb.op4"], "boundary.csv", 1e-6),
        (["cb.op2"], "boundary.csv", 1e-6),
        (["plate.op2", "modes.csv"], "points.csv", 1e-6),  # single precision
        (["plate.pch", "modes.csv"], "points.csv", 1e-6),  # seven digits
        (["plate.f06", "modes.csv"], "points.csv", 1e-6),
        (["plate.unv", "modes.csv"], "points.csv", 1e-6),  # six digits, of a largest shape that begins with 6
    ],
)
def test_one_plate_is_the_same_part_from_every_file(files, points, digits, folder, truth):
    part, mass = import_part([folder / name for name in files], folder / points, UNITS, damping=ZETA)
    if mass is not None:
        fe = plate(A, B, H, NX, NY, clamped=True)
        np.testing.assert_allclose(mass, [0.0, 0.0, fe.force @ np.linalg.solve(fe.mass, fe.force)], rtol=1e-7, atol=1e-9)
        part = part.below(1.0001 * truth.frequencies[-1])
    same(part, truth, digits)


def test_a_universal_file_is_read_to_the_last_of_the_six_digits_that_it_has(folder, truth):
    part, _ = import_part([folder / "plate.unv"], folder / "points.csv", UNITS, damping=ZETA)
    np.testing.assert_allclose(part.frequencies, [float(f"{f:13.5e}") for f in truth.frequencies], rtol=1e-15)
    for name in FEET:
        written = np.vectorize(lambda value: float(f"{value:13.5e}"))(truth.shapes[name] / np.sqrt(TONNE))
        np.testing.assert_allclose(part.shapes[name] / np.sqrt(TONNE), written, rtol=1e-14)


def test_grid_points_of_bulk_text_are_points(folder, truth):
    given, _ = import_part([folder / "plate.op2", folder / "modes.csv"], folder / "points.csv", UNITS, damping=ZETA)
    part, _ = import_part([folder / "plate.op2", folder / "modes.csv"], folder / "plate.bdf", UNITS, damping=ZETA)
    assert list(part.points) == ["100", "101", "102", "103"]
    for number, name in enumerate(FEET, 100):
        np.testing.assert_allclose(part.points[str(number)], truth.points[name], atol=1e-9)
        np.testing.assert_array_equal(part.shapes[str(number)], given.shapes[name])


def test_files_that_nastran_itself_has_written_are_read(tmp_path):
    """Hold pyyeti's own example, a truss from SOL 103 with three elastic modes at two grid points, against its listing."""
    where = Path(pyyeti.__file__).parent / "tests" / "nas2cam_extseout"
    if not (where / "inboard.op2").exists():
        pytest.skip("this pyyeti was installed without its examples")
    (tmp_path / "points.csv").write_text("point,node,x,y,z\na,4,0,0,0\nb,16,1,0,0\n")
    part, _ = import_part([where / "inboard.op2"], tmp_path / "points.csv", UNITS, damping=ZETA)
    np.testing.assert_allclose(part.frequencies, [6.129345, 6.130134, 23.63188], rtol=1e-6)
    with pytest.raises(RecordError, match="grid point 11 are in coordinate system 10"):
        import_part([where / "inboard.op2"], copied(where / "inboard.pch", tmp_path / "inboard.bdf"), UNITS, damping=ZETA)


def copied(file, to):
    return Path(shutil.copy(file, to))


def matrices(change):
    """Return what writes the plate's matrices with a change."""

    def write(folder, truth):
        k, m = craig_bampton()
        op4.write(str(folder / "cb.op4"), change(k, m))

    return write


def moved(matrix, row, column, value):
    changed = matrix.copy()
    changed[row, column] = value
    return changed


def text(name, change):
    """Return what rewrites a text file of the plate."""

    def write(folder, truth):
        path = folder / name
        path.write_text(change(path.read_text()))

    return write


def halved(text):
    return text[: len(text) // 2].rsplit("\n", 1)[0] + "\n    -1\n"


def universal(**changes):
    def write(folder, truth):
        shapes = np.array([truth.shapes[name] for name in FEET]) / np.sqrt(TONNE)
        write_uff(folder / "plate.unv", {name: 100 + n for n, name in enumerate(FEET)}, truth, shapes, **changes)

    return write


def largest_is_one(folder, truth):
    shapes = np.array([truth.shapes[name] for name in FEET])
    shapes /= np.abs(shapes).max(axis=(0, 2))[:, np.newaxis]
    (folder / "plate.pch").write_text(punched(dict(zip(FEET, range(100, 104), strict=True)), truth.frequencies, shapes))


def modes(**changes):
    """Return what writes an OP2 file of modes with a change."""

    def write(folder, truth):
        shapes = np.array([truth.shapes[name] for name in FEET]) / np.sqrt(TONNE)
        nodes = dict(zip(FEET, range(100, 104), strict=True))
        (folder / "plate.op2").write_bytes(op2_of_modes(nodes, truth.frequencies, shapes, **changes))

    return write


def twice(folder, truth):
    written = (folder / "plate.op2").read_bytes()
    (folder / "plate.op2").write_bytes(written[:-12] + written)  # without the mark of the end


OP4, UNV, PCH = (
    (["cb.op4"], "boundary.csv"),
    (["plate.unv", "modes.csv"], "points.csv"),
    (["plate.pch", "modes.csv"], "points.csv"),
)
OP2, F06, BULK = (["plate.op2"], "points.csv"), (["plate.f06"], "points.csv"), (["plate.op2"], "plate.bdf")
DAMAGED = {
    "op4 missing": (OP4, lambda folder, truth: (folder / "cb.op4").unlink(), "cannot be read"),
    "op4 of noise": (OP4, lambda folder, truth: (folder / "cb.op4").write_bytes(bytes(range(256)) * 9), "no OP4 file"),
    "op4 cut": (OP4, lambda folder, truth: cut(folder / "cb.op4"), "no OP4 file, or it is damaged"),
    "no mass": (OP4, matrices(lambda k, m: {"kaa": k}), "expected one mass matrix"),
    "two stiffnesses": (OP4, matrices(lambda k, m: {"kaa": k, "kxx": k, "maa": m}), "got 2; the matrices are kaa, kxx, maa"),
    "one triangle": (OP4, matrices(lambda k, m: {"kaa": np.tril(k), "maa": m}), "KAA is not symmetric"),
    "another size": (OP4, matrices(lambda k, m: {"kaa": k, "maa": m[:-1, :-1]}), "both are of one reduction"),
    "not square": (OP4, matrices(lambda k, m: {"kaa": k[:-1], "maa": m}), "must be real and square"),
    "zero": (OP4, matrices(lambda k, m: {"kaa": 0.0 * k, "maa": m}), "no finite numbers but 0"),
    "complex stiffness": (OP4, matrices(lambda k, m: {"kaa": k * (1.0 + 0.03j), "maa": m}), "must be real"),
    "modes first": (OP4, matrices(lambda k, m: {"kaa": k[::-1, ::-1], "maa": m[::-1, ::-1]}), "these coordinates are no modes"),
    "a point too few": (OP4, text("boundary.csv", lambda t: t.rsplit("m4", 1)[0]), "are not those of 4 boundary points"),
    "modes not normalised": (OP4, matrices(lambda k, m: {"kaa": k, "maa": scaled_behind(m, 4.0)}), "not mass-normalised"),
    "points in metres": (OP4, text("boundary.csv", lambda t: t.replace("300,", "0.3,")), "K resists a rigid motion"),
    "grounded": (OP4, matrices(lambda k, m: {"kaa": moved(k, 2, 2, 2.0 * k[2, 2]), "maa": m}), "along z: the part is grounded"),
    "negative mass": (OP4, matrices(lambda k, m: {"kaa": k, "maa": moved(m, 8, 8, -m[8, 8])}), "M is not positive"),
    "held by a word": (OP4, text("boundary.csv", lambda t: t.replace("yes", "fixed")), "says yes or nothing"),
    "universal of noise": (UNV, lambda folder, truth: (folder / "plate.unv").write_bytes(b"\x00" * 99), "no normal modes"),
    "universal cut": (UNV, text("plate.unv", halved), "damaged|other nodes"),
    "complex modes": (UNV, universal(analysis_type=3, eig=1.0 + 60j, modal_a=1j, modal_b=1j), "its modes are complex"),
    "accelerations": (UNV, universal(spec_data_type=12), "is no displacement"),
    "a mode twice": (UNV, universal(mode_n=1), "mode 1 stands there twice"),
    "rigid-body modes": (UNV, universal(freq=1e-3), "rigid-body motions are the body's own"),
    "nodes elsewhere": (UNV, text("points.csv", lambda t: t.replace("m1,100", "m1,101")), "is elsewhere than its node"),
    "a node that is not there": (UNV, text("points.csv", lambda t: t.replace(",103,", ",999,")), "no shapes of node '999'"),
    "another analysis": (UNV, text("modes.csv", lambda t: t.replace("\n1,", "\n1,9")), "expected the 8 modes of plate.unv"),
    "punch without modes": (PCH, text("plate.pch", lambda t: t.replace("$EIGENVALUE", "$TIME")), "no real eigenvectors"),
    "punch of complex modes": (PCH, text("plate.pch", lambda t: t.replace("$REAL ", "$REAL-IMAGINARY ")), "modes are complex"),
    "punch by points": (PCH, text("plate.pch", lambda t: "$POINT ID =  1\n" + t), "SORT2"),
    "punch cut": (PCH, text("plate.pch", lambda t: "\n".join(t.splitlines()[:-4])), "mode 8 is at other grid points"),
    "punch of stars": (PCH, text("plate.pch", lambda t: t.replace("E-0", "*-0", 1)), "a grid point and its three"),
    "scaled to one": (PCH, largest_is_one, "not mass-normalised"),
    "op2 missing": (OP2, lambda folder, truth: (folder / "plate.op2").unlink(), "cannot be read"),
    "op2 of noise": (OP2, lambda folder, truth: (folder / "plate.op2").write_bytes(bytes(range(256)) * 9), "no OP2 file"),
    "op2 cut": (OP2, lambda folder, truth: cut(folder / "plate.op2"), "no OP2 file, or it is damaged"),
    "op2 of two subcases": (OP2, twice, "it has 2 tables of shapes"),
    "op2 of complex modes": (OP2, modes(kind=1007, approach=92), "no real modes sorted by modes"),
    "op2 of forces": (OP2, modes(table="OEF1X"), "expected one stiffness matrix, .* the matrices are none. Write both by DMAP"),
    "f06 without vectors": (F06, text("plate.f06", lambda t: t.replace("V E C T O R", "V A L U E")), "no real eigenvectors"),
    "f06 of complex modes": (F06, text("plate.f06", lambda t: t.replace("R E A L ", "C O M P L E X ")), "modes are complex"),
    "f06 by points": (F06, text("plate.f06", lambda t: "      POINT-ID =  100\n" + t), "SORT2"),
    "f06 cut": (F06, text("plate.f06", lambda t: t[: len(t) // 2].rsplit("R E A L", 1)[0]), "other grid points than the first"),
    "f06 of a row too short": (F06, text("plate.f06", lambda t: t.replace("0.0            0.0  ", "0.0", 1)), "six numbers"),
    "bulk text of another model": (BULK, text("plate.bdf", lambda t: t.replace(" 10", " 20")), "none of its 5 grid points"),
    "bulk text of nothing": (BULK, text("plate.bdf", lambda t: "CQUAD4,1,1,1,2,3,4\n"), "none of its 0 grid points"),
    "bulk text of a damaged number": (BULK, text("plate.bdf", lambda t: t.replace("300.", "30o.", 1)), "GRID 100 holds '-30o"),
}  # fmt: skip


def cut(path):
    path.write_bytes(path.read_bytes()[:5000])


def scaled_behind(m, factor):
    changed = m.copy()
    changed[30:] *= np.sqrt(factor)
    changed[:, 30:] *= np.sqrt(factor)
    return changed


@pytest.mark.parametrize("kind", DAMAGED)
def test_a_damaged_or_other_file_is_named_in_one_message(kind, tmp_path, truth, capsys):
    (files, points), change, message = DAMAGED[kind]
    where = with_files(tmp_path / "plate", truth)
    change(where, truth)
    given = [where / name for name in files]
    with pytest.raises(RecordError, match=message):
        import_part(given, where / points, UNITS, damping=ZETA)
    command = ["flexible", *map(str, given), "--points", str(where / points), "--units", "mm,t,s"]
    assert main([*command, "--out", str(tmp_path / "part")]) == 2
    error = capsys.readouterr().err
    assert error.startswith("wirerope: ")
    assert error.count("\n") == 1
    assert not (tmp_path / "part").exists()


def test_the_command_says_how_much_of_the_mass_the_modes_bring_along(folder, tmp_path, capsys):
    command = ["flexible", str(folder / "cb.op4"), "--points", str(folder / "boundary.csv"), "--units", "mm,t,s"]
    assert main([*command, "--out", str(tmp_path / "all")]) == 0
    whole = " ".join(capsys.readouterr().out.split())
    assert "60 modes" in whole
    assert "less than 90 %" not in whole
    assert main([*command, "--out", str(tmp_path / "few"), "--highest-hz", "60"]) == 0
    assert "less than 90 %" in " ".join(capsys.readouterr().out.split())
    assert main([*command, "--out", str(tmp_path / "none"), "--highest-hz", "1"]) == 2
    assert "none is below 1 Hz" in capsys.readouterr().err
    kilograms = [*command[:-1], "mm,g,s", "--out", str(tmp_path / "light")]
    assert main(kilograms) == 0
    assert "are the units those that --units says?" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("highest", [60.0, 200.0])
def test_residual_vectors_keep_the_static_compliance_of_the_modes_that_are_left_out(highest, folder, tmp_path, capsys):
    whole, _ = import_part([folder / "cb.op4"], folder / "boundary.csv", UNITS, damping=ZETA)
    few, residual = whole.below(highest), whole.below(highest, residual=True)
    n, added = len(few.frequencies), len(residual.frequencies) - len(few.frequencies)
    assert 0 < added <= 5  # four feet along z, and a motion of the base
    np.testing.assert_array_equal(residual.frequencies[:n], few.frequencies)
    assert (residual.frequencies[n:] > highest).all()
    np.testing.assert_allclose(residual.damping, ZETA, rtol=1e-12)

    def stacked(part):
        return np.array([part.shapes[name][:, 2] for name in FEET]) / part.frequencies

    def held(part):  # what a unit acceleration of the base deflects the feet by
        return stacked(part) @ (part.participation[:, 2] / part.frequencies)

    exact = stacked(whole) @ stacked(whole).T
    np.testing.assert_allclose(stacked(residual) @ stacked(residual).T, exact, rtol=0, atol=1e-3 * exact.max())
    np.testing.assert_allclose(held(residual), held(whole), rtol=1e-3)
    share = float(np.diag(stacked(few) @ stacked(few).T / exact).min())
    command = ["flexible", str(folder / "cb.op4"), "--points", str(folder / "boundary.csv"), "--units", "mm,t,s"]
    assert main([*command, "--out", str(tmp_path / "few"), "--highest-hz", str(highest)]) == 0
    assert f"along z the modes have {100.0 * share:.1f} % of the static compliance" in " ".join(capsys.readouterr().out.split())
    assert main([*command, "--out", str(tmp_path / "residual"), "--highest-hz", str(highest), "--residual"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "% of the static compliance" not in said
    assert f"{n} mode" in said
    assert f"and {added} residual vector" in said
    assert "take more modes" not in said
    assert ("residual vectors carry the rest of what was read" in said) == (highest < 100.0)  # where modes lack a tenth
    assert main([*command, "--out", str(tmp_path / "whole"), "--residual"]) == 2
    assert "say --highest-hz, too" in capsys.readouterr().err


def test_a_mass_that_nothing_has_is_refused(folder, tmp_path, capsys):
    command = ["flexible", str(folder / "cb.op4"), "--points", str(folder / "boundary.csv"), "--units", "mm,t,s"]
    assert main([*command, "--mass-kg", "5e-324", "--out", str(tmp_path / "part")]) == 2
    assert "`--mass-kg` must lie between" in capsys.readouterr().err
    assert not (tmp_path / "part").exists()


def test_a_universal_file_without_any_one_of_its_lines_is_the_same_part_or_refused(tmp_path, truth):
    where = with_files(tmp_path / "plate", truth)
    lines = (where / "plate.unv").read_text().splitlines(keepends=True)
    second = next(n for n, line in enumerate(lines) if n > 40 and line.split() == ["-1"] and lines[n + 1].split() == ["-1"])
    whole, _ = import_part([where / "plate.unv"], where / "points.csv", UNITS, damping=ZETA)
    refusals = 0
    for doubled in (False, True):
        for number in range(second):  # the nodes and the first mode; the others are alike
            (where / "plate.unv").write_text("".join([*lines[:number], *[lines[number]] * 2 * doubled, *lines[number + 1 :]]))
            try:
                part, _ = import_part([where / "plate.unv"], where / "points.csv", UNITS, damping=ZETA)
            except RecordError:
                refusals += 1
                continue
            np.testing.assert_array_equal(part.frequencies, whole.frequencies)
            for name, shape in whole.shapes.items():
                np.testing.assert_array_equal(part.shapes[name], shape)
    assert refusals > second


@pytest.mark.parametrize("ending", ["asm", "pch", "pun", "nas"])
def test_grid_points_of_an_external_superelement_are_read_by_any_of_its_endings(ending, tmp_path, truth):
    where = with_files(tmp_path / "plate", truth)
    (where / "plate.bdf").rename(where / f"grids.{ending}")
    part, _ = import_part([where / "plate.op2"], where / f"grids.{ending}", UNITS, damping=ZETA)
    assert set(part.points) == {"100", "101", "102", "103"}
