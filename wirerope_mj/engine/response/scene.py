"""The drawable content of a system: bodies with their geoms, and mounts, frozen and without the engine."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.foundation.summary import Brief


@dataclass(frozen=True, kw_only=True)
class Geom:
    """A shape that is fixed to a body.

    Attributes:
        name: name in the model, "" if it has none.
        shape: "box", "sphere", "capsule", "cylinder", "ellipsoid", "plane" or "mesh".
        size: MuJoCo's sizes of the shape (half lengths, radii) [m], (3,).
        position: its centre from the body's centre of mass, in body axes [m], (3,).
        orientation: in body axes, quaternion w first, (4,).
        rgba: colour, 0 to 1, (4,).
        vertices: of a mesh [m], (n_vertices, 3), else (0, 3).
        faces: of a mesh, vertex numbers, (n_faces, 3), else (0, 3).
    """

    name: str
    shape: str
    size: Array
    position: Array
    orientation: Array
    rgba: Array
    vertices: Array = field(default_factory=lambda: np.zeros((0, 3)))
    faces: Array = field(default_factory=lambda: np.zeros((0, 3)))


@dataclass(frozen=True, kw_only=True)
class SceneBody:
    """A body: where it stands in the modelled geometry, and its geoms.

    Attributes:
        name: name of the body; "world" for what never moves.
        moves: whether the response holds its motion under the same name.
        on_base: whether it is fixed to the driven base.
        position: centre of mass in the modelled geometry [m], world frame, (3,).
        orientation: in the modelled geometry, quaternion w first, (4,).
        geoms: its shapes.
    """

    name: str
    moves: bool
    on_base: bool
    position: Array
    orientation: Array
    geoms: tuple[Geom, ...]


@dataclass(frozen=True, kw_only=True)
class SceneMount:
    """A mount: its sites in the frames of the bodies they belong to, and what is known of the device.

    Attributes:
        isolator: name of the device.
        payload_body, base_body: names of the bodies; "world" if fixed.
        payload_point, base_point: the sites from the bodies' centres of mass, in body axes [m], (3,).
        axes: roll, shear and axial direction as columns in the base body's axes, (3, 3).
        height, width: of the unloaded device [m]; NaN if unknown.
        bar: thickness of one of its bars [m]; NaN if unknown.
        static_load: rated static load [N]; NaN if not judged.
        travel: rated travel [m] by "compression", "tension", "shear", "roll"; absent if not judged.
        stop: whether it is a stop, see `wirerope_mj.mounts.isolator.Isolator.is_stop`.
        bolts: number of bolts of its base side, and distances of the outermost along roll and shear [m]; NaN if unknown, (3,).
    """

    name: str
    isolator: str
    payload_body: str
    base_body: str
    payload_point: Array
    base_point: Array
    axes: Array
    height: float
    width: float
    static_load: float
    travel: dict[str, float]
    stop: bool = False
    bolts: Array = field(default_factory=lambda: np.full(3, np.nan))
    bar: float = math.nan


@dataclass(frozen=True, kw_only=True, repr=False)
class Scene(Brief):
    """Everything that can be drawn of a system, and what its payload can bear.

    Attributes:
        base: name of the driven base; "" if there is none.
        bodies, mounts: what there is to draw.
        limits: of the payload; empty where the model states none: not judged.
        combined_travel: whether mounts are judged on the travel along all axes at once, by this project's own rule.
        areas: names of the mounts on each area of the deck that the model names.
    """

    name: str
    base: str
    bodies: tuple[SceneBody, ...]
    mounts: tuple[SceneMount, ...]
    limits: tuple[PayloadLimit, ...] = ()
    combined_travel: bool = True
    areas: dict[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def isolating(self) -> tuple[SceneMount, ...]:
        """The mounts that are no stops, as tables, loops and histories list them; stops are listed with contacts."""
        return tuple(mount for mount in self.mounts if not mount.stop)

    @property
    def stops(self) -> tuple[SceneMount, ...]:
        """The mounts that are stops."""
        return tuple(mount for mount in self.mounts if mount.stop)


def scene_from_dict(content: dict[str, Any]) -> Scene:
    """Read the scene that `scene_to_dict` wrote."""
    bodies = tuple(
        _arrays(SceneBody, {**body, "geoms": tuple(_arrays(Geom, geom) for geom in body["geoms"])})
        for body in content["bodies"]
    )
    mounts = tuple(_arrays(SceneMount, mount) for mount in content["mounts"])
    limits = tuple(
        PayloadLimit(kind=limit["kind"], name=limit["name"], values=tuple(limit["values"]))
        for limit in content.get("limits", ())  # older responses have none
    )
    combined, areas = content.get("combined_travel", True), content.get("areas", {})  # older responses do not say them
    return Scene(
        name=content["name"], base=content["base"], bodies=bodies, mounts=mounts, limits=limits,
        combined_travel=combined, areas={name: tuple(mounts) for name, mounts in areas.items()},
    )  # fmt: skip


def scene_to_dict(value: Any) -> Any:
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


def _arrays(kind: Any, content: dict[str, Any]) -> Any:
    values = {key: np.array(v, dtype=np.float64) if isinstance(v, list) else v for key, v in content.items()}
    for key in {"vertices", "faces"} & values.keys():
        values[key] = values[key].reshape(-1, 3)
    return kind(**values)
