"""Geometry of drawn scenes: outlines in a plan and an elevation, labels of mounts, and the worst instant of a run."""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
import scipy

from wirerope_mj.assessment.criteria import EXCEEDED, Verdict
from wirerope_mj.assessment.criteria.verdict import against_limit, by_use
from wirerope_mj.content.blocks import SceneView
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.content.verdicts import ordered
from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Geom, Scene, SceneBody, SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.directions import rotation_matrices
from wirerope_mj.foundation.units import instant_text

LONGEST_LABEL = 5  # letters of a mount's name beside its mark; if one is longer, all mounts are numbered
_CIRCLE_CORNERS = 16  # corners of a circle that is drawn as a polygon
_WHITENING = 0.62  # fraction of white in a body's colour, so that the mounts stand out
_COINCIDENT = 0.02  # of the drawing's width: mounts closer than this have one label


@dataclass(frozen=True)
class View:
    """A view: the world axes that point right and up in the drawing, and the axis towards the viewer."""

    title: str
    right: int
    up: int
    towards: int
    sign: float  # of the direction to the viewer along `towards`

    def seen(self, points: Array) -> Array:
        """Project points (.., 3) into the drawing [m], (.., 2)."""
        return np.asarray(points)[..., [self.right, self.up]]


_PLAN = View("from above", right=0, up=1, towards=2, sign=1.0)
_FROM_FRONT = View("from the front, along -x", right=1, up=2, towards=0, sign=1.0)
_FROM_SIDE = View("from the side, along +y", right=0, up=2, towards=1, sign=-1.0)


@dataclass(frozen=True, kw_only=True)
class DrawnScene:
    """A scene with its shapes in the world frame."""

    scene: Scene
    # body, geom and points (n, 3) [m] of every shape, which is the convex hull of the points
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
    """Label mounts by name: with their names if all are short, else with their numbers from 1."""
    short = all(len(mount.name) <= LONGEST_LABEL for mount in scene.drawn)
    return {mount.name: mount.name if short else str(number + 1) for number, mount in enumerate(scene.mounts)}


@dataclass(frozen=True)
class Outline:
    """The outline of a shape of a body in a drawing: corners of its convex hull [m], (n, 2), and colour from 0 to 1, (4,)."""

    corners: Array
    colour: tuple[float, ...]
    body: str
    flexible: bool = False


def flexible_bodies(scene: Scene) -> list[str]:
    """Name the bodies that deform: those with modes, and the deck panel, which is a mass on a spring."""
    return [body.name for body in scene.bodies if body.bends or body.name == NAME]


def crowded_label(scene: Scene) -> tuple[str, int] | None:
    """Find the first label shared by more than two mounts, such as "m1 +2", and their number; None without one."""
    for view in drawn_scene(scene).views:
        for _, names in label_groups(scene, view):
            if len(names) > 2:
                return shared_label(names), len(names)
    return None


def mount_position(scene: Scene, mount: SceneMount) -> Array:
    """Find the position of a mount in the modelled geometry, world frame [m], (3,)."""
    body = next(body for body in scene.bodies if body.name == mount.base_body)
    return np.asarray(body.position + rotation_matrices(body.orientation) @ mount.base_point)


def mount_axes(scene: Scene, mount: SceneMount) -> Array:
    """Find a mount's axes roll, shear and axial as columns, in the world frame of the modelled geometry, (3, 3)."""
    body = next(body for body in scene.bodies if body.name == mount.base_body)
    return np.asarray(rotation_matrices(body.orientation) @ mount.axes)


def mount_positions(scene: Scene) -> dict[str, Array]:
    """Find the positions of the mounts by name, world frame [m], (3,) each."""
    return {mount.name: mount_position(scene, mount) for mount in scene.mounts}


def drawn_scene(scene: Scene) -> DrawnScene:
    """Transform the shapes of a scene into the world frame, without planes, and find their extent."""
    shapes = []
    for body in scene.bodies:
        for geom in (geom for geom in body.geoms if geom.shape != "plane"):
            local = _local_points(geom) @ rotation_matrices(geom.orientation).T + geom.position
            shapes.append((body, geom, np.asarray(local @ rotation_matrices(body.orientation).T + body.position)))
    points = [*(points for *_, points in shapes), *(at[None] for at in mount_positions(scene).values())]
    every = np.concatenate(points)
    return DrawnScene(scene=scene, shapes=tuple(shapes), low=every.min(axis=0), high=every.max(axis=0))


def outlines(drawn: DrawnScene, view: View) -> list[Outline]:
    """Project all shapes into their outlines in a view, from back to front."""
    back_to_front = sorted(drawn.shapes, key=lambda entry: float((view.sign * entry[2][:, view.towards]).max()))
    projected, flexible = [], flexible_bodies(drawn.scene)
    for body, geom, points in back_to_front:
        paint = np.array([0.86, 0.88, 0.90]) if body.on_base or not body.moves else geom.rgba[:3]
        colour = (*(_WHITENING + (1.0 - _WHITENING) * paint).tolist(), max(float(geom.rgba[3]), 0.15))
        corners = view.seen(points)
        with suppress(scipy.spatial.QhullError):  # of what is flat, the points themselves
            corners = np.asarray(corners[scipy.spatial.ConvexHull(corners).vertices])
        projected.append(Outline(corners, colour, body.name, body.name in flexible))
    return projected


def label_groups(scene: Scene, view: View) -> list[tuple[Array, list[str]]]:
    """Group the labels of mounts that stand behind each other, by position in the drawing."""
    labels, positions = mount_labels(scene), mount_positions(scene)
    spread = float(np.ptp([position[view.right] for position in positions.values()])) if positions else 0.0
    groups: list[tuple[Array, list[str]]] = []
    for mount in scene.drawn:
        at = view.seen(positions[mount.name])
        near = next((names for position, names in groups if np.abs(at - position).max() <= _COINCIDENT * spread), None)
        if near is None:
            groups.append((at, [labels[mount.name]]))
        else:
            near.append(labels[mount.name])
    return groups


def shared_label(names: list[str]) -> str:
    """Join the labels of mounts behind each other, as "m1, m2", or as "m1 +2" for three."""
    return ", ".join(names) if len(names) < 3 else f"{names[0]} +{len(names) - 1}"


def _local_points(geom: Geom) -> Array:
    """List points in the frame of a geom whose convex hull is its shape [m], (n, 3)."""
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
    """List points of a circle about z at a height, (n, 3)."""
    angle = np.linspace(0.0, 2.0 * np.pi, _CIRCLE_CORNERS, endpoint=False)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(_CIRCLE_CORNERS, height)], axis=1)


_SHOWN_DISPLACEMENT = 0.06  # fraction of the drawing's extent that the largest displacement may take
_FACTORS = (100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0)  # by which displacements are enlarged
_STILL = 1e-6  # [m]: displacement below which a scene is not shown
USED_KEY = "Mounts: the deeper blue, the more of their limits is used, grey not judged; red: beyond a limit."


@dataclass(frozen=True, kw_only=True)
class SceneMotion:
    """A scene as it moves relative to its base, displacements and rotations from the modelled geometry enlarged."""

    scene: Scene  # in the modelled geometry
    time: Array  # of the samples [s], (n,)
    # of bodies by name: displacements [m] and rotation vectors [rad] in base axes, (n, 3) each
    travels: Mapping[str, Array]
    turns: Mapping[str, Array]
    factor: float  # by which they are enlarged

    @property
    def moves(self) -> bool:
        """Tell whether anything moves visibly between the samples."""
        return any(float(np.ptp(travel, axis=0).max()) > _STILL for travel in self.travels.values())

    def at(self, instant: float) -> Scene:
        """Place the bodies as they stand at an instant [s], interpolated between the samples."""
        bodies, rotation = [], scipy.spatial.transform.Rotation
        for body in self.scene.bodies:
            if body.name in self.travels:
                travel, turn = (
                    self.factor * np.array([np.interp(instant, self.time, part) for part in parts[body.name].T])
                    for parts in (self.travels, self.turns)
                )
                turned = rotation.from_rotvec(turn) * rotation.from_quat(body.orientation, scalar_first=True)
                body = replace(body, position=body.position + travel, orientation=turned.as_quat(scalar_first=True))
            bodies.append(body)
        return replace(self.scene, bodies=tuple(bodies))

    def drawn(self) -> DrawnScene:
        """Transform the modelled scene into the world frame, with the room that its displacements take."""
        drawn = drawn_scene(self.scene)
        every = self.factor * np.concatenate([np.zeros((1, 3)), *self.travels.values()])
        return replace(drawn, low=drawn.low + every.min(axis=0), high=drawn.high + every.max(axis=0))


def scene_motion(response: Response, rows: slice) -> SceneMotion | None:
    """Find the displacements of a scene's bodies relative to the base at some samples; None if none is visible."""
    scene, rotation = response.scene, scipy.spatial.transform.Rotation
    if not any(body.geoms for body in scene.bodies):
        return None
    moving = [body for body in scene.bodies if body.moves and not body.on_base]
    travels = {
        body.name: response.displacement_from_base(response.bodies[body.name].position, body.position)[rows] for body in moving
    }
    largest = max((float(np.linalg.norm(travel, axis=1).max()) for travel in travels.values()), default=0.0)
    if largest < _STILL:
        return None
    drawn = drawn_scene(scene)
    allowed = _SHOWN_DISPLACEMENT * float((drawn.high - drawn.low).max())
    factor = next((factor for factor in _FACTORS if factor * largest <= allowed), 1.0)
    back, turns = rotation.identity(), dict[str, Array]()
    if response.base_rotation is not None:
        back = rotation.from_matrix(response.base_rotation[rows].transpose(0, 2, 1))
    for body in moving:
        now = back * rotation.from_quat(response.bodies[body.name].orientation[rows], scalar_first=True)
        turns[body.name] = (now * rotation.from_quat(body.orientation, scalar_first=True).inv()).as_rotvec()
    return SceneMotion(scene=scene, time=response.time[rows], travels=travels, turns=turns, factor=factor)


def critical_verdict(verdicts: Sequence[Verdict]) -> Verdict | None:
    """Find the most critical verdict that has an instant; None without one."""
    timed = (row for row in ordered(verdicts) if row.time is not None and math.isfinite(row.value))
    return next(timed, None)


def ring_around(moved: Scene, subject: str) -> tuple[str, Array] | None:
    """Find name and position [m] of a verdict's subject, a body or a mount (its payload side); None for other subjects."""
    bodies = {body.name: body for body in moved.bodies}
    if subject in bodies:
        return subject, bodies[subject].position
    mount = next((mount for mount in moved.mounts if mount.name == subject), None)
    if mount is None:
        return None
    body = bodies[mount.payload_body]
    return subject, np.asarray(body.position + rotation_matrices(body.orientation) @ mount.payload_point)


def worst_instant(run: JudgedRun) -> SceneView | None:
    """Show the scene at the instant of the most critical verdict that has one, displacements enlarged; None without motion."""
    worst = critical_verdict(run.verdicts)
    if worst is None or worst.time is None:
        return None
    unlimited = f"{worst.subject} {worst.criterion} {with_unit(worst.value, worst.unit)} at {instant_text(worst.time)}"
    title = f"The worst instant: {unlimited if worst.limit is None else against_limit(worst)}"
    if (first := ordered(run.verdicts)[0]) is not worst and first.limit is not None:
        title += f"; what is more critical, {against_limit(first)}, has no instant"
    view = scene_at(run.response, worst.time, title=title)
    if view is None or view.moved is None:
        return None
    used = {name: row.utilisation or 0.0 for name, row in by_use(run.verdicts).items()}
    return replace(
        view, id="worst-instant", ring=ring_around(view.moved, worst.subject), exceeded=worst.verdict == EXCEEDED, used=used,
        caption=f"{view.caption} {USED_KEY}" if used else view.caption,
    )  # fmt: skip


def scene_at(response: Response, instant: float, *, title: str = "") -> SceneView | None:
    """Show the scene at the sample nearest to an instant [s], displacements enlarged; None without visible motion."""
    number = int(np.abs(response.time - instant).argmin())
    motion = scene_motion(response, slice(number, number + 1))
    if motion is None:
        return None
    enlarged = f", displacements {motion.factor:g} times as large" if motion.factor > 1.0 else ""
    caption = (
        f"{title or f'At {response.time[number]:.4f} s'}. Everything as it stands from the base{enlarged}; pale or dashed: "
        "the modelled, unloaded geometry. Lines: mounts from the base's site to the payload's."
    )
    return SceneView(id="instant", scene=response.scene, caption=caption, moved=motion.at(response.time[number]))
