"""Outlines of a scene in a plan and an elevation, and the labels of its mounts: what is drawn, before it is."""

from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.response.scene import Geom, Scene, SceneBody, SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices

LONGEST_LABEL = 5  # Letters of a mount's name that fit beside its mark; where one is longer, all mounts are numbered
_AROUND = 16  # corners of a circle that is drawn as a polygon
_PALE = 0.62  # fraction of white in a body's colour, so that the mounts stand out
_COINCIDENT = 0.02  # of the drawing's width: mounts closer than this have one label


@dataclass(frozen=True)
class View:
    """A direction to look in: the world axes that run right and up in the drawing, and the one that comes out of it."""

    title: str
    right: int
    up: int
    towards: int
    sign: float  # of what comes towards the eye, along `towards`

    def seen(self, points: Array) -> Array:
        """Return where points (.., 3) lie in the drawing [m], (.., 2)."""
        return np.asarray(points)[..., [self.right, self.up]]


_PLAN = View("from above", 0, 1, 2, 1.0)
_FROM_FRONT = View("from the front, along -x", 1, 2, 0, 1.0)
_FROM_SIDE = View("from the side, along +y", 0, 2, 1, -1.0)


@dataclass(frozen=True, kw_only=True)
class DrawnScene:
    """A scene with its shapes in the world frame."""

    scene: Scene
    # body, geom and points whose convex hull it is, (n, 3) [m], of every shape
    shapes: tuple[tuple[SceneBody, Geom, Array], ...]
    # low, high: least and largest coordinates of shapes and mounts [m], (3,)
    low: Array
    high: Array

    @property
    def views(self) -> tuple[View, View]:
        """The plan and the elevation that shows the longer horizontal extent, which runs to the right."""
        across = self.high - self.low
        return _PLAN, _FROM_FRONT if across[1] > across[0] else _FROM_SIDE


def mount_labels(scene: Scene) -> dict[str, str]:
    """Return what mounts are called in the drawing: their names if these are short, or numbers in the order of the model."""
    short = all(len(mount.name) <= LONGEST_LABEL for mount in scene.mounts)
    return {mount.name: mount.name if short else str(number + 1) for number, mount in enumerate(scene.mounts)}


@dataclass(frozen=True)
class Outline:
    """A shape as it is seen: the corners of its convex hull in the drawing [m], (n, 2), and its colour, 0 to 1, (4,)."""

    corners: Array
    colour: tuple[float, ...]
    flexible: bool = False


def flexible_bodies(scene: Scene) -> list[str]:
    """Return the names of the bodies that bend by their modes, and of a panel on its spring."""
    return [body.name for body in scene.bodies if body.bends or body.name == NAME]


def crowded_label(scene: Scene) -> tuple[str, int] | None:
    """Return the first label in the drawing that stands for more mounts than it names, as "m1 +2", and for how many."""
    for view in drawn_scene(scene).views:
        for _, names in label_groups(scene, view):
            if len(names) > 2:
                return shared_label(names), len(names)
    return None


def mount_position(scene: Scene, mount: SceneMount) -> Array:
    """Return the position of a mount in the modelled geometry, world frame [m], (3,)."""
    body = next(body for body in scene.bodies if body.name == mount.base_body)
    return np.asarray(body.position + rotation_matrices(body.orientation) @ mount.base_point)


def axial_direction(scene: Scene, mount: SceneMount) -> Array:
    """Return a mount's axial direction in the world frame of the modelled geometry, (3,)."""
    body = next(body for body in scene.bodies if body.name == mount.base_body)
    return np.asarray(rotation_matrices(body.orientation) @ mount.axes[:, 2])


def mount_positions(scene: Scene) -> dict[str, Array]:
    """Return the positions of the mounts by name, world frame of the modelled geometry [m], (3,) each."""
    return {mount.name: mount_position(scene, mount) for mount in scene.mounts}


def drawn_scene(scene: Scene) -> DrawnScene:
    """Return the shapes of a scene with their points; a plane has no end and is left out."""
    shapes = []
    for body in scene.bodies:
        for geom in (geom for geom in body.geoms if geom.shape != "plane"):
            local = _local_points(geom) @ rotation_matrices(geom.orientation).T + geom.position
            shapes.append((body, geom, np.asarray(local @ rotation_matrices(body.orientation).T + body.position)))
    points = [*(points for *_, points in shapes), *(at[None] for at in mount_positions(scene).values())]
    every = np.concatenate(points)
    return DrawnScene(scene=scene, shapes=tuple(shapes), low=every.min(axis=0), high=every.max(axis=0))


def outlines(drawn: DrawnScene, view: View) -> list[Outline]:
    """Return the outlines of all shapes as they are seen, what is behind first."""
    nearer = sorted(drawn.shapes, key=lambda entry: float((view.sign * entry[2][:, view.towards]).max()))
    seen, flexible = [], flexible_bodies(drawn.scene)
    for body, geom, points in nearer:
        paint = np.array([0.86, 0.88, 0.90]) if body.on_base or not body.moves else geom.rgba[:3]
        colour = (*(_PALE + (1.0 - _PALE) * paint).tolist(), max(float(geom.rgba[3]), 0.15))
        seen.append(Outline(_outline(view.seen(points)), colour, body.name in flexible))
    return seen


def label_groups(scene: Scene, view: View) -> list[tuple[Array, list[str]]]:
    """Return positions in the drawing with the labels of the mounts that stand behind each other there."""
    labels, positions = mount_labels(scene), mount_positions(scene)
    spread = float(np.ptp([position[view.right] for position in positions.values()])) if positions else 0.0
    groups: list[tuple[Array, list[str]]] = []
    for mount in scene.mounts:
        at = view.seen(positions[mount.name])
        near = next((names for there, names in groups if np.abs(at - there).max() <= _COINCIDENT * spread), None)
        if near is None:
            groups.append((at, [labels[mount.name]]))
        else:
            near.append(labels[mount.name])
    return groups


def shared_label(names: list[str]) -> str:
    """Return one label for mounts behind each other: "m1, m2", or "m1 +2" for three."""
    return ", ".join(names) if len(names) < 3 else f"{names[0]} +{len(names) - 1}"


def _local_points(geom: Geom) -> Array:
    if geom.shape == "mesh":
        return geom.vertices
    if geom.shape == "box":
        return np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * geom.size
    radius = geom.size[0]
    if geom.shape == "cylinder":
        return np.concatenate([_ring(radius, -geom.size[1]), _ring(radius, geom.size[1])])
    ball = np.concatenate([_ring(np.sin(polar), np.cos(polar)) for polar in np.linspace(0.0, np.pi, 9)])
    if geom.shape == "ellipsoid":
        return ball * geom.size
    if geom.shape == "capsule":
        return np.concatenate([radius * ball + [0.0, 0.0, end] for end in (-geom.size[1], geom.size[1])])
    return radius * ball


def _ring(radius: float, height: float) -> Array:
    angle = np.linspace(0.0, 2.0 * np.pi, _AROUND, endpoint=False)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(_AROUND, height)], axis=1)


def _outline(points: Array) -> Array:
    """Return the corners of the convex hull in the plane, in order; of what is flat, the points themselves."""
    try:
        return np.asarray(points[scipy.spatial.ConvexHull(points).vertices])
    except scipy.spatial.QhullError:
        return points
