"""Fifty right inputs in the layouts of other programs: loggers, spreadsheets, CAD, test rigs, vibration controllers."""

import io
from collections.abc import Callable, Iterator

import numpy as np
import openpyxl
import scipy

import wirerope_mj as wr
from tests.slips.planting import Base
from wirerope_mj.foundation.arrays import Array

G = wr.STANDARD_GRAVITY
Cells = list[list[object]]


def _noise(count: int, seed: int) -> Array:
    return np.random.default_rng(seed).standard_normal(count)


def half_sine(rate: float, length: float, *, peak: float, lasts: float, at: float, seed: int = 1) -> tuple[Array, Array]:
    """Make a shock with the ringing of its table and the noise of its sensor: time [s], acceleration [unit of the peak]."""
    time = np.arange(0.0, length, 1.0 / rate)
    pulse = np.where((time >= at) & (time < at + lasts), peak * np.sin(np.pi * (time - at) / lasts), 0.0)
    late = np.clip(time - at - lasts, 0.0, None)
    rings = np.where(late > 0.0, 0.05 * peak * np.sin(2.0 * np.pi * 160.0 * late) * np.exp(-70.0 * late), 0.0)
    return time, pulse + rings + 1e-3 * peak * _noise(time.size, seed)


def vibration(rate: float, length: float, *, rms: float, low: float, high: float, seed: int = 2) -> tuple[Array, Array]:
    """Make random vibration between two frequencies: time [s], acceleration [unit of the rms value]."""
    count = int(length * rate)
    lines = np.fft.rfftfreq(count, 1.0 / rate)
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, lines.size)
    course = np.fft.irfft(np.where((lines > low) & (lines < high), np.exp(1j * phases), 0.0), count)
    return np.arange(count) / rate, rms * course / float(course.std())


def _faded(time: Array) -> Array:
    """Return a window that rises and falls within a second, as recorders cut what they keep."""
    return np.clip(time, 0.0, 1.0) * np.clip(time[-1] - time, 0.0, 1.0)


def earthquake(rate: float, length: float, *, peak: float, seed: int = 3) -> tuple[Array, Array]:
    """Make a ground motion that begins and ends at rest: time [s], acceleration [unit of the peak]."""
    time = np.arange(0.0, length, 1.0 / rate)
    grows = (
        np.clip(time / 3.0, 0.0, 1.0) ** 2
        * np.exp(-0.2 * np.clip(time - 10.0, 0.0, None))
        * np.clip((length - time) / 4.0, 0, 1)
    )
    band = scipy.signal.butter(2, [0.5, 8.0], "bandpass", fs=rate, output="sos")
    padded = np.pad(_noise(time.size, seed) * grows, 4000)
    shaken = scipy.signal.sosfiltfilt(band, padded)[4000:-4000] * np.clip((length - time) / 4.0, 0.0, 1.0)
    return time, peak * shaken / float(np.abs(shaken).max())


def _rows(*columns: Array, digits: int = 6) -> list[list[str]]:
    return [[f"{value:.{digits}g}" for value in row] for row in np.column_stack(columns)]


def text(lines: list[str], rows: list[list[str]], *, between: str = ",", comma: bool = False) -> str:
    """Join lines above a table and its rows, with decimal commas if asked."""
    body = [between.join(cell.replace(".", ",") if comma else cell for cell in row) for row in rows]
    return "\n".join([*lines, *body]) + "\n"


def workbook(cells: Cells, title: str = "Sheet1") -> bytes:
    """Write one sheet as a spreadsheet does."""
    book, file = openpyxl.Workbook(), io.BytesIO()
    sheet = book.active
    sheet.title = title
    for row in cells:
        sheet.append(row)
    book.save(file)
    return file.getvalue()


def matrices(**arrays: object) -> bytes:
    """Write arrays as MATLAB does."""
    file = io.BytesIO()
    scipy.io.savemat(file, arrays)
    return file.getvalue()


def universal(rate: float, course: Array, *, unit: str = "g") -> str:
    """Write a response in dataset 58, as modal test programs do."""
    head = (
        f"    -1\n    58\nNONE\nNONE\nNONE\n01-Dec-26 12:00:00\nNONE\n"
        f"{1:5d}{0:10d}{1:5d}{0:10d} {'NONE':10s}{1:10d}{3:4d} {'NONE':10s}{1:10d}{3:4d}\n"
        f"{2:10d}{course.size:10d}{1:10d}{0.0:13.5e}{1.0 / rate:13.5e}{0.0:13.5e}\n"
        f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':20s} {'s':20s}\n{12:10d}{0:5d}{0:5d}{0:5d} {'Acceleration':20s} {unit:20s}\n"
        f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}\n{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}\n"
    )
    lines = ["".join(f"{value:13.5e}" for value in course[n : n + 6]) for n in range(0, course.size, 6)]
    return head + "\n".join(lines) + "\n    -1\n"


def _records() -> Iterator[Base]:
    time, z = half_sine(5000.0, 0.6, peak=20.0, lasts=0.011, at=0.1)
    yield Base(
        "spreadsheet, semicolons, decimal commas",
        {"r.csv": text(["Zeit [s];z [g]"], _rows(time, z), between=";", comma=True)},
        "r.csv",
    )
    yield Base(
        "logger, tabs, two rows of header", {"r.txt": text(["Time\tz", "s\tm/s²"], _rows(time, G * z), between="\t")}, "r.txt"
    )
    lines = ["# Logger 4.2", "# Start 2026-03-01 08:15:00", "# Rate 5000 Hz", "Time (ms),Z (g)"]
    yield Base("logger, comments above, milliseconds", {"r.csv": text(lines, _rows(1e3 * time, z))}, "r.csv")
    yield Base("numpy.savetxt", {"r.csv": text(["# time [s] z [g]"], _rows(time, z), between=" ")}, "r.csv")
    index = [[str(n), *row] for n, row in enumerate(_rows(time, z))]
    yield Base("pandas with its index", {"r.csv": text([",time [s],z [g]"], index)}, "r.csv")
    quoted = [[f'"{cell}"' for cell in row] for row in _rows(time, z)]
    yield Base("every cell quoted", {"r.csv": text(['"time [s]","z [g]"'], quoted)}, "r.csv")
    yield Base("Windows line ends", {"r.csv": text(["time [s],z [g]"], _rows(time, z)).replace("\n", "\r\n")}, "r.csv")
    clock = [[f"{12.0 + t:.4f}", f"{a:.5g}"] for t, a in zip(time, z, strict=True)]
    yield Base("clock that runs since midnight", {"r.csv": text(["time [s],z [g]"], clock)}, "r.csv")
    book: Cells = [["Shock test 12", None], ["Operator", "A. B."], [None, None], ["time [s]", "z [g]"]]
    yield Base(
        "workbook with a title block", {"r.xlsx": workbook(book + [list(map(float, row)) for row in _rows(time, z)])}, "r.xlsx"
    )
    yield Base("MATLAB variables", {"r.mat": matrices(time_s=time, z_g=z)}, "r.mat")
    yield Base("universal file", {"r.uff": universal(5000.0, z)}, "r.uff")
    head = "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
    head += "Multi_Headings\tYes\nX_Columns\tNo\nTime_Pref\tAbsolute\n***End_of_Header***\t\n\t\n"
    head += "Channels\t1\t\nSamples\t3000\t\nY_Unit_Label\tg\t\n"
    head += "X_Dimension\tTime\t\nX0\t0.0\t\nDelta_X\t0.0002\t\n***End_of_Header***\t\t\nX_Value\tz\tComment"
    yield Base("LabVIEW", {"r.lvm": text([head], [["", row[1]] for row in _rows(time, z)], between="\t")}, "r.lvm")
    peer = ["PEER NGA STRONG MOTION DATABASE RECORD", "Made, 1/1/2026, Nowhere, 000", "ACCELERATION TIME SERIES IN UNITS OF G"]
    quake_time, quake = earthquake(200.0, 40.0, peak=0.3)
    rows = ["".join(f"{value:15.7E}" for value in quake[n : n + 5]) for n in range(0, quake.size, 5)]
    yield Base("PEER", {"r.AT2": "\n".join([*peer, f"NPTS= {quake.size:6d}, DT=   0.0050 SEC", *rows]) + "\n"}, "r.AT2")
    both = _rows(quake_time, 981.0 * quake, 700.0 * earthquake(200.0, 40.0, peak=0.3, seed=5)[1])
    yield Base("earthquake in gal, two axes", {"r.csv": text(["Time [s],x [gal],y [gal]"], both)}, "r.csv")
    slow_time, slow = vibration(50.0, 600.0, rms=0.05, low=1.0, high=15.0)
    slow = slow * _faded(slow_time)
    yield Base(
        "ten minutes of ship vibration at 50 Hz", {"r.csv": text(["time [s],z [g]"], _rows(slow_time, slow, digits=7))}, "r.csv"
    )
    road_time, road = vibration(1000.0, 60.0, rms=2.5, low=3.0, high=180.0)
    road = road * _faded(road_time)
    yield Base("a minute of road", {"r.csv": text(["t [s];z [m/s^2]"], _rows(road_time, road, digits=7), between=";")}, "r.csv")
    rail_time = road_time[:20000]
    axes = [vibration(1000.0, 20.0, rms=rms, low=2.0, high=90.0, seed=seed)[1] for rms, seed in ((0.4, 7), (0.3, 8), (0.6, 9))]
    rail = _rows(rail_time, *(axis * _faded(rail_time) for axis in axes))
    yield Base("rail, three axes", {"r.csv": text(["time [s],x [m/s^2],y [m/s^2],z [m/s^2]"], rail)}, "r.csv")
    fast_time, fast = half_sine(100_000.0, 0.05, peak=300.0, lasts=0.0008, at=0.01)
    yield Base(
        "pyroshock simulator at 100 kHz", {"r.csv": text(["time [ms],z [g]"], _rows(1e3 * fast_time, fast, digits=8))}, "r.csv"
    )
    barge_time = np.arange(0.0, 2.0, 5e-4)
    late = np.clip(barge_time - 0.2, 0.0, None)
    barge = np.where(late > 0.0, 130.0 * np.cos(2.0 * np.pi * 14.0 * late) * np.exp(-4.0 * late), 0.0) + 0.1 * _noise(
        barge_time.size, 4
    )
    yield Base("barge with a ringing deck", {"r.csv": text(["time [s],z [m/s^2]"], _rows(barge_time, barge))}, "r.csv")
    sensors = text(["time [s],rack top [g],base plate [g]"], _rows(time, 0.4 * z, z))
    yield Base("named channels of a test", {"r.csv": sensors}, "r.csv")
    sweep_time = np.arange(0.0, 20.0, 1e-3)
    sweep = (
        0.5
        * np.sin(2.0 * np.pi * (5.0 * sweep_time + 0.5 * sweep_time**2))
        * np.clip(sweep_time, 0.0, 1.0)
        * np.clip(20.0 - sweep_time, 0.0, 1.0)
    )
    yield Base("swept sine of a controller", {"r.csv": text(["Time [s],z [g]"], _rows(sweep_time, sweep, digits=7))}, "r.csv")


def _spectra() -> Iterator[Base]:
    unit = "g^2/Hz"
    yield Base(
        "controller profile, parentheses",
        {"p.csv": f"Frequency (Hz),PSD ({unit})\n10,0.001\n20,0.01\n500,0.01\n2000,0.0006\n"},
        "p.csv",
    )
    yield Base("profile, semicolons", {"p.csv": "Frequenz [Hz];psd [g²/Hz]\n5;0,0005\n20;0,002\n200;0,0002\n"}, "p.csv")
    yield Base("profile with units below", {"p.csv": f"frequency,psd\nHz,{unit}\n10,0.015\n40,0.015\n500,0.00015\n"}, "p.csv")
    yield Base("profile in (m/s2)2/Hz", {"p.csv": "frequency [Hz],psd [(m/s^2)^2/Hz]\n5,1.0\n20,1.0\n150,0.02\n"}, "p.csv")
    bands = f"from [Hz],to [Hz],psd [{unit}],slope [dB/oct]\n10,20,,6\n20,80,0.04,\n80,350,,-3\n"
    yield Base("profile of slopes", {"p.csv": bands}, "p.csv")
    yield Base(
        "profile as a workbook",
        {"p.xlsx": workbook([["frequency [Hz]", f"psd [{unit}]"], [5, 0.01], [50, 0.01], [200, 0.0006]])},
        "p.xlsx",
    )
    narrow = f"frequency [Hz],psd [{unit}]\n10,0.001\n16.9,0.001\n17,0.2\n18,0.2\n18.1,0.001\n500,0.001\n"
    yield Base("narrow band on random", {"p.csv": narrow}, "p.csv")
    yield Base("floor spectrum", {"s.csv": "Frequency [Hz],acceleration [g]\n0.5,0.1\n2,1.2\n9,1.2\n33,0.45\n"}, "s.csv")
    yield Base("shock spectrum", {"s.csv": "frequency [Hz],acceleration [g]\n5,8\n40,60\n1000,60\n"}, "s.csv")
    steady = "frequency [Hz],displacement [mm]\n4,1.0\n15,1.0\n25,0.4\n33,0.2\n"
    yield Base("amplitudes of a ship test", {"a.csv": steady}, "a.csv")


def _tests() -> Iterator[Base]:
    laws = (
        wr.BoucWen.from_normalised(z_max=700.0, x_y=1.5e-3, sigma=0.7, n=1.4, k=6e4),
        wr.AsymmetricBoucWen(alpha=2.0e5, beta=0.4, gamma=0.0, n=2.0, k1=1.5e5, k2=0.0, k3=1.2e7, b=2.718281828, c=4.0),
    )
    for name, law, sizes, rate, noise in (
        ("servo-hydraulic rig", laws[0], (1e-3, 3e-3, 9e-3), 1.0, 2e-3),
        ("quasi-static press", laws[1], (2e-3, 8e-3, 18e-3), 0.05, 1e-3),
    ):
        phase = np.arange(1, 4 * 160 + 1) / 160
        deflection = np.concatenate([[0.0], *(size * np.sin(2.0 * np.pi * phase) for size in sizes)])
        time = np.arange(deflection.size) / (160.0 * rate)
        force = law.trace(deflection).force
        force = force + noise * 0.5 * np.ptp(force) * _noise(force.size, 6)
        columns = {"s": (time, "time"), "mm": (1e3 * deflection, "deflection"), "kN": (1e-3 * force, "force")}
        rows = _rows(time, 1e3 * deflection, 1e-3 * force, digits=8)
        yield Base(name, {"t.csv": text(["time [s],deflection [mm],force [kN]"], rows)}, "t.csv")
        turned = [[row[0], row[2], row[1]] for row in rows]
        lines = ["Time;Load;Actuator displacement", "s;kN;mm"]
        yield Base(f"{name}, units below", {"t.csv": text(lines, turned, between=";", comma=True)}, "t.csv")
        titles = [f"{word}_{unit}" for unit, (_, word) in columns.items()]
        named = {title: values for title, (values, _) in zip(titles, columns.values(), strict=True)}
        yield Base(f"{name}, MATLAB", {"t.mat": matrices(**named)}, "t.mat")


def _four(isolator: str, x: float, y: float, z: float, *, unit: str = "mm", between: str = ",") -> str:
    feet = [
        (f"m{n}", f"{sx * x:g}", f"{sy * y:g}", f"{z:g}", isolator)
        for n, (sx, sy) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1)), start=1)
    ]
    lines = [
        between.join(("name", *(f"{axis} [{unit}]" for axis in "xyz"), "isolator")),
        *(between.join(foot) for foot in feet),
    ]
    return "\n".join(lines) + "\n"


def _tables() -> Iterator[Base]:
    boxes = "name;mass [kg];x [mm];y [mm];z [mm];size_x [mm];size_y [mm];size_z [mm]\n"
    heavy = (
        boxes
        + "generator;14000;-900;0;1400;3200;1800;2000\n"
        + "engine;5000;2300;0;1300;1600;1500;1800\nframe;1500;300;0;300;6000;1900;400\n"
    )
    rows = [(n, x, side) for n, x in enumerate(range(-2750, 3000, 500)) for side in (-900, 900)]
    feet = "name;x [mm];y [mm];z [mm];isolator\n" + "".join(f"m{n}_{side};{x};{side};54;WR28-400\n" for n, x, side in rows)
    yield Base("machine of 20 t", {"mounts.csv": feet, "masses.csv": heavy}, "")
    small = boxes + "board;0,08;0;0;22;90;60;8\nhousing;0,22;5;0;30;100;70;36\n"
    yield Base(
        "electronics of 0.3 kg",
        {"mounts.csv": _four("WR2-800", 45, 30, 5, between=";"), "masses.csv": small.replace(",", ".")},
        "",
    )
    hung = "name,x [mm],y [mm],z [mm],isolator,direction_x,direction_y,direction_z\n" + "".join(
        f"c{n},{x},{y},2400,enidine_wr12_400,0,0,-1\n"
        for n, (x, y) in enumerate(((300, 200), (300, -200), (-300, 200), (-300, -200)))
    )
    lamp = "name,mass [kg],x [mm],y [mm],z [mm],size_x [mm],size_y [mm],size_z [mm]\nfan,130,0,0,2050,700,500,500\n"
    yield Base("fan below a ceiling", {"mounts.csv": hung, "masses.csv": lamp}, "")
    cad = (
        "Part Name,Mass (grams),Center of Mass X (mm),Center of Mass Y (mm),Center of Mass Z (mm),"
        "Lxx (grams*mm^2),Lyy (grams*mm^2),Lzz (grams*mm^2)\n"
    )
    cad += "base,60000,0,0,60,3.1e9,4.2e9,7.0e9\nmotor,90000,-80,0,300,2.4e9,3.5e9,3.4e9\n"
    yield Base("list of a CAD program", {"mounts.csv": _four("enidine_wr12_400", 300, 250, -40), "masses.csv": cad}, "")
    sheet: Cells = [
        ["name", "mass [t]", "x [m]", "y [m]", "z [m]", "size_x [m]", "size_y [m]", "size_z [m]"],
        ["pump", 0.42, 0, 0, 0.5, 0.9, 0.6, 0.8],
    ]
    yield Base(
        "workbook in tonnes and metres",
        {"mounts.csv": _four("enidine_wr16_400", 0.4, 0.25, 0.0445, unit="m"), "masses.xlsx": workbook(sheet)},
        "",
    )
    inches = "name,mass [lb],x [in],y [in],z [in],size_x [in],size_y [in],size_z [in]\nrack,600,0,0,30,24,26,52\n"
    yield Base("pounds and inches", {"mounts.csv": _four("CB1400-15", 10, 11, 1.6, unit="in"), "masses.csv": inches}, "")
    quoted = (
        '"name","mass [kg]","x [mm]","y [mm]","z [mm]","size_x [mm]","size_y [mm]","size_z [mm]"\n'
        '"set, complete","450","0","0","520","900","700","800"\n'
    )
    yield Base("quoted cells", {"mounts.csv": _four("enidine_wr16_400", 380, 280, 44.5), "masses.csv": quoted}, "")
    walls = (
        _four("enidine_wr16_700", 300, 300, 54)
        .replace("isolator", "isolator,direction_x,direction_y,direction_z")
        .replace("_700\n", "_700,0,0,1\n")
    )
    walls += "w1,-250,454,1700,enidine_wr16_700,0,-1,0\nw2,250,454,1700,enidine_wr16_700,0,-1,0\n"
    tall = "name,mass [kg],x [mm],y [mm],z [mm],size_x [mm],size_y [mm],size_z [mm]\ncabinet,420,0,0,900,800,800,1700\n"
    yield Base("cabinet with two at the wall", {"mounts.csv": walls, "masses.csv": tall}, "")


def _devices() -> Iterator[Base]:
    yield Base("data sheet in pounds and inches", {"d.toml": (
        'name = "Sheet"\nsource = "made up"\nheight_in = 3.5\nwidth_in = 4.1\nrope_in = 0.5\nbar_in = 0.77\nloops = '
        '8\nstatic_load_lbf = 645\n'
        "damping_target = 0.12\n[compression]\ntravel_in = 1.7\nvibration_stiffness_lb_per_in = "
        "3500\nshock_stiffness_lb_per_in = 1590\n"
        "[shear]\ntravel_in = 1.78\nvibration_stiffness_lb_per_in = 990\nshock_stiffness_lb_per_in = 985\n"
    )}, "d.toml")  # fmt: skip
    yield Base("rubber mount of one law", {"i.toml": (
        'name = "Rubber"\n[axial]\nlaw = "kelvin-voigt"\nk = 1.2e5\nc = 300.0\n[shear]\nlaw = "kelvin-voigt"\nk = '
        '6e4\nc = 150.0\n'
        '[roll]\nlaw = "kelvin-voigt"\nk = 6e4\nc = 150.0\n[limits]\nstatic_load = 400.0\n'
    )}, "i.toml")  # fmt: skip
    yield Base(
        "levels of an earthquake test", {"l.toml": 'standard = "ours"\n[[motion]]\nsine = "0.2 g 4 Hz 10 s xz"\n'}, "l.toml"
    )
    yield Base("gentle pulse", {"l.toml": 'standard = "ours"\n[[motion]]\nhalf-sine = "0.3 g 20 ms z"\n'}, "l.toml")
    yield Base("fall of an aircraft store", {"l.toml": 'standard = "ours"\n[[motion]]\nsawtooth = "40 g 11 ms -x"\n'}, "l.toml")


FAMILIES: tuple[Callable[[], Iterator[Base]], ...] = (_records, _spectra, _tests, _tables, _devices)


def foreign_inputs() -> list[Base]:
    """Return the inputs, made anew."""
    return [base for family in FAMILIES for base in family()]
