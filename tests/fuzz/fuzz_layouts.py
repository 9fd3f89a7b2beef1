"""Tables of mounts, masses, stops, points and forces, of which `wirerope new` makes a model."""

import numpy as np
from campaign import Case
from hostile import pick
from tables import DAMAGE, Table, damaged_bytes

import wirerope_mj as wr
from wirerope_mj.runs.new_model import new_model

NUMBERS = (
    "nan",
    "inf",
    "1e400",
    "-1e308",
    "1e308",
    "1e-308",
    "0",
    "-0",
    "-1",
    "1e30",
    "9" * 40,
    "1,5",
    "\u0665",
    "",
    "x",
    "1e9",
    "1e6",
)
TEXTS = (
    "",
    "m1",
    "x" * 300,
    "a b",
    "a/b",
    "mount/m1",
    "\u00fc",
    "\x1b[1m",
    "../x",
    "nan",
    "#1",
    "enidine_wr16_400",
    "none",
    "m1-",
    "<a>",
)
NAMES = tuple(f"m{i}" for i in range(1, 5))
PLACES = (("0", "0"), ("0", "400"), ("500", "0"), ("500", "400"))
POSITION = ["x [mm]", "y [mm]", "z [mm]"]
LAYOUT = {
    "mounts": (
        ["name", *POSITION, "isolator"],
        [[name, x, y, "0", "enidine_wr16_400"] for name, (x, y) in zip(NAMES, PLACES, strict=True)],
    ),
    "masses": (
        ["name", "mass [kg]", *POSITION, "size_x [mm]", "size_y [mm]", "size_z [mm]"],
        [
            ["engine", "700", "250", "200", "300", "500", "400", "300"],
            ["tank", "50", "250", "200", "500", "100", "100", "100"],
        ],
    ),
    "stops": (
        ["name", *POSITION, "gap [mm]", "stiffness [MN/m]", "damping [kN s/m]"],
        [["s1", "250", "200", "0", "12", "5", "1"]],
    ),
    "points": (["name", *POSITION], [["top", "250", "200", "650"]]),
    "forces": (["name", *POSITION], [["crank", "250", "200", "300"]]),
}


def mutate(rng: np.random.Generator, folder) -> Case:
    """Write the tables, one of them damaged or with strange cells."""
    which, done = pick(rng, list(LAYOUT)), ""
    paths = {}
    for kind, (header, rows) in LAYOUT.items():
        table = Table(list(header), [list(row) for row in rows])
        content = None
        if kind == which:
            how = rng.random()
            if how < 0.5:
                for _ in range(pick(rng, (1, 1, 2))):
                    row, column = pick(rng, table.rows), int(rng.integers(len(header)))
                    row[column] = pick(rng, TEXTS if "[" not in header[column] else NUMBERS)
                    done = f"{header[column]} = {row[column]!r:.30}"
            elif how < 0.9:
                change = pick(rng, DAMAGE)
                done = change.__name__
                change(table, rng)
            else:
                done, content = damaged_bytes(table.content(), rng)
        paths[kind] = folder / f"{kind}.csv"
        paths[kind].write_bytes(table.content() if content is None else content)
    # A number whose decimal comma is changed, or a cell that stands twice, may be right still: the system is looked at.
    return Case(f"{which}: {done}", {"paths": paths}, (f"{which}.csv", *NAMES, "mass", "model"), None)


def use(case: Case) -> str | None:
    """Read the tables, make and load the model, and settle it."""
    folder = case.inputs["paths"]["mounts"].with_name("made")
    layout = new_model(folder, case.inputs["paths"], formats=())
    system = wr.load_system(folder / "made.xml")
    if set(system.mounts) < {mount.name for mount in layout.mounts}:
        return "a mount is lost"
    masses = {mass.name for mass in layout.masses}
    if len(layout.mounts) + len(masses) == 0 or not np.isfinite(system.model.body_mass).all():
        return "a mass is not finite"
    rest = wr.equilibrium(system)
    return None if np.isfinite(rest.state.values).all() else "the equilibrium is not finite"
