"""The MJCF of a payload on mounts, with comments, as one would write it by hand."""

from collections.abc import Iterable
from xml.etree import ElementTree as ET

import numpy as np

from wirerope_mj.engine.from_tables.layout import Layout, Mass, Sprung
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.isolator import BOTTOM
from wirerope_mj.mounts.vendor_parts import load_isolator

_ABOUT = """
    A payload on isolators above a deck that is driven along x, y and z, written by wirerope new from the tables in
    tables/. Change a table and write the model again (option force), or edit this file.

    Frame: that of the tables. SI units: m, kg, kg m^2, N. Gravity points down along z.
    Mounts: both sites of a mount lie at its isolator's mid-height and coincide in the unloaded geometry that is drawn.
    Axes of a site: x roll (across the bars), y shear (along the bars), z axial, from the base's bar to the payload's.
    Boxes show the envelope where a table says it, else the masses, each the uniform box of its inertia. Clearances hold for
    their corners; deck plate, boxes and balls are drawn only.
  """
_SPHERE = 0.03  # radius of what is drawn for a point mass and for a stop [m]


def mjcf_of(layout: Layout, name: str | None = None) -> str:
    """Return the MJCF of a layout as text: a driven deck, the payload, its mounts and stops as tuples.

    The model has the payload's name unless another is given. Isolators are named as files in the folder isolators/ beside it.
    """
    root = ET.Element("mujoco", model=name or layout.name)
    root.append(ET.Comment(_ABOUT))
    ET.SubElement(root, "option", gravity=f"0 0 {-STANDARD_GRAVITY}", integrator="RK4", timestep="0.0005")
    positions = np.array([placed.position for placed in (*layout.mounts, *layout.stops)] + [layout.payload.centre])
    low, high = positions.min(axis=0), positions.max(axis=0)
    ET.SubElement(root, "statistic", center=_numbers(0.5 * (low + high)), extent=_numbers([float(np.linalg.norm(high - low))]))
    visual = ET.SubElement(root, "visual")
    ET.SubElement(visual, "headlight", ambient="0.4 0.4 0.4", diffuse="0.5 0.5 0.5")
    default = ET.SubElement(root, "default")
    ET.SubElement(default, "geom", type="box", contype="0", conaffinity="0")
    for style, colour in (("mount_site", "0.9 0.2 0.2 1"), ("point", "0.2 0.8 0.4 1")):
        ET.SubElement(ET.SubElement(default, "default", {"class": style}), "site", size="0.015", rgba=colour)
    world = ET.SubElement(root, "worldbody")
    ET.SubElement(world, "light", pos="2 -3 5", dir="-0.4 0.5 -1")
    deck = ET.SubElement(world, "body", name="deck")
    for axis, along in zip("xyz", ("1 0 0", "0 1 0", "0 0 1"), strict=True):
        ET.SubElement(deck, "joint", name=f"deck_{axis}", type="slide", axis=along)
    geometries = {name: load_isolator(file).geometry for name, file in layout.isolators.items()}
    heights = {name: (geometry and geometry.height) or 0.0 for name, geometry in geometries.items()}
    top = min(mount.position[2] - 0.5 * heights[mount.isolator] * abs(mount.axes[2, 2]) for mount in layout.mounts)
    centre, half = 0.5 * (low + high), 0.5 * (high - low) + 0.1
    ET.SubElement(
        deck, "geom", name="deck_plate", size=_numbers([half[0], half[1], 0.01]), mass="1000", rgba="0.46 0.52 0.58 1",
        pos=_numbers([centre[0], centre[1], top - 0.01]),
    )  # fmt: skip
    _add_sites(deck, "deck", layout)
    _add_payload(world, layout)
    custom = ET.SubElement(root, "custom")
    for isolator in dict.fromkeys(placed.device for placed in (*layout.mounts, *layout.stops)):
        ET.SubElement(custom, "text", name=f"isolator/{isolator}", data=f"isolators/{isolator}.toml")
    for device in layout.bottoms:
        ET.SubElement(custom, "text", name=f"isolator/{BOTTOM}{device}", data=f"isolators/{BOTTOM}{device}.toml")
    custom.append(ET.Comment(" A mount: its payload site, its base site, its isolator. Stops are mounts too. "))
    tuples = [(placed.name, placed.name, placed.device) for placed in (*layout.mounts, *layout.stops)]
    bottoming = [placed for placed in layout.mounts if placed.device in layout.bottoms]
    tuples += [(f"bottom_{placed.name}", placed.name, f"{BOTTOM}{placed.device}") for placed in bottoming]
    for name, at, device in tuples:
        mount = ET.SubElement(custom, "tuple", name=f"mount/{name}")
        for kind, element in (("site", f"{layout.name}/{at}"), ("site", f"deck/{at}"), ("text", f"isolator/{device}")):
            ET.SubElement(mount, "element", objtype=kind, objname=element)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _add_payload(world: ET.Element, layout: Layout) -> None:
    payload, rigid = layout.rigid, [mass for mass in layout.masses if mass.sprung is None]
    body = ET.SubElement(world, "body", name=layout.name)
    ET.SubElement(body, "freejoint", name=layout.name)
    body.append(
        ET.Comment(
            f" {len(rigid)} masses together: the inertia is about the centre of mass, xx yy zz xy xz yz of the tensor"
            " (xy = -sum of x y dm) "
        )
    )
    i = payload.inertia
    ET.SubElement(
        body, "inertial", pos=_numbers(payload.centre), mass=_numbers([payload.mass]),
        fullinertia=_numbers([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]),
    )  # fmt: skip
    drawn = {f"envelope/{box.name}": _box(box.centre, 0.5 * box.size) for box in layout.envelope} or {
        f"mass/{mass.name}": _drawn(mass) for mass in rigid
    }
    for name, shape in drawn.items():
        ET.SubElement(body, "geom", {"name": name, "mass": "0", "rgba": "0.20 0.36 0.52 0.6", **shape})
    for stop in () if layout.envelope else layout.stops:  # a ball would be a part of the envelope
        ET.SubElement(
            body, "geom", name=f"stop/{stop.name}", type="sphere", mass="0", size=_numbers([_SPHERE]),
            pos=_numbers(stop.position), rgba="0.93 0.62 0.13 1",
        )  # fmt: skip
    _add_sites(body, layout.name, layout)
    for point in layout.points:
        ET.SubElement(body, "site", {"name": f"point/{point.name}", "class": "point", "pos": _numbers(point.position)})
    for point in layout.forces:
        ET.SubElement(body, "site", {"name": f"force/{point.name}", "class": "point", "pos": _numbers(point.position)})
    for mass in layout.masses:
        if mass.sprung is not None:
            _add_subassembly(body, mass, mass.sprung)


def _add_subassembly(payload: ET.Element, mass: Mass, sprung: Sprung) -> None:
    """Add a sprung subassembly of the payload on a slide; its spring carries its weight in the position as drawn."""
    properties, omega = mass.properties, 2.0 * np.pi * sprung.frequency
    body = ET.SubElement(payload, "body", name=mass.name, pos=_numbers(properties.centre))
    axis = np.eye(3)["xyz".index(sprung.axis)]
    ET.SubElement(
        body, "joint", name=mass.name, type="slide", axis=_numbers(axis), stiffness=_numbers([properties.mass * omega**2]),
        damping=_numbers([2.0 * sprung.damping * properties.mass * omega]),
        springref=_numbers([STANDARD_GRAVITY * axis[2] / omega**2]),
    )  # fmt: skip
    least = 0.0 if properties.inertia.any() else 1e-4 * properties.mass  # of a point mass a centimetre's
    inertia = properties.inertia + least * np.eye(3)
    ET.SubElement(
        body, "inertial", pos="0 0 0", mass=_numbers([properties.mass]),
        fullinertia=_numbers([inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]),
    )  # fmt: skip
    drawn = _drawn(mass) | {"pos": "0 0 0"}
    ET.SubElement(body, "geom", {"name": f"mass/{mass.name}", "mass": "0", "rgba": "0.70 0.38 0.20 0.9", **drawn})


def _add_sites(body: ET.Element, owner: str, layout: Layout) -> None:
    for placed in (*layout.mounts, *layout.stops):
        ET.SubElement(
            body, "site",
            {
                "name": f"{owner}/{placed.name}", "class": "mount_site", "pos": _numbers(placed.position),
                "xyaxes": _numbers([*placed.axes[0], *placed.axes[1]]),
            },
        )  # fmt: skip


def _drawn(mass: Mass) -> dict[str, str]:
    """Return the geom attributes of a mass: the uniform box with its moments of inertia, or a ball."""
    properties = mass.properties
    if not np.diag(properties.inertia).any():
        return {"type": "sphere", "size": _numbers([_SPHERE]), "pos": _numbers(properties.centre)}
    return _box(properties.centre, np.maximum(0.5 * properties.box, 1e-3))  # a plate is drawn 2 mm thick


def _box(centre: Array, half: Array) -> dict[str, str]:
    return {"size": _numbers(half), "pos": _numbers(centre)}


def _numbers(values: Iterable[float]) -> str:
    """Format numbers for MJCF to twelve digits; rounding errors become 0."""
    return " ".join(f"{0.0 if abs(value) < 1e-12 else value:.12g}" for value in values)
