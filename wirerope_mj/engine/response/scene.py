"""The drawable content of a system: bodies with their geoms, and mounts, frozen and without the engine."""

import math
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.foundation.structure import UNKNOWN, Positive, Shape, bounds
from wirerope_mj.foundation.summary import Brief

GeomShape = Literal["box", "sphere", "capsule", "cylinder", "ellipsoid", "plane", "mesh"]
Vector = Annotated[Array, Shape((3,))]
Quaternion = Annotated[Array, Shape((4,))]
Rows = Annotated[Array, Shape((None, 3))]
Size = Annotated[float, bounds(gt=0.0), UNKNOWN]


@dataclass(frozen=True, kw_only=True)
class Geom:
    """A shape that is fixed to a body."""

    name: str  # name in the model, "" if it has none
    shape: GeomShape
    size: Vector  # MuJoCo's sizes of the shape (half lengths, radii) [m], (3,)
    position: Vector  # its centre from the body's centre of mass, in body axes [m], (3,)
    orientation: Quaternion  # in body axes, quaternion w first, (4,)
    rgba: Quaternion  # colour, 0 to 1, (4,)
    vertices: Rows = field(default_factory=lambda: np.zeros((0, 3)))  # of a mesh [m], (n_vertices, 3), else (0, 3)
    # of a mesh, vertex numbers, (n_faces, 3), else (0, 3)
    faces: Rows = field(default_factory=lambda: np.zeros((0, 3)))


@dataclass(frozen=True, kw_only=True)
class SceneBody:
    """A body: where it stands in the modelled geometry, and its geoms."""

    name: str  # name of the body; "world" for what never moves
    moves: bool  # whether the response holds its motion under the same name
    on_base: bool  # whether it is fixed to the driven base
    position: Vector  # centre of mass in the modelled geometry [m], world frame, (3,)
    orientation: Quaternion  # in the modelled geometry, quaternion w first, (4,)
    geoms: tuple[Geom, ...]  # its shapes
    bends: bool = False  # whether it is a flexible part, drawn unbent


@dataclass(frozen=True, kw_only=True)
class SceneMount:
    """A mount: its sites in the frames of their bodies, and the device's data."""

    name: str
    isolator: str  # name of the device
    payload_body: str  # names of the bodies; "world" if fixed
    base_body: str
    payload_point: Vector  # the sites from the bodies' centres of mass, in body axes [m], (3,)
    base_point: Vector
    axes: Annotated[Array, Shape((3, 3))]  # roll, shear and axial direction as columns in the base body's axes, (3, 3)
    height: Size  # of the unloaded device [m]; NaN if unknown
    width: Size
    static_load: Size  # rated static load [N]; NaN if not judged
    travel: dict[str, Positive]  # rated travel [m] by "compression", "tension", "shear", "roll"; absent if not judged
    stop: bool = False  # whether it is a stop, see `wirerope_mj.mounts.isolator.Isolator.is_stop`
    # number of bolts of its base side, and distances of the outermost along roll and shear [m]; NaN if unknown, (3,)
    bolts: Annotated[Array, Shape((3,), finite=False)] = field(default_factory=lambda: np.full(3, np.nan))
    bar: Size = math.nan  # thickness of one of its bars [m]; NaN if unknown

    @property
    def sites(self) -> tuple[object, ...]:
        """Bodies, points and axes of both sites; equal for two mounts at the same sites."""
        numbers = np.concatenate([self.payload_point, self.base_point, self.axes.ravel()]).tolist()
        return self.payload_body, self.base_body, *numbers


@dataclass(frozen=True, kw_only=True, repr=False)
class Scene(Brief):
    """Everything that can be drawn of a system, and what its payload can bear."""

    name: str
    base: str  # name of the driven base; "" if there is none
    bodies: tuple[SceneBody, ...]  # what there is to draw
    mounts: tuple[SceneMount, ...]
    limits: tuple[PayloadLimit, ...] = ()  # of the payload; empty where the model states none: not judged
    # whether mounts are judged on the travel along all axes at once, by this project's own rule
    combined_travel: bool = True
    # names of the mounts on each area of the deck that the model names
    areas: dict[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def isolating(self) -> tuple[SceneMount, ...]:
        """Mounts other than stops, as listed in tables, loops and histories; stops are listed with contacts."""
        return tuple(mount for mount in self.mounts if not mount.stop)

    @property
    def drawn(self) -> tuple[SceneMount, ...]:
        """Mounts to be drawn: without stops at the sites of another mount, which they would cover in a plan."""
        taken = {mount.sites for mount in self.isolating}
        return tuple(mount for mount in self.mounts if not mount.stop or mount.sites not in taken)

    @property
    def stops(self) -> tuple[SceneMount, ...]:
        return tuple(mount for mount in self.mounts if mount.stop)


def scene_to_dict(value: object) -> object:
    """Write a scene, or a part of one, as plain lists, numbers and strings."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return [scene_to_dict(item) for item in value]
    if isinstance(value, dict):
        return {key: scene_to_dict(item) for key, item in value.items()}
    if hasattr(value, "__dataclass_fields__"):
        return {key: scene_to_dict(getattr(value, key)) for key in value.__dataclass_fields__}
    return value
