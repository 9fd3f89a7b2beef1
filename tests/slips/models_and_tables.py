"""Slips in models, in tables of mounts, masses, stops and points, and in isolator files, with what names each."""

import re
from collections.abc import Callable

from tests.slips.planting import Base, Slip
from wirerope_mj.foundation.resources import models_folder

_MODELS = models_folder()


def _read(name: str) -> str:
    return (_MODELS / name).read_text(encoding="utf-8")


def shipped(name: str) -> Base:
    """Return a model that ships; its isolators are those of the catalogue."""
    return Base(name.rpartition("/")[2], {"model.xml": _read(name)}, "model.xml")


def skid(
    name: str, *, mass: float, centre: str, inertia: str, half: tuple[float, float, float], isolator: str, height: float
) -> Base:
    """Return a machine with an <inertial>, a box of half these sizes [m], on four upright mounts below its corners."""
    feet = {f"m{n}": (x * half[0], y * half[1]) for n, (x, y) in enumerate(((1, 1), (1, -1), (-1, -1), (-1, 1)), start=1)}
    sites = "\n".join(f'      <site name="{{0}}/{foot}" pos="{x:g} {y:g} {{1}}"/>' for foot, (x, y) in feet.items())
    mounts = "\n".join(
        f'    <tuple name="mount/{foot}">\n      <element objtype="site" objname="{name}/{foot}"/>\n'
        f'      <element objtype="site" objname="deck/{foot}"/>\n      <element objtype="text" objname="isolator/foot"/>\n'
        "    </tuple>" for foot in feet
    )  # fmt: skip
    text = f"""<mujoco model="{name}">
  <option gravity="0 0 -9.80665" integrator="RK4" timestep="0.0005"/>
  <default><geom type="box" contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="deck">
      <joint name="deck_x" type="slide" axis="1 0 0"/>
      <joint name="deck_y" type="slide" axis="0 1 0"/>
      <joint name="deck_z" type="slide" axis="0 0 1"/>
      <geom name="deck_plate" size="1.5 1.5 0.01" pos="0 0 -0.01" mass="1000"/>
{sites.format("deck", f"{0.5 * height:g}")}
    </body>
    <body name="{name}" pos="0 0 {height:g}">
      <freejoint name="{name}"/>
      <inertial pos="{centre}" mass="{mass:g}" {inertia}/>
      <geom name="{name}_box" size="{half[0]:g} {half[1]:g} {half[2]:g}" pos="0 0 {half[2]:g}" mass="0"/>
{sites.format(name, f"{-0.5 * height:g}")}
      <site name="point/top" pos="0 0 {2.0 * half[2]:g}"/>
    </body>
  </worldbody>
  <custom>
    <text name="isolator/foot" data="isolators/{isolator}.toml"/>
{mounts}
  </custom>
</mujoco>
"""
    return Base(name, {"model.xml": text}, "model.xml")


COMPRESSOR = skid(
    "compressor", mass=560, centre="0.04 -0.02 0.36", inertia='diaginertia="48 62 55"', half=(0.55, 0.45, 0.45),
    isolator="enidine_wr16_400", height=0.089,
)  # fmt: skip
CONSOLE = skid(
    "console", mass=210, centre="0.02 0.03 0.42", inertia='fullinertia="21 19 12 0.3 1.1 -0.4"', half=(0.3, 0.35, 0.5),
    isolator="enidine_wr12_400", height=0.076,
)  # fmt: skip
CHILLER = skid(
    "chiller", mass=1100, centre="-0.1 0.05 0.7", inertia='fullinertia="360 480 410 8 -30 12"', half=(1.1, 0.8, 0.8),
    isolator="socitec_cb1400_15", height=0.08255,
)  # fmt: skip
WEIGHED = (COMPRESSOR, CONSOLE, CHILLER)  # with an <inertial>
CABINET, TWO_STAGE = shipped("cabinet.xml"), shipped("templates/two_stage.xml")
MODELS = (CABINET, TWO_STAGE, COMPRESSOR)

GENSET = Base("genset", {file: _read(f"templates/genset/{file}") for file in (
    "mounts.csv", "masses.csv", "stops.csv", "points.csv"
)})  # fmt: skip
RACK = Base("rack", {
    "mounts.csv": "name,x [mm],y [mm],z [mm],isolator\n"
    "front_left,200,250,38,enidine_wr12_400\nfront_right,200,-250,38,enidine_wr12_400\n"
    "rear_left,-200,250,38,enidine_wr12_400\nrear_right,-200,-250,38,enidine_wr12_400\n",
    "masses.csv": "name,mass [kg],x [mm],y [mm],z [mm],size_x [mm],size_y [mm],size_z [mm]\n"
    "frame,70,0,0,676,600,700,1200\nserver,120,20,0,476,500,500,400\nsupply,60,-30,40,226,500,500,200\n",
    "stops.csv": "name,mounts,gap [mm],stiffness [kN/mm],damping [N s/m],acts\nstop,all,30,2,900,up-down\n",
    "points.csv": "name,x [mm],y [mm],z [mm]\ntop,0,0,1276\nscreen,300,0,1100\n",
})  # fmt: skip
PUMP = Base("pump", {
    "mounts.csv": "name,x [m],y [m],z [m],isolator\n"
    "m1,0.5,0.3,0.0445,enidine_wr16_400\nm2,0.5,-0.3,0.0445,enidine_wr16_400\n"
    "m3,-0.5,0.3,0.0445,enidine_wr16_400\nm4,-0.5,-0.3,0.0445,enidine_wr16_400\n",
    "masses.csv": "name,mass [kg],x [m],y [m],z [m],ixx [kg m^2],iyy [kg m^2],izz [kg m^2],ixy [kg m^2],ixz [kg m^2],"
    "iyz [kg m^2]\nmotor,220,-0.35,0,0.38,5.5,9.5,9.5,0,0,0\npump,160,0.35,0.03,0.36,4.2,5.1,5.1,0,0.4,0\n"
    "skid,140,0,0,0.17,6.2,21,26.5,0,0,0\n",
    "stops.csv": "name,x [m],y [m],z [m],gap [m],stiffness [N/m],damping [N s/m]\n"
    "s1,0.4,0.3,0.09,0.035,4e6,9e3\ns2,-0.4,0.3,0.09,0.035,4e6,9e3\n"
    "s3,0.4,-0.3,0.09,0.035,4e6,9e3\ns4,-0.4,-0.3,0.09,0.035,4e6,9e3\n",
    "points.csv": "name,x [m],y [m],z [m]\nflange,0.7,0.0,0.4\n",
})  # fmt: skip
TABLES = (GENSET, RACK, PUMP)

Edit = Callable[[str], str]


def each(pattern: str, change: Callable[[float], float], *, first: int | None = None) -> Edit:
    """Change every number of the first group of a pattern, or those of the first matches, in a model or an isolator file."""

    def edit(match: re.Match[str]) -> str:
        numbers = " ".join(f"{change(float(number)):.10g}" for number in match[1].split())
        return f"{match[0][: match.start(1) - match.start()]}{numbers}{match[0][match.end(1) - match.start() :]}"

    return lambda text: re.sub(pattern, edit, text, count=first or 0)


def put(pattern: str, by: str) -> Edit:
    """Replace every match of a pattern."""
    return lambda text: re.sub(pattern, by, text)


def column(name: str, change: Callable[[float], float], *, rows: slice = slice(None)) -> Edit:
    """Change the numbers below the header of a column that begins with `name`."""

    def edit(text: str) -> str:
        lines = text.splitlines()
        head = next(number for number, line in enumerate(lines) if not line.startswith("#"))
        titles = [title.strip().split(" ")[0] for title in lines[head].split(",")]
        if name in titles:
            for number in range(head + 1, len(lines))[rows]:
                cells = lines[number].split(",")
                cells[titles.index(name)] = f"{change(float(cells[titles.index(name)])):.10g}"
                lines[number] = ",".join(cells)
        return "\n".join(lines) + "\n"

    return edit


def columns(names: str, change: Callable[[float], float]) -> Edit:
    """Change the numbers of several columns."""

    def edit(text: str) -> str:
        for name in names.split():
            text = column(name, change)(text)
        return text

    return edit


def gravity(written: str) -> Edit:
    return put(r'<option gravity="[^"]*"', f'<option gravity="{written}"')


def times(factor: float) -> Callable[[float], float]:
    return lambda value: factor * value


MASS_OF_GEOMS = r'\bmass="([\d.]+)"'
MOUNTS, MASSES, STOPS, POINTS = "mounts.csv", "masses.csv", "stops.csv", "points.csv"

OF_MODELS = [
    Slip("gravity 0 0 0", MODELS, gravity("0 0 0"), r"there is no gravity"),
    Slip("gravity upwards", MODELS, gravity("0 0 9.80665"), r"gravity points upwards"),
    Slip("gravity in mm/s^2", MODELS, gravity("0 0 -9806.65"), r"in mm/s\^2"),
    Slip("gravity in g", MODELS, gravity("0 0 -1"), r"0\.102 times the earth's"),
    Slip("masses in t", MODELS, each(MASS_OF_GEOMS, times(1e-3)), r"is its mass in t\b"),
    Slip("masses in g", MODELS, each(MASS_OF_GEOMS, times(1e3)), r"is its mass in .*\bg\b"),
]

OF_TABLES = [
    Slip("masses in t where kg is said", TABLES, column("mass", times(1e-3)), r"is its mass in t\b", MASSES),
    Slip("sizes or moments in other units than is said", TABLES,
         columns("ixx iyy izz ixy ixz iyz size_x size_y size_z", times(1e6)), r"radius of gyration of .*in mm", MASSES),
    Slip("a mount twice", TABLES, lambda text: text + text.splitlines()[-1] + "\n", r'the name ".*" is given twice', MOUNTS),
]  # fmt: skip

SLIPS = [*OF_MODELS, *OF_TABLES]
