"""Slips that show beside something else: other rows, other tables, what stands above a header, another load case."""

import re
from collections.abc import Callable

import numpy as np
import scipy

from tests.slips.foreign_inputs import earthquake, text
from tests.slips.from_practice import (
    FOLDERS,
    MASSES,
    MOUNTS,
    POINTS,
    SHEETS,
    STUDIES,
    TRIAXIAL,
    cell,
    changed,
    number,
)
from tests.slips.measured_inputs import DENSITIES, JOBS, LOOPS, RECORDS, SHOCKS, levels_base
from tests.slips.models_and_tables import columns, put, times
from tests.slips.planting import Base, Slip
from tests.slips.records_and_jobs import course, in_place_of, on_rows
from tests.slips.right_inputs import CABINET, MOMENTS, shipped
from wirerope_mj.foundation.arrays import Array

FLOOR = shipped("floating_floor.xml")
ASKED = tuple(Base(f"{base.name}, all of it", base.files, base.asked) for base in JOBS)  # by `wirerope check`


def _ground(rate: float, length: float, peak: float, seed: int) -> Base:
    time, a = earthquake(rate, length, peak=peak, seed=seed)
    rows = [[f"{value:.6g}" for value in row] for row in np.column_stack([time, a])]
    return Base(f"ground of {peak:g} m/s2", {"r.csv": text(["time [s],x [m/s^2]"], rows)}, "r.csv")


GROUNDS = (_ground(200.0, 30.0, 3.5, 3), _ground(100.0, 40.0, 2.2, 11), _ground(200.0, 50.0, 6.0, 21))
TABLES_OF_LINES = tuple(
    Base(f"amplitudes {number}", {"a.csv": f"from [Hz],to [Hz],displacement [mm]\n{rows}\n"}, "a.csv")
    for number, rows in enumerate(("4,15,0.76\n16,25,0.51\n26,33,0.25", "2,13,1\n14,100,0.2", "5,20,1.6\n21,80,0.1"))
)
SINES = tuple(levels_base(f"sine {phrase}", "sine", f"{phrase} 10 s z") for phrase in ("2 g 20 Hz", "1 g 35 Hz", "5 g 60 Hz"))


def _in_metres(words: str) -> str:
    """Write the place of a table's first row in m."""
    for axis in "xyz":
        words = cell(0, axis, times(1e-3))(words)
    return words


def _without_a_mount(words: str) -> str:
    lines = words.splitlines()
    lines.remove(next(line for line in lines if not line.startswith(("#", "name"))))
    return "\n".join(lines) + "\n"


def _placeholder(body: str, mass: float) -> Callable[[str], str]:
    return put(
        rf'(<body name="{body}"[^>]*>)', rf'\1<inertial mass="{mass:g}" pos="0.03 0.03 0.3" diaginertia="1 1 1"/>', first=1
    )


def _twice(rows: Array) -> Array:
    later = rows.copy()
    later[:, 0] += rows[-1, 0] + rows[1, 0] - rows[0, 0]
    return np.concatenate([rows, later])


def _counts(_: Array, a: Array) -> Array:
    return np.round(20_000.0 * a / np.abs(a).max())


def _lost(_: Array, a: Array) -> Array:
    lost = a.copy()
    for part in (0.3, 0.5, 0.8):
        lost[int(part * a.size) : int(part * a.size) + 2] = -9999.0
    return lost


def _coupled(time: Array, a: Array) -> Array:
    """AC-couple a pulse at 3 Hz, and let its fixture ring behind it."""
    sections = scipy.signal.butter(1, 3.0, "highpass", fs=1.0 / (time[1] - time[0]), output="sos")
    since = np.maximum(time - time[int(np.abs(a).argmax())], 0.0)
    return scipy.signal.sosfilt(sections, a) + 0.15 * np.abs(a).max() * np.exp(-since / 0.05) * np.sin(
        2.0 * np.pi * 400.0 * since
    )


def _above(line: str) -> Callable[[str], str]:
    return lambda words: f"# {line}\n{words}"


def _peak_to_peak(words: str) -> str:
    """Add a column of amplitudes that are those from peak to peak."""
    head, *lines = words.splitlines()
    x = np.abs([float(line.split(",")[1]) for line in lines])
    size = (len(lines) - 1) // 3
    sizes = [2.0 * x[1 + part * size : 1 + (part + 1) * size].max() for part in range(3)]
    rows = [f"{line},{sizes[min(max(row - 1, 0) // size, 2)]:g}" for row, line in enumerate(lines)]
    return "\n".join([f"{head},amplitude [mm]", *rows]) + "\n"


def _copied_force(rows: Array) -> Array:
    return np.column_stack([rows[:, :2], 200.0 * rows[:, 1]])


def _off_zero(rows: Array) -> Array:
    return rows + np.array([0.0, 0.0, 5.0 * np.ptp(rows[:, 2])])


def _one_far(rows: Array) -> Array:
    far = rows.copy()
    far[len(far) // 3, 1] = 1e9
    return far


def _copied_case(words: str) -> str:
    case = re.search(r'\[\[case\]\]\nname = "vertical shock"\n[^[]*', words)
    assert case is not None
    return words.replace("[limits]", case[0].replace("vertical shock", "from below") + "[limits]")


_AT = r"at 50 ms(.*\n)duration = "
IN_TABLES = (
    Slip("the place of one part in m", FOLDERS, _in_metres, "in m where the header says mm", MASSES),
    Slip("the place of one point in m", FOLDERS, _in_metres, "in m where the header says mm", POINTS),
    Slip("heights of all mounts in m", FOLDERS, columns("z", times(1e-3)), '"z" in m where the header says mm', MOUNTS),
    Slip("one mass in t", FOLDERS, cell(0, "mass", times(1e-3)), "lighter than air", MASSES),
    Slip("one part's inertia in kg cm^2", MOMENTS, lambda words: cell(0, "izz", times(1e4))(cell(0, "iyy", times(1e4))(
        cell(0, "ixx", times(1e4))(words))), "lighter than air|in mm where", MASSES),
    Slip("one point a digit too long", FOLDERS, cell(0, "z", times(100)), "digit too long|stands outside", POINTS),
    Slip("a row of mounts left out", FOLDERS, _without_a_mount, "row of mounts missing", MOUNTS),
    Slip("travel of a sheet in inches", SHEETS[:2], number(r"^travel_mm = ", times(1 / 25.4)), "travel in inches"),
    Slip("one geom's mass in g", (CABINET, FLOOR),
         put(r'(name="(?:unit_upper_3|crew_4_torso)".*mass=")(\d+)', r"\g<1>\g<2>000"), "is that in g"),
    Slip("a placeholder for the inertia", (FLOOR,), _placeholder("floor", 1900), "denser than any material"),
    Slip("a placeholder for the inertia of a rack", (CABINET,), _placeholder("rack", 850), "denser than any material"),
)  # fmt: skip
IN_RECORDS = (
    Slip("cm/s^2 under m/s^2 in earthquakes", GROUNDS, on_rows(lambda rows: rows * np.array([1.0, 100.0])), "gal"),
    Slip("one sensor recorded twice", TRIAXIAL, changed(lambda _, a: np.column_stack([a[:, 0], 0.9731 * a[:, 0], a[:, 2]])),
         "recorded twice"),
    Slip("a record appended twice", TRIAXIAL, on_rows(_twice), "appended twice"),
    Slip("another rate above the header", RECORDS, _above("Sampling rate: 51200 Hz"), "above its header"),
    Slip("counts of the converter", RECORDS, course(_counts), "counts of the converter"),
    Slip("a code for lost samples", RECORDS, course(_lost), "code for samples"),
    Slip("AC coupling behind ringing", SHOCKS, course(_coupled), "AC coupling"),
    Slip("a scale of 9.81 on a record in g", ASKED, in_place_of('baseline = "rest"', 'baseline = "rest"\nscale = 9.81'),
         "done already"),
)  # fmt: skip
IN_LOOPS = (
    Slip("amplitudes from peak to peak", LOOPS, _peak_to_peak, "from peak to peak"),
    Slip("the deflection for the force", LOOPS, on_rows(_copied_force), "deflection once more"),
    Slip("a zero of the force five ranges off", LOOPS, on_rows(_off_zero), "zero off"),
    Slip("one deflection of 1e9 mm", LOOPS, on_rows(_one_far), "stands alone"),
)
IN_SPECTRA = (
    Slip("another rms above the header", DENSITIES, _above("overall 17.7 Grms"), "above its header", file="psd.csv"),
    Slip("levels in dB under g^2/Hz", DENSITIES, on_rows(lambda rows: np.column_stack([rows[:, 0], 10 * np.log10(rows[:, 1])])),
         "in dB", file="psd.csv"),
    Slip("mm/s for mm in a table of amplitudes", TABLES_OF_LINES, on_rows(lambda rows: rows * np.array([1.0, 1.0, 150.0])),
         "no shaker"),
    Slip("a sine of a hundredth of its frequency", SINES, in_place_of(r"g (\d+) Hz", r"g 0.\1 Hz"), "no shaker"),
)  # fmt: skip
IN_JOBS = (
    Slip("a vertical case along x", ASKED, in_place_of(r" z at 50 ms", " x at 50 ms"), "is called vertical"),
    Slip("a case copied and only renamed", ASKED, _copied_case, "was one copied"),
    Slip("a shock at 50 s", ASKED, in_place_of(f"{_AT}0.5", r"at 50 s\1duration = 51"), "50 ms meant"),
    Slip("a run that ends within its pulse", ASKED[::2], in_place_of(f"{_AT}0.5", r"at 50 ms\1duration = 0.055"),
         "ends within"),
    Slip("levels in per cent", STUDIES, put(r"Uniform\(0.85, 1.15\)", "Uniform(85, 115)"), "in per cent"),
    Slip("an elevation in radians", STUDIES, put('"motion/level": wr.Uniform.0.85, 1.15.',
         '"motion/elevation": wr.Uniform(-1.5708, 1.5708)'), "look like radians"),
)  # fmt: skip
SLIPS = (*IN_TABLES, *IN_RECORDS, *IN_LOOPS, *IN_SPECTRA, *IN_JOBS)
