"""Cameras of the whole scene, and of the governing mount from a direction in which it is least hidden."""

from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Geom, Scene
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.shapes import conjugate, multiply, rotate

_LOOK_FROM = np.array([0.46, -0.80, 0.38])
_TANGENT = 0.88 * np.tan(np.radians(55.0 / 2))  # of half the viewer's vertical angle of view, less a margin
_ASPECT = 1.75  # width over height of the pane of the whole scene of one run on a full-HD screen
_CLOSE = 1.4  # distance over the diagonal of the mount, within which bodies may hide it
_MARGIN = 1.05  # size of the close-up over that of the mount
_AZIMUTHS = 24
_ELEVATIONS = (-30.0, -12.0, 3.0, 10.0, 22.0, 40.0)  # [deg]
CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_GRID = np.array([[x, y, z] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0) for z in (-1.0, 0.0, 1.0)])


@dataclass(frozen=True, kw_only=True)
class Camera:
    """Eye and target in the base's frame [m], (3,) each."""

    eye: Array
    target: Array


def whole_scene(response: Response, *, aspect: float = _ASPECT, mount: str | None = None) -> Camera:
    """Place the camera to see the whole scene, as near as a pane `aspect` times as wide as high allows.

    It looks from the front and the right, or from the side from which `mount` is least hidden.
    """
    scene = response.scene
    points = _seen_from_base(scene, _corners(scene))
    back = _LOOK_FROM / np.linalg.norm(_LOOK_FROM)
    if mount is not None:
        at = next(entry for entry in scene.mounts if entry.name == mount)
        base = next(body for body in scene.bodies if body.name == at.base_body)
        middle = base.position + rotate(base.orientation, at.base_point)
        backs = back * np.array([[x, y, 1.0] for y in (1.0, -1.0) for x in (1.0, -1.0)])
        hidden = _hidden(scene, middle + scene_extent(scene)[1] * backs, middle[None])
        back = backs[int(hidden.argmin())]
    return _fitted_camera(points, back, aspect)


def _fitted_camera(points: Array, back: Array, aspect: float) -> Camera:
    """Place the camera to look along -`back` at points (n, 3), as near as the pane allows."""
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    target = 0.5 * (points.min(axis=0) + points.max(axis=0))
    distance = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    for _ in range(40):  # a fixed point, because of the perspective; half steps keep it from swinging
        seen = points - target - distance * back
        depth = np.maximum(-seen @ back, 1e-3 * distance)
        x, y = seen @ right / depth, seen @ up / depth
        target = target + 0.25 * distance * ((x.min() + x.max()) * right + (y.min() + y.max()) * up)
        distance *= max(np.ptp(x) / (2.0 * _TANGENT * aspect), np.ptp(y) / (2.0 * _TANGENT)) ** 0.5
    return Camera(eye=target + distance * back, target=target)


def close_up(response: Response, mount: str, *, height: float, width: float, row: int, aspect: float) -> Camera:
    """Place the camera to see a mount of a size [m] past the bodies around it, at the sample `row`, in a pane of an aspect.

    Of a grid of directions it takes the one from which the device is least hidden, transparent bodies counted by their opacity;
    among equal ones one across the bars, level, from outside the scene: the mount's height and travel are then seen.
    """
    bodies = []
    for body in response.scene.bodies:
        if body.name in response.bodies:
            moved = response.bodies[body.name]
            body = replace(body, position=moved.position[row], orientation=moved.orientation[row])
        bodies.append(body)
    scene = replace(response.scene, bodies=tuple(bodies))
    at = next(entry for entry in scene.mounts if entry.name == mount)
    base = next(body for body in scene.bodies if body.name == at.base_body)
    middle = base.position + rotate(base.orientation, at.base_point)
    axes = rotate(base.orientation, at.axes.T)
    half = 0.5 * np.array([width, 1.9 * width, height])  # bars are about 1.9 times as long as the device is wide
    distance = _CLOSE * float(np.linalg.norm(2.0 * half))
    elevation, azimuth = np.meshgrid(
        np.radians(_ELEVATIONS), np.linspace(0.0, 2.0 * np.pi, _AZIMUTHS, endpoint=False), indexing="ij"
    )
    flat = np.cos(elevation)
    directions = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=-1).reshape(-1, 3)
    hidden = _hidden(scene, middle + distance * directions, middle + 0.8 * (_GRID * half) @ axes)
    center, _ = scene_extent(scene)
    outward = (middle - center) / max(float(np.linalg.norm(middle - center)), 1e-9)
    along_bars = np.abs(directions @ axes[1])
    level = np.abs(directions[:, 2])
    score = -4.0 * hidden - 0.5 * np.abs(along_bars - 0.2) - 0.3 * level + 0.2 * directions @ outward
    corners = _seen_from_base(scene, middle + _MARGIN * (CORNERS * half) @ axes)
    back = _seen_from_base(scene, middle + directions[int(score.argmax())]) - _seen_from_base(scene, middle)
    return _fitted_camera(corners, back, aspect)


def scene_extent(scene: Scene) -> tuple[Array, float]:
    """Find centre (3,) and diagonal [m] of the drawn geoms, in the modelled geometry."""
    points = _corners(scene)
    low, high = points.min(axis=0), points.max(axis=0)
    return 0.5 * (low + high), float(np.linalg.norm(high - low)) or 1.0


def _corners(scene: Scene) -> Array:
    """Find the corners of the boxes around all finite geoms, world frame, (n, 3)."""
    boxes = [
        (body.position, body.orientation, geom.position, geom.orientation, half)
        for body in scene.bodies
        for geom in body.geoms
        if np.isfinite(half := reach(geom)).all()
    ]
    if not boxes:
        return np.array([body.position for body in scene.bodies])
    at, turn, inside, turned, half = (np.array(part)[:, None] for part in zip(*boxes, strict=True))
    corners: Array = at + rotate(turn, inside + rotate(turned, half * CORNERS))
    return corners.reshape(-1, 3)


def reach(geom: Geom) -> Array:
    """Find the half lengths of the box around a geom [m], (3,); infinite for an endless plane."""
    size = geom.size
    if geom.shape == "sphere":
        return np.full(3, size[0])
    if geom.shape == "cylinder":
        return np.array([size[0], size[0], size[1]])
    if geom.shape == "capsule":
        return np.array([size[0], size[0], size[0] + size[1]])
    if geom.shape == "mesh":
        return np.abs(geom.vertices).max(axis=0) if geom.vertices.size else np.zeros(3)
    if geom.shape == "plane":
        return np.array([half if half > 0.0 else np.inf for half in size[:2]] + [0.0])
    return np.asarray(size)


def _hidden(scene: Scene, eyes: Array, targets: Array) -> Array:
    """Compute the fraction of the targets (m, 3) that is hidden from each eye (n, 3), (n,)."""
    clear = np.ones((len(eyes), len(targets)))
    for body in scene.bodies:
        for geom in body.geoms:
            if not np.isfinite(reach(geom)).all():
                continue
            back = conjugate(multiply(body.orientation, geom.orientation))
            center = body.position + rotate(body.orientation, geom.position)
            start, stop = rotate(back, targets - center), rotate(back, eyes - center)
            # whether the segments from the targets to the eyes pass through the box about the geom
            ray = stop[:, None] - start[None]
            ray = np.where(np.abs(ray) < 1e-12, 1e-12, ray)
            sides = (-reach(geom) - start[None]) / ray, (reach(geom) - start[None]) / ray
            enter, leave = np.minimum(*sides).max(axis=-1), np.maximum(*sides).min(axis=-1)
            cut = (enter < leave) & (leave > 0.0) & (enter < 1.0)
            clear = np.where(cut, clear * (1.0 - geom.rgba[3]), clear)
    return 1.0 - clear.mean(axis=1)


def _seen_from_base(scene: Scene, points: Array) -> Array:
    """Transform points (.., 3) into the frame of the base, if the base moves."""
    body = next((body for body in scene.bodies if body.name == scene.base and body.moves), None)
    return points if body is None else rotate(conjugate(body.orientation), points - body.position)
