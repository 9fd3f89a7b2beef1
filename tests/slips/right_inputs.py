"""Models, tables and isolator files that are right, into which slips are planted."""

from tests.slips.planting import Base
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
    "compressor", mass=560, centre="0.04 -0.02 0.36", inertia='fullinertia="48 62 55 1.5 -2 0.8"', half=(0.55, 0.45, 0.45),
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
RADIO = skid(
    "radio", mass=95, centre="0.01 0.0 0.3", inertia='fullinertia="4.2 4.6 3.1 0.05 0.1 -0.1"', half=(0.24, 0.2, 0.32),
    isolator="WR8-400", height=0.054,
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


def _with_moments(base: Base) -> Base:
    """Return tables of boxes with their moments of inertia in place of their sizes."""
    head, *rows = base.files["masses.csv"].splitlines()
    made = [head.replace("size_x [mm],size_y [mm],size_z [mm]", "ixx [kg m^2],iyy [kg m^2],izz [kg m^2]")]
    for row in rows:
        *kept, x, y, z = row.split(",")
        square = {axis: (1e-3 * float(size)) ** 2 for axis, size in zip("xyz", (x, y, z), strict=True)}
        moments = [float(kept[1]) / 12.0 * (sum(square.values()) - square[axis]) for axis in "xyz"]
        made.append(",".join([*kept, *(f"{moment:.6g}" for moment in moments)]))
    return Base("rack_with_moments", {**base.files, "masses.csv": "\n".join(made) + "\n"})


MOMENTS = (GENSET, PUMP, _with_moments(RACK))  # tables with columns of inertia

FITTED = """name = "Identified mount"

[roll]
law = "symmetric-bouc-wen"
alpha = 9.0e4
beta = 3.0
gamma = 0.6
n = 2.0
k1 = 8.0e4
k2 = 0.0
k3 = 3.0e7

[shear]
law = "symmetric-bouc-wen"
alpha = 1.1e5
beta = 3.5
gamma = 0.7
n = 2.0
k1 = 9.5e4
k2 = 0.0
k3 = 3.0e7

[axial]
law = "asymmetric-bouc-wen"
alpha = 4.0e5
beta = 0.5
gamma = 0.1
n = 2.0
k1 = 2.6e5
k2 = 0.0
k3 = 2.0e7
b = 2.718281828459045
c = 5.0

[limits]
static_load = 2700.0
travel = { compression = 0.042, shear = 0.045, roll = 0.045 }

[geometry]
height = 0.09
width = 0.11

[provenance]
kind = "identified"
source = "cyclic tests of one specimen"
"""


def isolator(name: str) -> Base:
    """Return an isolator file of the catalogue."""
    return Base(name, {"isolator.toml": _read(f"isolators/{name}.toml")}, "isolator.toml")


WR16, CB15, OWN = *map(isolator, ("enidine_wr16_400", "socitec_cb1400_15")), Base("own", {"own.toml": FITTED}, "own.toml")
ISOLATORS = (WR16, CB15, OWN)
SOFTER = Base("softer", {"own.toml": FITTED.replace("alpha = 4.0e5", "alpha = 2.8e5").replace("2.6e5", "1.9e5")}, "own.toml")
STIFFER = Base("stiffer", {"own.toml": FITTED.replace("alpha = 4.0e5", "alpha = 6.0e5").replace("2.6e5", "3.6e5")}, "own.toml")
IDENTIFIED = (OWN, SOFTER, STIFFER)
SERIES = tuple(map(isolator, ("socitec_cb1390_20", "socitec_cb1390_30", "socitec_cb1400_15")))  # shear is not roll
BUMPS = tuple(map(isolator, ("bump_stop_1mn", "bump_stop_17mn", "bump_stop_24mn")))
RUBBER = isolator("rubber_horizontal")
