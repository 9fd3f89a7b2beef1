"""Cyclic tests as CSV files: what is written comes back, what a rig exports is read, what is wrong is named by its line."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.mounts.test_rig import cyclic_test, measured

pytestmark = pytest.mark.quick

LAW = wr.AsymmetricBoucWen(alpha=1e5, beta=1500.0, gamma=0.0, n=1, k1=2e4, k2=0.0, k3=1e9, b=np.e, c=150.0)
PHASE = 2.0 * np.pi * np.arange(13) / 12


def rows(label="1", *, scale=1.0, points=13, lag=0.3):
    """Return the rows of an ellipse, 12 samples a cycle: label, time, deflection, force."""
    angle = 2.0 * np.pi * np.arange(points) / 12
    return [f"{label},{i / 12:.4f},{scale * np.sin(a):.6f},{scale * np.sin(a + lag):.6f}" for i, a in enumerate(angle)]


def write(folder, *lines, header="loop,time [s],deflection [mm],force [kN]"):
    path = folder / "test.csv"
    path.write_text("\n".join([header, *lines]) + "\n", encoding="utf-8")
    return path


def test_loops_in_si_come_back_to_the_bit(tmp_path):
    loops = cyclic_test(LAW, [1e-3, 3e-3], operating_point=-1e-3)
    wr.save_cyclic_test(loops, tmp_path / "t.csv", frequency=0.1)
    again = wr.load_cyclic_test(tmp_path / "t.csv")
    assert len(again) == 2
    for one, other in zip(loops, again, strict=True):
        np.testing.assert_array_equal(other.deflection, one.deflection)
        np.testing.assert_array_equal(other.force, one.force)
        assert other.closure == one.closure
        assert other.secant_stiffness == one.secant_stiffness
        # Trapezoid against the law's own segments: (2 pi / 400)^2 / 6 of the area.
        assert other.dissipated_energy == pytest.approx(one.dissipated_energy, rel=2e-4)
        assert np.isnan(other.hysteretic_state).all()
        assert other.internal_states.size == 0
        assert other.cycles == 0


def test_loops_in_mm_and_kn_come_back_to_rounding(tmp_path):
    loops = cyclic_test(LAW, 3e-3)
    wr.save_cyclic_test(loops, tmp_path / "t.csv", deflection_unit="mm", force_unit="kN")
    text = (tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()
    assert text[1] == "loop, deflection [mm], force [kN]"
    assert max(float(line.split(",")[1]) for line in text[2:]) == pytest.approx(3.0, rel=1e-15)
    (again,) = wr.load_cyclic_test(tmp_path / "t.csv")
    np.testing.assert_allclose(again.deflection, loops[0].deflection, rtol=4e-16, atol=0)  # two roundings
    np.testing.assert_allclose(again.force, loops[0].force, rtol=4e-16, atol=0)


def test_time_is_written_uniform_from_zero_in_each_loop(tmp_path):
    wr.save_cyclic_test(cyclic_test(LAW, [1e-3, 2e-3], points_per_cycle=8), tmp_path / "t.csv", frequency=0.5)
    lines = [line.split(", ") for line in (tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()[2:]]
    assert [line[0] for line in lines] == ["1"] * 9 + ["2"] * 9
    assert [float(line[1]) for line in lines] == [0.25 * i for i in range(9)] * 2


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("before", encoding="utf-8")
    broken = replace(cyclic_test(LAW, 1e-3)[0], force=np.zeros(3))
    with pytest.raises(ValueError, match="shorter"):
        wr.save_cyclic_test([broken], path)
    assert path.read_text(encoding="utf-8") == "before"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"loops": []}, "`loops` must hold at least one loop"),
        ({"frequency": 0.0}, "`frequency` must be > 0, got 0.0"),
        ({"deflection_unit": "inch"}, "`deflection_unit` must be one of 'm', 'mm', 'cm', 'in', .*, got 'inch'"),
        ({"force_unit": "kg"}, "`force_unit` must be one of 'N', .*'kN', 'lbf', .*got 'kg'"),
    ],
)
def test_bad_arguments_of_writing_are_named(tmp_path, arguments, message):
    with pytest.raises(ValueError, match=message):
        wr.save_cyclic_test(**{"loops": cyclic_test(LAW, 1e-3), "path": tmp_path / "t.csv"} | arguments)
    assert list(tmp_path.iterdir()) == []


def test_comments_units_other_words_and_other_columns_are_understood(tmp_path):
    path = tmp_path / "rig.csv"
    lines = ["# rig 3, spring log1", "", "t [ms];Displacement [mm];temperature;Load [kN];loop"]
    for i, angle in enumerate(PHASE.tolist()):
        lines.append(f"{10 * i};{2.0 * math.sin(angle)!r};warm;{3.0 * math.sin(angle + 0.2)!r};log1 / 3")
    path.write_text("\r\n".join(lines), encoding="utf-8")
    (loop,) = wr.load_cyclic_test(path)
    np.testing.assert_allclose(loop.deflection, 2e-3 * np.sin(PHASE), rtol=1e-15)  # the unit costs one rounding
    np.testing.assert_allclose(loop.force, 3e3 * np.sin(PHASE + 0.2), rtol=1e-15)
    # An inscribed polygon of 12 chords: sin(2 pi / 12) / (2 pi / 12) of the ellipse's pi A F sin(lag).
    area = np.pi * 2e-3 * 3e3 * np.sin(0.2) * np.sin(np.pi / 6) / (np.pi / 6)
    assert loop.dissipated_energy == pytest.approx(area, rel=1e-12)


def test_quoted_cells_and_an_empty_last_column_are_understood(tmp_path):
    lines = ["\t".join(f'"{cell}"' for cell in row.split(",")) + "\t" for row in rows()]
    header = '"loop"\t"time [s]"\t"deflection [mm]"\t"force [kN]"\tremark'
    (loop,) = wr.load_cyclic_test(write(tmp_path, *lines, header=header))
    assert loop.deflection.max() == pytest.approx(1e-3, rel=1e-12)


def test_rows_of_one_amplitude_are_a_loop(tmp_path):
    lines = rows("1.0") + rows("2.0", scale=2.0)
    loops = wr.load_cyclic_test(write(tmp_path, *lines, header="amplitude [mm],time [s],deflection [mm],force [kN]"))
    assert [loop.amplitude for loop in loops] == pytest.approx([1e-3, 2e-3], rel=1e-6)  # six decimals written


def test_a_file_without_loop_column_is_one_loop(tmp_path):
    lines = [row.partition(",")[2] for row in rows()]
    (loop,) = wr.load_cyclic_test(write(tmp_path, *lines, header="time [s],deflection [mm],force [kN]"))
    assert loop.deflection.size == 13


@pytest.mark.parametrize("turn", [0, 1, 2, 3])
def test_a_cycle_that_lacks_its_last_sample_is_closed(tmp_path, turn):
    values = [row.split(",")[2:] for row in rows(points=12)]
    lines = [f"1,{i},{x},{force}" for i, (x, force) in enumerate(values[turn:] + values[:turn])]
    (loop,) = wr.load_cyclic_test(write(tmp_path, *lines))
    assert loop.deflection.size == 13
    assert loop.deflection[-1] == loop.deflection[0]
    force = [float(line.split(",")[3]) for line in lines]
    assert loop.closure == pytest.approx(abs(force[-1] - force[0]) / np.ptp(force), rel=1e-9)  # as the file ended
    area = np.pi * np.sin(0.3) * np.sin(np.pi / 6) / (np.pi / 6)
    assert loop.dissipated_energy == pytest.approx(area, rel=1e-5)  # six decimals in the file


def test_noisy_loops_are_read_as_they_stand(tmp_path):
    noisy = measured(cyclic_test(LAW, [1e-3, 3e-3]), seed=5, force_noise=5.0, deflection_noise=1e-5)
    wr.save_cyclic_test(noisy, tmp_path / "t.csv")
    for one, other in zip(noisy, wr.load_cyclic_test(tmp_path / "t.csv"), strict=True):
        np.testing.assert_array_equal(other.force[: one.force.size], one.force)
        assert other.closure == one.closure
        # The chord that closes the polygon may be added: no longer than the noise.
        assert other.dissipated_energy == pytest.approx(one.dissipated_energy, rel=0.01)


GOOD = rows()


def swapped(number, text):
    """Return the rows with row `number` of the file (the header is line 1) replaced."""
    return [text if i == number - 2 else row for i, row in enumerate(GOOD)]


@pytest.mark.parametrize(
    ("header", "lines", "message"),
    [
        (
            "loop,time [s],deflection [mm]",
            GOOD,
            r'line 1: there is no column "force".*loop, time, deflection; expected',
        ),
        ("loop,time [s],way,force [kN]", GOOD, r'line 1: there is no column "deflection"'),
        ("loop,deflection [mm],deflection [m],force [kN]", GOOD, r"line 1: deflection stands in the columns.*one unit"),
        ("loop,time [s],deflection,force [kN]", GOOD, r'line 1: column "deflection" has no unit.*m, mm'),
        ("loop,time [s],deflection [mm],force [kg]", GOOD, r'line 1: .*unknown unit "kg". Known units: N, daN, kN'),
        (None, swapped(5, "1,0.25,1.0 mm,0.9"), r'line 5: "1.0 mm" in column "deflection".*Units stand in the header'),
        (None, swapped(5, "1,0.25,high,0.9"), r'line 5: "high" in column "deflection" is not a number\.$'),
        (None, swapped(5, "1,0.25,,0.9"), r'line 5: "" in column "deflection" is not a number'),
        (None, swapped(5, "1,0.25,nan,0.9"), r'line 5: nan in column "deflection"'),
        (None, swapped(5, "1,0.25,1.0,inf"), r'line 5: inf in column "force"'),
        (None, swapped(5, "1,0.25,1.0"), r"line 5: 3 cells where the header has 4 columns"),
        (None, swapped(5, "1,0,0,25,1,0,0,9"), r"line 5: 8 cells.*Decimals are written with a point"),
        (None, swapped(5, "1,0.1,1.0,0.9"), r"line 5: time must increase.*got 0.1"),
        (
            None,
            GOOD + ["loop,time [s],deflection [m],force [N]"] + rows("2"),
            r"line 15:.*second header.*line 1.*one unit",
        ),
        (None, GOOD + rows("2") + rows("1"), r"line 28: loop 1 goes on here.*ended in line 14"),
        (None, GOOD[:5], r"lines 2 to 6: loop 1 has 5 samples; a cycle needs at least 8"),
        (None, rows(points=10), r"lines 2 to 11: loop 1 is not one cycle: its last sample is far from its first"),
        (
            None,
            rows(points=37),
            r"lines 2 to 38: loop 1 is not one cycle: .*to and fro 7 times.*`load_cycles` reads.*column \"loop\"",
        ),
        (None, rows(scale=0.0), r"the deflection of loop 1 never changes"),
        ("amplitude [m],time [s],deflection [mm],force [kN]", rows("1"), r"amplitude is 1000 mm but .*\+-1 mm"),
        (None, [], r"there are no rows behind the header in line 1"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path, header, lines, message):
    path = write(tmp_path, *lines, **({} if header is None else {"header": header}))
    with pytest.raises(RecordError) as caught:
        wr.load_cyclic_test(path)
    assert str(caught.value).startswith(str(path))
    assert re.search(message, str(caught.value)), caught.value


@pytest.mark.parametrize("sign", [";", "|", "\t"])
def test_rows_that_are_separated_otherwise_than_the_header_are_named(tmp_path, sign):
    path = write(tmp_path, *(row.replace(",", sign) for row in rows()))
    with pytest.raises(RecordError, match=r"test\.csv, line 2: 1 cell.*4"):
        wr.load_cyclic_test(path)


def test_line_numbers_count_comments_and_empty_lines(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("# one\n\nloop,deflection [mm],force [kN]\n# four\n1,0,0\n1,high,1\n", encoding="utf-8")
    with pytest.raises(RecordError, match=r'line 6: "high"'):
        wr.load_cyclic_test(path)


def test_missing_empty_and_unreadable_files_are_named(tmp_path):
    with pytest.raises(RecordError, match=r"nosuch.csv: no such file.*loop, time \[s\]"):
        wr.load_cyclic_test(tmp_path / "nosuch.csv")
    (tmp_path / "empty.csv").write_text("# nothing\n", encoding="utf-8")
    with pytest.raises(RecordError, match="the file is empty"):
        wr.load_cyclic_test(tmp_path / "empty.csv")
    with pytest.raises(RecordError, match="cannot be read"):
        wr.load_cyclic_test(tmp_path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda x, f: (x, -f), "the force falls where the deflection grows"),
        (lambda x, f: (x[::-1], f[::-1]), r"the cycle gives [\d.]+ J away"),
        (lambda x, f: (x, 0.0 * f + 3.0), "the force never changes, it stands at 3 N"),
    ],
)
def test_a_cycle_that_no_isolator_could_make_is_refused(tmp_path, change, message):
    angle = 2.0 * np.pi * np.arange(101) / 100
    deflection, force = change(1e-3 * np.sin(angle), 1e3 * np.sin(angle + 0.3))
    lines = [f"{x!r},{f!r}" for x, f in zip(deflection.tolist(), force.tolist(), strict=True)]
    with pytest.raises(RecordError, match=rf"lines 2 to 102: {message}"):
        wr.load_cyclic_test(write(tmp_path, *lines, header="deflection [m],force [N]"))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"PK\x03\x04\x14 zipped", "this is no XLSX file that can be read"),
        (b"\x89PNG\r\n", "this is a PNG picture, which is not read"),
        (b"column," * 2_000 + b"\n1,2\n", 'line 1: there is no column "deflection". .*column, column'),
        (b"deflection [mm],force [kN]\n0," + b"x" * 9_000 + b"\n", 'line 2: "x+\\.\\.\\." in column "force"'),
    ],
)
def test_bytes_that_are_no_text_and_endless_cells_are_refused_in_few_words(tmp_path, content, said):
    path = tmp_path / "t.csv"
    path.write_bytes(content)
    with pytest.raises(RecordError, match=said) as caught:
        wr.load_cyclic_test(path)
    assert len(str(caught.value).replace(str(path), "")) < 500  # two lines of a wide screen, not the whole file


@pytest.mark.parametrize(("k", "unit", "said"), [(1e5, "N", "kN where N is"), (2e6, "MN", "N where kN is")])
@pytest.mark.parametrize("read", [wr.load_cyclic_test, wr.load_cycles])
def test_forces_in_another_unit_than_the_header_says_are_named_as_deflections_are(tmp_path, k, unit, said, read):
    angle = 2.0 * np.pi * np.arange(201) / 200
    deflection, force = 2.0 * np.sin(angle), 2e-3 * k * np.sin(angle + 0.3)  # [mm], [N]
    wrong = force * {"N": 1e-3, "MN": 1.0}[unit]  # kN called N, and N called kN
    header = {"N": "force [N]", "MN": "force [kN]"}[unit]
    rows = [f"{x!r},{f!r}" for x, f in zip(deflection.tolist(), wrong.tolist(), strict=True)]
    path = tmp_path / "test.csv"
    path.write_text("\n".join([f"deflection [mm],{header}", *rows]))
    with pytest.raises(RecordError, match=f"than any isolator; are the forces in {said} said or expected"):
        read(path)
    with pytest.raises(ValueError, match="than any isolator"):
        wr.identify([wr.mounts.laws.Loop.from_samples(1e-3 * deflection, wrong * {"N": 1.0, "MN": 1e3}[unit])], law=wr.BoucWen)
