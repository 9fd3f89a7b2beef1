"""A part that bends, by its modes: shapes at named points, frequencies, damping, participation; and the MJCF of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self
from xml.etree import ElementTree as ET

import numpy as np

from wirerope_mj.foundation.arrays import Array, Booleans
from wirerope_mj.foundation.errors import ModelError

NEAR = 1e-3  # distance from a mount's site within which a point of the part is meant [m]
RESIDUAL = "-residual"  # end of the name of a mode that is a residual vector
LEFT_OUT = 1e-3  # share of the compliance by forces at the points that a residual vector must have


@dataclass(frozen=True, kw_only=True, eq=False)
class FlexiblePart:
    """A deck fixed to the base, or equipment free in space, by m modes of unit modal mass.

    q'' + 2 zeta omega q' + omega^2 q = Phi^T f - Gamma a_base (Craig and Bampton 1968, fixed interface; of equipment free-free
    modes about mean axes, with Gamma = 0). Shapes are displacements, so that mounts with rotational stiffness do not bend it.
    """

    frequencies: Array  #: natural frequencies [Hz], (m,)
    damping: Array  #: damping ratios [-], (m,)
    shapes: Mapping[str, Array]  #: Phi by point, x, y, z in the part's axes [1/sqrt(kg)], (m, 3)
    points: Mapping[str, Array]  #: where the points are in the part's axes [m], (3,)
    #: Gamma = Phi^T M r along x, y, z [sqrt(kg)], (m, 3); zero of what is free in space
    participation: Array = field(default_factory=lambda: np.zeros((0, 3)))
    #: which of the modes are residual vectors, which have the static compliance of others and no resonance, (m,)
    residual: Booleans = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))

    def __post_init__(self) -> None:
        frequencies = np.atleast_1d(np.asarray(self.frequencies, dtype=np.float64))
        n = frequencies.size
        participation = np.asarray(self.participation, dtype=np.float64)
        checked = {
            "frequencies": frequencies,
            "damping": np.broadcast_to(np.asarray(self.damping, dtype=np.float64), (n,)).copy(),
            "participation": participation if participation.size else np.zeros((n, 3)),
            "residual": np.asarray(self.residual, dtype=np.bool_) if np.size(self.residual) else np.zeros(n, dtype=np.bool_),
            "shapes": {name: np.asarray(shape, dtype=np.float64) for name, shape in self.shapes.items()},
            "points": {name: np.asarray(place, dtype=np.float64) for name, place in self.points.items()},
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        if not n or not np.isfinite(frequencies).all() or not (frequencies > 0.0).all():
            low = f", got {frequencies.min():g} Hz" if n else ""
            raise ValueError(
                f"`frequencies` of a flexible part must be > 0{low}: rigid-body modes are the body's own; leave them out."
            )
        if not ((self.damping >= 0.0) & (self.damping < 1.0)).all():
            raise ValueError(f"`damping` must be ratios from 0 to below 1, got {self.damping.tolist()}.")
        if self.participation.shape != (n, 3) or not np.isfinite(self.participation).all():
            raise ValueError(f"`participation` must be {n} rows of three numbers, one for each mode.")
        if self.residual.shape != (n,) or self.residual.all():
            raise ValueError(f"`residual` must say of each of the {n} modes whether it is a residual vector, and not of all.")
        if set(self.shapes) != set(self.points):
            lone = sorted(set(self.shapes) ^ set(self.points))[0]
            raise ValueError(f"point {lone!r} must have both a place and shapes.")
        for name in self.points:
            if self.points[name].shape != (3,) or self.shapes[name].shape != (n, 3):
                raise ValueError(f"point {name!r} must have a place (3,) and shapes ({n}, 3), one row for each mode.")
            if not (np.isfinite(self.points[name]).all() and np.isfinite(self.shapes[name]).all()):
                raise ValueError(f"place and shapes of point {name!r} must be finite.")

    @property
    def description(self) -> str:
        """Short description: number of modes and lowest frequency."""
        return f"flexible part of {len(self.frequencies)} modes from {self.frequencies.min():.4g} Hz"

    def below(self, frequency: float, *, residual: bool = False) -> Self:
        """Return the part without its modes above a frequency [Hz]; ValueError if none is left.

        With `residual`, the static compliance of the modes left out is kept by residual vectors: their static deflections under
        unit forces at the points and under a motion of the base, made orthogonal, added as modes. Vectors that change no
        compliance by 0.1 % are left out.
        """
        kept, omega = (self.frequencies <= frequency) & ~self.residual, 2.0 * np.pi * self.frequencies
        if not kept.any():
            raise ValueError(f"the modes begin at {self.frequencies.min():.4g} Hz, and none is below {frequency:.4g} Hz.")
        modes = np.eye(kept.size)[kept]
        if residual and not kept.all():
            loads = [np.hstack(list(self.shapes.values())) / omega[:, None], self.participation / omega[:, None]]
            sized = np.hstack([load / max(float(np.linalg.norm(load, 2)), 1e-300) for load in loads])[~kept]
            directions, sizes, _ = np.linalg.svd(sized, full_matrices=False)
            vectors, _ = np.linalg.qr(directions[:, sizes**2 > LEFT_OUT] / omega[~kept, None])
            _, turns = np.linalg.eigh(vectors.T @ (omega[~kept, None] ** 2 * vectors))
            modes = np.vstack([modes, np.zeros((turns.shape[1], kept.size))])
            modes[kept.sum() :, ~kept] = (vectors @ turns).T
        return replace(
            self, residual=np.arange(len(modes)) >= kept.sum(),
            frequencies=np.sqrt(modes**2 @ self.frequencies**2), damping=modes**2 @ self.damping,
            participation=modes @ self.participation, shapes={name: modes @ shape for name, shape in self.shapes.items()},
        )  # fmt: skip

    def compliance(self, point: str) -> Array:
        """Return the static compliance of a point along x, y, z [m/N], (3,): the sum of Phi^2 / omega^2."""
        return np.asarray((self.shapes[point] ** 2).T @ (2.0 * np.pi * self.frequencies) ** -2.0)

    def nearest(self, place: Array) -> str:
        """Return the name of the point at a position (3,) in the part's axes [m]; ValueError if there is none within 1 mm."""
        name = min(self.points, key=lambda point: float(np.linalg.norm(self.points[point] - place)))
        away = float(np.linalg.norm(self.points[name] - place))
        if away > NEAR:
            raise ValueError(
                f"no point within {1e3 * NEAR:g} mm of ({', '.join(f'{c:.4g}' for c in place)}) m; the nearest is {name!r}, "
                f"{1e3 * away:.4g} mm away. Add it, or check the part's axes and units."
            )
        return name


def mode_name(part: str, number: int, residual: bool) -> str:
    """Name the body and the slide of a mode of a part in a model."""
    return f"mode/{part}/{number}{RESIDUAL if residual else ''}"


def add_part(root: ET.Element, part: FlexiblePart, *, name: str, body: str, sites: Mapping[str, str], gravity: Array) -> None:
    """Add a flexible part to a model, in place: its modes as bodies of 1 kg on slides, its shapes as numbers.

    The shapes are in the axes of the `body` that bends, `sites` names the part's point for each site on it, and the slides are
    across gravity [m/s^2], (3,), so that modes have no weight.
    """
    world, custom = root.find("worldbody"), root.find("custom")
    if world is None or custom is None:
        raise ModelError("the model's file has no <worldbody> or no <custom>: it is put together from other files.")
    axis = np.eye(3)[int(np.argmin(np.abs(gravity)))]
    if abs(float(axis @ gravity)) > 0.0:
        axis = np.cross(gravity, axis) / np.linalg.norm(np.cross(gravity, axis))
    modal = []
    for number, (frequency, damping) in enumerate(zip(part.frequencies, part.damping, strict=True), 1):
        mode, omega = mode_name(name, number, bool(part.residual[number - 1])), 2.0 * np.pi * float(frequency)
        element = ET.SubElement(world, "body", name=mode)
        ET.SubElement(
            element, "joint", name=mode, type="slide", axis=_text(axis), stiffness=repr(omega**2),
            damping=repr(2.0 * float(damping) * omega),
        )  # fmt: skip
        ET.SubElement(element, "inertial", pos="0 0 0", mass="1", diaginertia="1 1 1")
        modal.append(("body", mode))
    ET.SubElement(custom, "numeric", name=f"flexible/{name}", data=_text(part.participation))
    holds = [("body", body), *modal, ("numeric", f"flexible/{name}")]
    for site, point in sites.items():
        ET.SubElement(custom, "numeric", name=f"shapes/{site}", data=_text(part.shapes[point]))
        holds += [("site", site), ("numeric", f"shapes/{site}")]
    whole = ET.SubElement(custom, "tuple", name=f"flexible/{name}")
    for kind, element_name in holds:
        ET.SubElement(whole, "element", objtype=kind, objname=element_name)


def _text(values: Array) -> str:
    return " ".join(repr(float(value)) for value in np.ravel(values))
