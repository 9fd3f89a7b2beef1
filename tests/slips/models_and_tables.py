"""Slips in models, in tables of mounts, masses, stops and points, and in isolator files, with what names each."""

import re
from collections.abc import Callable, Mapping

import numpy as np

from tests.slips.planting import Slip
from tests.slips.right_inputs import (
    BUMPS,
    COMPRESSOR,
    CONSOLE,
    IDENTIFIED,
    ISOLATORS,
    MODELS,
    MOMENTS,
    PUMP,
    RACK,
    RADIO,
    SERIES,
    TABLES,
    WEIGHED,
)

Edit = Callable[[str], str]
Change = Callable[[float], float]
MOUNTS, MASSES, STOPS, POINTS = "mounts.csv", "masses.csv", "stops.csv", "points.csv"


def times(factor: float) -> Change:
    return lambda value: factor * value


def put(pattern: str, by: str, *, first: int = 0) -> Edit:
    """Replace every match of a pattern, or the first ones."""
    return lambda text: re.sub(pattern, by, text, count=first, flags=re.MULTILINE)


def swap(names: Mapping[str, str]) -> Edit:
    """Write other names in place of some."""
    return lambda text: re.sub("|".join(map(re.escape, names)), lambda match: names[match[0]], text)


def each(pattern: str, change: Change, *, at: slice = slice(None)) -> Edit:
    """Change the numbers, or those at some places, that stand in the first group of every match of a pattern."""

    def edit(match: re.Match[str]) -> str:
        cells = match[1].split()
        cells[at] = [f"{change(float(cell)):.10g}" for cell in cells[at]]
        return f"{match[0][: match.start(1) - match.start()]}{' '.join(cells)}{match[0][match.end(1) - match.start() :]}"

    return lambda text: re.sub(pattern, edit, text, flags=re.MULTILINE)


def then(*edits: Edit) -> Edit:
    """Make several edits one after the other."""

    def edit(text: str) -> str:
        for one in edits:
            text = one(text)
        return text

    return edit


def _cells(text: str) -> tuple[list[str], list[str], list[list[str]]]:
    """Return the comments of a table, its header and its rows."""
    lines = text.splitlines()
    comments = [line for line in lines if line.startswith("#")]
    head, *rows = [[cell.strip() for cell in line.split(",")] for line in lines if not line.startswith("#")]
    return comments, head, rows


def _table(comments: list[str], head: list[str], rows: list[list[str]]) -> str:
    return "\n".join([*comments, *(",".join(cells) for cells in (head, *rows))]) + "\n"


def columns(names: str, change: Change) -> Edit:
    """Change the numbers in the columns of these names, where a table has them."""

    def edit(text: str) -> str:
        comments, head, rows = _cells(text)
        chosen = [number for number, title in enumerate(head) if title.split(" ")[0] in names.split()]
        made = [[f"{change(float(cell)):.10g}" if n in chosen and cell else cell for n, cell in enumerate(row)] for row in rows]
        return _table(comments, head, made)

    return edit


def added(title: str, cell: str) -> Edit:
    """Add a column with one cell for all rows."""

    def edit(text: str) -> str:
        comments, head, rows = _cells(text)
        return _table(comments, [*head, title], [[*row, cell] for row in rows])

    return edit


def titled(name: str, unit: str) -> Edit:
    """Write another unit into the header of a column."""
    return put(rf"\b{name} \[[^\]]*\]", f"{name} [{unit}]" if unit else name)


def last_row(change: Callable[[list[str]], list[str]]) -> Edit:
    """Add a row that is made of the last one."""

    def edit(text: str) -> str:
        comments, head, rows = _cells(text)
        return _table(comments, head, [*rows, change(rows[-1])])

    return edit


def exchanged(one: str, other: str) -> Edit:
    """Exchange the titles of two columns, and with them what the numbers below mean."""
    return swap({f"{one} [": f"{other} [", f"{other} [": f"{one} ["})


def about_origin(text: str) -> str:
    """Write the moments of every part about the origin of the table."""
    comments, head, rows = _cells(text)
    at = {title.split(" ")[0]: number for number, title in enumerate(head)}
    factor = 1e-3 if "[mm]" in head[at["x"]] else 1.0
    for row in rows:
        mass, d = float(row[at["mass"]]), factor * np.array([float(row[at[axis]]) for axis in "xyz"])
        moved = mass * (d @ d * np.eye(3) - np.outer(d, d))
        for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
            if (name := f"i{'xyz'[i]}{'xyz'[j]}") in at:
                row[at[name]] = f"{float(row[at[name]] or 0.0) + moved[i, j]:.6g}"
    return _table(comments, head, rows)


def about_body(text: str) -> str:
    """Write the inertia of an <inertial> about the origin of its body."""

    def edit(match: re.Match[str]) -> str:
        d, mass, i = np.array(match[1].split(), float), float(match[2]), np.array(match[3].split(), float)
        moved = mass * (d @ d * np.eye(3) - np.outer(d, d))
        numbers = i + [moved[0, 0], moved[1, 1], moved[2, 2], moved[0, 1], moved[0, 2], moved[1, 2]]
        return f'pos="{match[1]}" mass="{match[2]}" fullinertia="{" ".join(f"{x:.6g}" for x in numbers)}"'

    return re.sub(r'pos="([^"]*)" mass="([^"]*)" fullinertia="([^"]*)"', edit, text)


def row_wise(text: str) -> str:
    """Write the inertia of an <inertial> in the order xx xy xz yy yz zz."""
    order = (0, 3, 4, 1, 5, 2)
    return re.sub(r'fullinertia="([^"]*)"', lambda m: f'fullinertia="{" ".join(m[1].split()[k] for k in order)}"', text)


CENTRE, TENSOR = r'<inertial pos="([^"]*)"', r'fullinertia="([^"]*)"'
SITE = r'<site name="(?:[\w]+/(?:m|s|b|lower|upper)\d+)"(?: class="mount_site")? pos="([^"]*)"'  # a mount's on either side
TURNED = r'(<site name="\w+/m\d" pos="[^"]*")'  # of models without turned sites
HEAVY = r'\bmass="([\d.]+)"'
LINEAR = r"^(?:alpha|k|k1|k2|k3) = (\S+)$"
LIGHTER = {"enidine_wr16_400": "WR8-900", "enidine_wr12_400": "WR6-950", "WR8-400": "WR5-900"}
STRONGER = {"enidine_wr12_400": "CB1700-20", "WR8-400": "CB1500-15"}


def gravity(written: str) -> Edit:
    return put(r'<option gravity="[^"]*"', f'<option gravity="{written}"')


def heights(payload: str, deck: str) -> Edit:
    """Write other heights of both sites of all mounts."""
    return then(put(r'(<site name="(?!deck)\w+/m\d" pos="\S+ \S+) [^"]*"', rf'\1 {payload}"'),
                put(r'(<site name="deck/m\d" pos="\S+ \S+) [^"]*"', rf'\1 {deck}"'))  # fmt: skip


def _gap(text: str) -> str:
    """Return the height at which the payload stands above the deck."""
    found = re.search(r'pos="0 0 (\S+)">\s*<freejoint', text)
    assert found is not None
    return found[1]


OF_MODELS = [
    Slip("gravity 0 0 0", MODELS, gravity("0 0 0"), r"there is no gravity"),
    Slip("gravity upwards", MODELS, gravity("0 0 9.80665"), r"gravity points upwards"),
    Slip("gravity along y", MODELS, gravity("0 -9.80665 0"), r"gravity points sideways"),
    Slip("gravity in mm/s^2", MODELS, gravity("0 0 -9806.65"), r"in mm/s\^2"),
    Slip("gravity in g", MODELS, gravity("0 0 -1"), r"0\.102 times the earth's"),
    Slip("masses in t", MODELS, each(HEAVY, times(1e-3)), r"is its mass in t\b"),
    Slip("masses in g", MODELS, each(HEAVY, times(1e3)), r"is its mass in g\b"),
    Slip("weights in N for masses", MODELS, each(HEAVY, times(9.80665)), r"is its mass in .*\bN\b"),
    Slip("masses in lb", MODELS, each(HEAVY, times(2.20462)), r"in lb", untold="a machine twice as heavy on the same mounts"),
    Slip("all lengths in mm", MODELS, each(r'\b(?:pos|size)="([^"]*)"', times(1e3)), r"positions and sizes of the model in mm"),
    Slip("sites of mounts in mm", MODELS, each(SITE, times(1e3)), r"in mm\?"),
    Slip("a point in mm", MODELS, each(r'<site name="point/\w+"[^>]* pos="([^"]*)"', times(1e3)), r"point .*in mm\?"),
    Slip("centre of mass in mm", WEIGHED, each(CENTRE, times(1e3)), r"`pos` of its <inertial>.*in mm"),
    Slip("height of the centre of mass with the wrong sign", WEIGHED, each(CENTRE, times(-1.0), at=slice(2, 3)),
         r"centre of mass .* outside what is drawn .* sign"),
    Slip("centre of mass left at the origin", WEIGHED, put(r'<inertial pos="[^"]*"', '<inertial pos="0 0 0"'),
         r"centre of mass .* at the origin of its body"),
    Slip("centre of mass from a corner of the machine", WEIGHED, each(CENTRE, lambda x: x + 1.2, at=slice(0, 2)),
         r"centre of mass .* outside"),
    Slip("inertia about the body's origin", WEIGHED, about_body, r"they are about the body's origin"),
    Slip("inertia in kg mm^2", WEIGHED, each(TENSOR, times(1e6)), r"inertia of its <inertial> in kg mm\^2"),
    Slip("inertia in t m^2 of a mass in g", WEIGHED, each(TENSOR, times(1e-6)), r"denser than any material"),
    Slip("inertia row by row", WEIGHED, row_wise, r"fullinertia.*xx yy zz xy xz yz"),
    Slip("a moment with a digit too many", WEIGHED, each(TENSOR, times(10.0), at=slice(2, 3)), r"inertia must satisfy A \+ B"),
    Slip("products of inertia with the other sign", WEIGHED, each(TENSOR, times(-1.0), at=slice(3, 6)), r"product",
         untold="the machine's mirror image is as likely a body"),
    Slip("sign of a mount's y forgotten", WEIGHED, put(r'(/m2" pos="\S+) -', r"\1 "), r"stand at one place"),
    Slip("sites at the payload's bottom", WEIGHED, lambda text: heights("0", _gap(text))(text),
         r"belong at the isolator's mid-height"),
    Slip("sites on the deck", WEIGHED, lambda text: heights(f"-{_gap(text)}", "0")(text),
         r"belong at the isolator's mid-height"),
    Slip("sites on both sides of the gap", WEIGHED, heights("0", "0"), r"both must lie at .* mid-height"),
    Slip("isolators upside down", WEIGHED, put(TURNED, r'\1 euler="180 0 0"'), r"leads away from the payload's centre of mass"),
    Slip("isolators on their side", WEIGHED, put(TURNED, r'\1 euler="0 90 0"'), r"on their side"),
    Slip("angles in radians", WEIGHED, put(TURNED, r'\1 euler="0 0 1.5708"'), r"looks like radians"),
    Slip("angles in degrees where radians are said", WEIGHED,
         then(put(TURNED, r'\1 euler="0 0 90"'), put("<worldbody>", '<compiler angle="radian"/><worldbody>')),
         r"looks like degrees"),
    Slip("payload without a joint", WEIGHED, put(r"\s*<freejoint[^>]*>", ""), r"give its body a joint"),
    Slip("sites of a mount in the wrong order", WEIGHED,
         put(r'(name="mount/m3">\s*)(<element[^>]*>)(\s*)(<element[^>]*>)', r"\1\4\3\2"), r"Swap its two sites"),
    Slip("a mount's name twice", WEIGHED, put(r"mount/m3", "mount/m2"), r"repeated name"),
    Slip("an isolator that is not there", WEIGHED, put(r'data="isolators/[^"]*"', 'data="isolators/wr99.toml"'),
         r"there is no isolator"),
    Slip("isolators over-rated by ten", (CONSOLE, RADIO, RACK), swap(STRONGER), r"rated for together: .*isolators others",
         untold="mounts picked for a shock carry a fortieth of their rating"),
    Slip("isolators under-rated by ten", (CONSOLE, COMPRESSOR, PUMP), swap(LIGHTER), r"rated for together: .*isolators others"),
]  # fmt: skip

UPRIGHT = (RACK, PUMP, MOMENTS[2])


def leaning(unit: str, value: float) -> Edit:
    """Write an inclination of all mounts in this unit, in place of the one that they have."""
    return lambda text: (
        then(columns("inclination", lambda _: value), titled("inclination", unit)) if "inclination" in text
        else added(f"inclination [{unit}]", f"{value:g}")
    )(text)  # fmt: skip


DOWN = then(added("direction_x", "0"), added("direction_y", "0"), added("direction_z", "-1"))
PARTS = "ixx iyy izz ixy ixz iyz"
OF_TABLES = [
    Slip("masses in t where kg is said", TABLES, columns("mass", times(1e-3)), r"is its mass in t\b", MASSES),
    Slip("masses in g where kg is said", TABLES, columns("mass", times(1e3)), r"in g\b|denser than any material", MASSES),
    Slip("weights in N for masses in a table", TABLES, columns("mass", times(9.80665)), r"is its mass in .*\bN\b", MASSES),
    Slip("a unit of force for masses", TABLES, titled("mass", "N"), r"mass.*unit", MASSES),
    Slip("no unit", TABLES, titled("x", ""), r'column "x".*unit', MOUNTS),
    Slip("mounts in mm where m is said", TABLES, columns("x y z", times(1e3)), r"Check columns .* units", MOUNTS),
    Slip("mounts in m where mm is said", TABLES, columns("x y z", times(1e-3)), r"in m where|overlap", MOUNTS),
    Slip("mounts in inches where mm or m is said", TABLES, columns("x y z", times(1 / 25.4)), r"overlap", MOUNTS),
    Slip("y up, mounts", TABLES, exchanged("y", "z"), r"y and z swapped|lies outside the area", MOUNTS),
    Slip("z downwards", TABLES, columns("z", times(-1.0)), r"z measured downwards", MASSES),
    Slip("heights of masses 0", TABLES, columns("z", times(0.0)), r"height left out", MASSES),
    Slip("masses from another origin", TABLES, columns("x", lambda x: x + (2.0 if abs(x) < 2.0 else 2000.0)),
         r"lies outside the area between its mounts", MASSES),
    Slip("points in other units", TABLES, columns("x y z", times(1e3)), r'stands outside.*units', POINTS),
    Slip("moments about the origin", MOMENTS, about_origin, r"are they about the origin\?", MASSES),
    Slip("moments in kg mm^2 where kg m^2 is said", MOMENTS, columns(PARTS, times(1e6)), r"radius of gyration of .* in mm",
         MASSES),
    Slip("moments in t m^2 of masses in g", MOMENTS, columns(PARTS, times(1e-6)), r"denser than any material", MASSES),
    Slip("a moment with a digit too many, table", MOMENTS, columns("izz", times(10.0)), r"larger than the sum of the other",
         MASSES),
    Slip("a mount twice", TABLES, last_row(lambda row: row), r'the name ".*" is given twice', MOUNTS),
    Slip("a mount where another stands", TABLES, last_row(lambda row: ["another", *row[1:]]), r"stands where", MOUNTS),
    Slip("a mass twice", TABLES, last_row(lambda row: row), r"is given twice", MASSES),
    Slip("a mass twice under another name", TABLES, last_row(lambda row: ["copy", *row[1:]]), r"if it is the same part",
         MASSES),
    Slip("a quantity beside one place", TABLES, added("quantity", "2"), r"is there 2 times", MASSES),
    Slip("all mounts in one line", TABLES, columns("y", times(0.0)), r"in line|rotation about x|stands where", MOUNTS),
    Slip("mounts upside down", UPRIGHT, DOWN, r"sites swapped", MOUNTS),
    Slip("mounts on their side", UPRIGHT, added("inclination [deg]", "90"), r"sites swapped", MOUNTS),
    Slip("inclination in radians", TABLES, leaning("deg", 0.523599), r"look like radians", MOUNTS),
    Slip("inclination in degrees where radians are said", TABLES, leaning("rad", 30), r"between 0 and 180", MOUNTS),
    Slip("an isolator's name misspelt", TABLES, put("enidine_wr1", "enidine_rw1", first=1), r"Nearest: .*enidine_wr1", MOUNTS),
    Slip("brackets in N/mm where N/m is said", TABLES, added("bracket_axial [N/m]", "20000"), r"\[bracket\].*N/mm", MOUNTS),
    Slip("a gap in m where mm is said", TABLES, columns("gap", times(1e-3)), r"gap of .* other units", STOPS),
    Slip("a gap in mm where m is said", TABLES, columns("gap", times(1e3)),
         r"in metres.*millimetres", STOPS),
    Slip("a negative gap", TABLES, columns("gap", times(-1.0)), r'"gap" must be >= 0', STOPS),
    Slip("a payload that rests on its stops", TABLES, columns("gap", times(0.02)), r"give them a larger gap", STOPS),
    Slip("a stop's stiffness in N/mm where N/m is said", TABLES, columns("stiffness", times(1e-3)),
         r'"stiffness" in other units', STOPS),
    Slip("a stop's direction turned round", TABLES, DOWN, r"direction", STOPS,
         untold="stops below a flange that catch what lifts off point down as well"),
]  # fmt: skip

OF_ISOLATORS = [
    Slip("stiffnesses in N/mm", ISOLATORS, each(LINEAR, times(1e-3)), r"not in N/mm"),
    Slip("stiffnesses in lb/in", ISOLATORS, each(LINEAR, times(1 / 175.127)), r"not in N/mm"),
    Slip("stiffnesses in N/mm on one axis", ISOLATORS, lambda text: re.sub(
        r"(?s)(\[+axial.*?)(?=\n\[(?!\[axial))", lambda m: each(LINEAR, times(1e-3))(m[1]), text, count=1),
        r"times as stiff as \[axial\]|not in N/mm"),
    Slip("static load in kg", ISOLATORS, each(r"^static_load = (\S+)", times(1 / 9.80665)), r"is `static_load` in kg"),
    Slip("static load in lbf", ISOLATORS, each(r"^static_load = (\S+)", times(1 / 4.448)), r"is `static_load` in .*lbf"),
    Slip("static load in kN", ISOLATORS, each(r"^static_load = (\S+)", times(1e-3)), r"is `static_load` in kN"),
    Slip("static load ten times too large", ISOLATORS, each(r"^static_load = (\S+)", times(10.0)), r"is it that of this part"),
    Slip("static load ten times too small", ISOLATORS, each(r"^static_load = (\S+)", times(0.1)), r"is it that of this part"),
    Slip("travel in mm", ISOLATORS, each(r"compression = ([\d.]+)(?=\n|,)", times(1e3)), r"compression.* 2\b|in metres"),
    Slip("travel in inches", ISOLATORS, each(r"compression = ([\d.]+)(?=\n|,)", times(1 / 0.0254)), r"both must be in metres"),
    Slip("compression negative", ISOLATORS, each(r"compression = ([\d.]+)(?=\n|,)", times(-1.0)),
         r"`compression` must be a finite number > 0"),
    Slip("height in mm", ISOLATORS, each(r"^height = (\S+)", times(1e3)), r"`height` must be"),
    Slip("height in inches", ISOLATORS, each(r"^height = (\S+)", times(1 / 0.0254)), r"`height` must be"),
    Slip("alpha as a ratio of stiffnesses", ISOLATORS, put(r"^alpha = \S+", "alpha = 0.3"), r"not the ratio of stiffnesses"),
    Slip("alpha as the whole stiffness beside k1", IDENTIFIED, each(r"^alpha = (\S+)", times(1.65)), r"alpha",
         untold="an isolator 1.4 times as stiff in small cycles"),
    Slip("beta with the wrong sign", ISOLATORS, each(r"^beta = (\S+)", times(-1.0)), r"`beta`"),
    Slip("gamma with the wrong sign", IDENTIFIED, each(r"^gamma = (\S+)", times(-1.0)), r"gamma",
         untold="another shape of loop"),
    Slip("n = 1 with the beta of n = 2", ISOLATORS, put(r"^n = 2.0", "n = 1.0"), r"change with `n`"),
    Slip("roll and shear swapped", SERIES, swap({"[roll": "[shear", "[shear": "[roll"}), r"roll",
         untold="which of the two is stiffer differs from maker to maker"),
    Slip("compression and tension swapped", ISOLATORS, put(r"^c = ", "c = -"), r"Deflection is positive in tension"),
    Slip("kind of provenance of one's own", ISOLATORS, put(r'^kind = "\w+"', 'kind = "measured"'), r"one of .*identified"),
    Slip("law misspelt", ISOLATORS, put(r"asymmetric-bouc-wen", "bouc-wen-asymmetric"), r"the laws are"),
    Slip("key misspelt", ISOLATORS, put(r"^k1 = ", "k_1 = "), r"k_1"),
    Slip("gap of a stop in mm", BUMPS, each(r"^gap_below = (\S+)", times(1e3)), r"If these are millimetres"),
    Slip("rounding of a stop in mm", BUMPS, each(r"^rounding = (\S+)", times(1e3)), r"`rounding` .* in mm"),
]  # fmt: skip

SLIPS = [*OF_MODELS, *OF_TABLES, *OF_ISOLATORS]
