"""Inputs without a slip that look like one: layouts, masses, records and files that are rare and right."""

from collections.abc import Iterator

import numpy as np

from tests.slips.foreign_inputs import half_sine, text
from tests.slips.planting import Base
from wirerope_mj.foundation.arrays import Array

_MOUNTS = "name,x [mm],y [mm],z [mm],isolator\n"
_MASSES = "name,mass [kg],x [mm],y [mm],z [mm],size_x [mm],size_y [mm],size_z [mm]\n"
_POINTS = "name,x [mm],y [mm],z [mm]\n"


def _folder(name: str, isolator: str, places: list[tuple[float, float, float]], masses: str, points: str = "") -> Base:
    rows = "".join(f"m{n},{x:g},{y:g},{z:g},{isolator}\n" for n, (x, y, z) in enumerate(places, start=1))
    files = {"mounts.csv": _MOUNTS + rows, "masses.csv": _MASSES + masses}
    return Base(name, files | ({"points.csv": _POINTS + points} if points else {}))


def _corners(x: float, y: float, z: float) -> list[tuple[float, float, float]]:
    return [(a, b, z) for a in (-x, x) for b in (-y, y)]


def _layouts() -> Iterator[Base]:
    yield _folder(
        "a frame like an L, its sixth corner empty", "enidine_wr16_400",
        [*_corners(800, 300, 45)[:3], (0, -300, 45), (0, 300, 45)],
        "boiler,620,-420,0,600,700,640,1000\ntank,230,450,-180,400,600,300,500\n",
    )  # fmt: skip
    yield _folder(
        "a tripod", "enidine_wr12_400", [(260, 0, 38), (-130, 225, 38), (-130, -225, 38)], "drum,190,0,0,420,500,500,700\n"
    )
    yield _folder(
        "a fifth mount below the motor", "enidine_wr12_400", [*_corners(500, 260, 38), (-250, 0, 38)],
        "motor,240,-260,0,340,450,320,320\npump,90,380,0,300,300,300,380\nskid,60,0,0,110,1150,680,60\n",
    )  # fmt: skip
    yield _folder(
        "an origin at the centre of mass", "enidine_wr12_400", _corners(200, 150, -110),
        "unit,200,0.4,-0.3,0.2,450,350,150\nlid,60,-1.2,0.8,-0.4,450,350,20\n", "centre,0,0,0\ncorner,220,170,70\n",
    )  # fmt: skip
    yield _folder(
        "a hood of foam, and bolts of steel", "enidine_wr12_400", _corners(400, 300, 38),
        "compressor,300,0,0,350,600,400,450\nhood,11,0,0,500,1000,800,900\nbolt,0.35,380,280,60,30,30,80\n",
    )  # fmt: skip
    yield _folder(
        "a mast three times as high as its feet are apart", "enidine_wr16_700", _corners(300, 300, 54),
        "shelter,480,0,0,700,900,900,1200\nmast,9,0,0,2300,60,60,2000\n", "tip,0,0,3300\n",
    )  # fmt: skip
    yield _folder(
        "a flywheel of lead", "enidine_wr16_400", _corners(300, 200, 45),
        "lead,480,-60,0,170,350,350,345\ntable,120,0,0,100,900,600,30\noptics,35,120,20,300,500,400,250\n",
    )  # fmt: skip


def _record(name: str, head: str, *columns: Array, above: str = "") -> Base:
    rows = [[f"{value:.6g}" for value in row] for row in np.column_stack(columns)]
    return Base(name, {"r.csv": text([*([above] if above else []), head], rows)}, "r.csv")


def _records() -> Iterator[Base]:
    time, a = half_sine(10_000.0, 0.4, peak=20.0, lasts=0.011, at=0.1)
    yield _record(
        "decimated, which its head says", "time [s],z [g]", time, a, above="# sample rate 50000 Hz, decimated to 10000 Hz"
    )
    yield _record("a rate in kHz", "time [s],z [g]", time, a, above="# fs = 10 kHz, range 50 g")
    steady = np.arange(0.0, 20.0, 0.002)
    ends = np.minimum(1.0, steady / 2.0) * np.minimum(1.0, (20.0 - steady) / 2.0)
    yield _record("a steady sine", "time [s],z [m/s^2]", steady, 3.0 * np.sin(2.0 * np.pi * 25.0 * steady) * ends)
    random = np.random.default_rng(4).standard_normal(steady.size)
    made = ends * (np.convolve(random, np.ones(12) / 12.0, "same") - random.mean())
    yield _record("one course along 30 degrees", "time [s],x [g],y [g]", steady, np.cos(np.pi / 6) * made, 0.5 * made)
    noisy, _ = half_sine(100_000.0, 0.05, peak=900.0, lasts=0.0005, at=0.01)
    ring = (
        36.0
        * np.exp(-np.maximum(noisy - 0.0105, 0.0) / 0.02)
        * np.sin(2.0 * np.pi * 380.0 * (noisy - 0.0105))
        * (noisy > 0.0105)
    )
    blast = 900.0 * np.sin(np.pi * (noisy - 0.01) / 0.0005) * ((noisy >= 0.01) & (noisy < 0.0105)) + ring
    blast += 0.8 * np.random.default_rng(31).standard_normal(noisy.size)
    yield _record("a blast that rings about its zero", "time [s],z [m/s^2]", noisy, 9.80665 * blast)


def _tables() -> Iterator[Base]:
    rows = "20,0.0032\n80,0.05\n500,0.05\n2000,0.0032\n"
    yield Base("its own rms above a density", {"p.csv": f"# 6.1 g rms\nfrequency [Hz],psd [g^2/Hz]\n{rows}"}, "p.csv")
    yield Base("a density that rises", {"p.csv": "frequency [Hz],psd [g^2/Hz]\n10,0.0005\n100,0.005\n1000,0.02\n"}, "p.csv")
    yield Base(
        "ship's amplitudes", {"a.csv": "from [Hz],to [Hz],displacement [mm]\n4,15,0.762\n16,25,0.508\n26,33,0.254\n"}, "a.csv"
    )


def _jobs() -> Iterator[Base]:
    def case(name: str, *lines: str) -> str:
        return "\n".join(["[[case]]", f'name = "{name}"', *lines, ""])

    pulse = 'half-sine = "15 g 11 ms {} at 50 ms"'.format
    cases = (
        case("vertical", pulse("z")), case("athwartships", pulse("y")),
        case("vertical, after vibration", pulse("z"), 'initial = "relaxed"'),
        case("vertical and athwartships", 'half-sine = ["15 g 11 ms y at 50 ms", "15 g 11 ms z at 50 ms"]'),
        case("late", 'half-sine = "8 g 20 ms z at 2 s"', "duration = 4.0"), case("heave", 'sine = "0.05 g 0.3 Hz 20 s z"'),
    )  # fmt: skip
    words = 'name = "Job"\nmodel = "cabinet"\n\n' + "\n".join(cases)
    yield Base("load cases alike", {"job.toml": words}, "job.toml")


def unusual_inputs() -> list[Base]:
    """Return inputs that are right and rare."""
    return [*_layouts(), *_records(), *_tables(), *_jobs()]
