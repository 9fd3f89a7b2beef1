"""Commands and blocks of the pages run as they stand, each page in a folder with the files that it names.

A block that is not run has a comment on the page before it that says why: `<!-- not run: REASON -->`.
"""

import os
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.mounts.laws import Parallel, Stop

ROOT = Path(__file__).parents[2]
DURABILITY, LAWS = ROOT / "docs" / "durability.md", ROOT / "docs" / "laws.md"
PAGES = sorted([*(ROOT / "docs").glob("*.md"), ROOT / "models" / "README.md"])
BLOCK = re.compile(r"(<!-- not run: ([^>]+) -->\s*)?```(\w+)\n(.*?)```", flags=re.DOTALL)
LISTS = (["study", "floating_floor_shock"], ["study", "runs/shock"])  # nothing varies yet: an error that lists what can
WRITTEN = {"commands.md", "changelog.md"}  # by the program, and a history
LAW = wr.AsymmetricBoucWen.from_normalised(z_max=700.0, x_y=1e-3, sigma=0.6, n=1.0, k1=5e4, k2=1e6, k3=2e8, b=np.e, c=35.0)
SHEAR = wr.SymmetricBoucWen.from_normalised(z_max=500.0, x_y=1.5e-3, sigma=0.9, n=1.0, k1=4e4, k2=0.0, k3=4e8)
SCALES = ((360.0, 6e-3, 3e4), (45.0, 0.4e-3, 0.0))  # z_max, x_y, k of a rope that yields on two scales
STOP = Stop(gap_below=0.01, k=1e6, rounding=1e-3)


def commands_of(page):
    """Return the commands of a page that are to be run, comments and line ends taken off."""
    lines = []
    for _, reason, kind, text in BLOCK.findall(page.read_text(encoding="utf-8")):
        if kind == "bash" and not reason:
            lines += text.replace("\\\n", " ").splitlines()
    return [parts for line in lines if (parts := shlex.split(line, comments=True))]


def shortened(arguments):
    """Return a command with at most 64 variants, two chunks, and the first of several amplitudes: the rest is more of it."""
    kept = []
    for word in arguments:
        if kept[-2:-1] == ["--amplitude-mm"] and word[0].isdigit():
            continue
        kept.append(str(min(int(word), 64)) if kept[-1:] == ["--variants"] else word)
    return kept


def records(*names, law=LAW, amplitudes=(1e-3, 3e-3, 8e-3), **options):
    for seed, name in enumerate(names):
        write_record(Path(name), *rig_record(law, list(amplitudes), seed=seed, points=100.0, **options))


def identification():
    records("test1.csv", "test2.csv", "axial.csv")
    records("shear.csv", "roll.csv", law=SHEAR)
    records("bumper.csv", law=STOP, amplitudes=(0.012, 0.015, 0.018))
    records("bottoming.csv", law=Parallel(laws=(LAW, STOP)), amplitudes=(5e-3, 0.012, 0.015, 0.018))
    two = [wr.BoucWen.from_normalised(z_max=z, x_y=x, sigma=0.6, n=1.6, k=k) for z, x, k in SCALES]
    records("rope.csv", law=Parallel(laws=two), amplitudes=(0.5e-3, 1e-3, 3e-3, 8e-3, 15e-3))
    wr.Isolator(name="known", axial=LAW, provenance=wr.Provenance(kind="illustrative", source="a test")).save("isolator.toml")


def durability():
    for name, motion in (("shock", ["--half-sine", "10 g 11 ms z"]), ("road", ["--sine", "0.3 g 8 Hz 3 s z"])):
        assert main(["shock", "cabinet", *motion, "--out", f"runs/{name}"]) == 0
    (life,) = (text for *_, kind, text in BLOCK.findall(DURABILITY.read_text(encoding="utf-8")) if kind == "toml")
    Path("life.toml").write_text(life, encoding="utf-8")
    assert main(["durability", "life.toml"]) == 0


def run_of_the_cabinet():
    assert main(["shock", "cabinet", "--half-sine", "10 g 11 ms z", "--out", "run"]) == 0


def run_of_a_shock():
    assert main(["shock", "cabinet", "--half-sine", "10 g 11 ms z", "--out", "runs/shock"]) == 0


def deck_record():
    time = np.arange(0.0, 0.5, 1e-3)
    acceleration = 5.0 * np.exp(-20.0 * time) * np.sin(2.0 * np.pi * 30.0 * time)
    rows = "\n".join(f"{t:.4f}, {a:.6f}" for t, a in zip(time, acceleration, strict=True))
    Path("deck.csv").write_text(f"time [s], acceleration [g]\n{rows}\n", encoding="utf-8")


def drop_of_the_shock_table():
    table = wr.load_system("shock_table")
    stiffer = wr.varied(table, isolators={"m1": table.mounts["m1"].written.scaled(1.15)})
    motion = wr.HalfSine(peak=80.0, duration=0.011, direction="z", start=0.02)
    r = wr.simulate(stiffer, motion, duration=0.5, sample_rate=2000.0)
    columns = [r.time, r.base.acceleration[:, 2] / 9.80665, r.bodies["block"].acceleration[:, 2] / 9.80665]
    columns[2] += 0.01 * np.random.default_rng(1).standard_normal(r.time.size)
    np.savetxt("drop.csv", np.column_stack(columns), delimiter=",", header="time [s],A0 [g],A1 [g]", comments="", fmt="%.7g")


def deck_modes():
    """Write the modes of the cabinet's deck as of a simply supported plate of 900 kg, in closed form."""
    system, rows = wr.load_system("cabinet"), []
    x, y, mass, sizes = 0.1, 0.0, 900.0, (2.0, 3.0)  # its middle and its sizes [m]
    numbers = [(i, j) for i in (1, 2) for j in (1, 2, 3)]
    first = 18.0 / (1 / sizes[0] ** 2 + 1 / sizes[1] ** 2)
    lines = ["mode,frequency_Hz,damping,participation_x,participation_y,participation_z"]
    for mode, (i, j) in enumerate(numbers, 1):
        frequency = first * ((i / sizes[0]) ** 2 + (j / sizes[1]) ** 2)
        share = 8.0 * np.sqrt(mass) / (np.pi**2 * i * j) if i % 2 and j % 2 else 0.0
        lines.append(f"{mode},{frequency:.4f},0.03,0,0,{share:.6f}")
    Path("modes.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for name, mount in system.mounts.items():
        u, v = (mount.position[0] - x) / sizes[0] + 0.5, (mount.position[1] - y) / sizes[1] + 0.5
        shapes = [2.0 / np.sqrt(mass) * np.sin(np.pi * i * u) * np.sin(np.pi * j * v) for i, j in numbers]
        rows += [f"{name},{mode},0,0,{shape:.8f}" for mode, shape in enumerate(shapes, 1)]
    Path("shapes.csv").write_text("\n".join(["point,mode,x,y,z", *rows]) + "\n", encoding="utf-8")
    places = [f"{name},{','.join(map(str, mount.position))}" for name, mount in system.mounts.items()]
    Path("points.csv").write_text("\n".join(["point,x,y,z", *places]) + "\n", encoding="utf-8")


def genset():
    assert main(["new", "genset", "--template", "genset"]) == 0
    os.chdir("genset")
    model = Path("genset.xml")
    model.write_text(model.read_text(encoding="utf-8").replace("force/crankshaft", "force/engine"), encoding="utf-8")
    Path("start.csv").write_text("time [s], fz [N], mx [N.m]\n0, 0, 0\n0.1, 500, 20\n0.5, 0, 0\n", encoding="utf-8")


def measured_drop():
    system = wr.load_system("sdof_shaker")
    truth = wr.varied(system, isolators={name: one.isolator.scaled(1.2) for name, one in system.mounts.items()})
    motion = wr.HalfSine(peak=4.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.05)
    test = wr.simulate(truth, motion, duration=0.6, sample_rate=1e4)
    base, top = (a[:, 2] / wr.STANDARD_GRAVITY for a in (test.base.acceleration, test.points["mass_top"].acceleration))
    mount = test.mounts["m1"]
    columns = (test.time + 12.0, base, top, 1e3 * mount.deflection[:, 2], 1e-3 * mount.force[:, 2])
    np.savetxt("drop.csv", np.column_stack(columns), delimiter=",", header="time [s],B,T,D,F", comments="")


PREPARED = {
    "README.md": lambda: os.symlink(ROOT / "models", "models"),
    "calibrate.md": drop_of_the_shock_table,
    "durability.md": durability,
    "exchange.md": run_of_the_cabinet,
    "flexible.md": deck_modes,
    "identification.md": identification,
    "motions.md": genset,
    "overlay.md": measured_drop,
    "shock.md": deck_record,
    "studies.md": run_of_a_shock,
}
"""What a page names as the reader's own."""


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if commands_of(page)], ids=lambda page: page.name)
def test_commands_of_a_page_run(page, tmp_path, monkeypatch, capsys):
    if page.name in WRITTEN | {"first_model.md"}:
        pytest.skip("written by the program, or run by its own test")
    monkeypatch.chdir(tmp_path)
    PREPARED.get(page.name, lambda: None)()
    for *_, text in BLOCK.findall(page.read_text(encoding="utf-8")):
        if named := re.match(r"# (\w+\.(?:py|csv|toml))\n", text):  # a whole file
            Path(named[1]).write_text(text, encoding="utf-8")
    for program, *arguments in commands_of(page):
        assert program == "wirerope", program
        wanted = 2 if arguments in LISTS else 0
        assert main(shortened(arguments)) == wanted, (arguments, capsys.readouterr().err)


def test_every_block_of_a_page_is_run_or_says_why_not():
    known = {
        "bash",
        "python",
        "csv",
        "text",
        "toml",
        "xml",
    }  # the latter are read by the tests of their pages, or are parts
    for page in PAGES:
        for _, reason, kind, _ in BLOCK.findall(page.read_text(encoding="utf-8")):
            assert kind in known or reason, (page.name, kind)


@pytest.mark.parametrize(
    "block", [text for *_, kind, text in BLOCK.findall(LAWS.read_text(encoding="utf-8")) if kind == "toml"]
)
def test_axes_that_a_page_shows_are_those_of_an_isolator(block, tmp_path):
    provenance = '[provenance]\nkind = "illustrative"\nsource = "a page"\n'
    (tmp_path / "shown.toml").write_text(f'name = "shown"\n{block}\n{provenance}', encoding="utf-8")
    assert wr.load_isolator(tmp_path / "shown.toml").axial is not None
