"""Bodies in a recording: the tree of frames on the base, geoms as shapes, the mesh of a coil, and bending bodies."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import rerun as rr
import scipy

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.scene import Geom, SceneBody, SceneMount
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.colours import NET
from wirerope_mj.views.recording.paths import Rows, Stream, at, child, entity

# Bodies that move less are fixed to each other [m], per metre of arm for rotations; far below a pixel
_SAME = 1e-6
_CHECKED_ROWS = 1000


@dataclass(frozen=True, kw_only=True)
class Frame:
    """The frame of a body in that of its parent body, over time."""

    path: str  # entity of the body
    position: Array  # centre of mass in the parent's frame [m], (n_t, 3), or (1, 3) if it never moves there
    orientation: Array  # quaternion w first, (n_t, 4) or (1, 4)

    @property
    def fixed(self) -> bool:
        return self.position.shape[0] == 1


def frames_of(response: Response) -> dict[str, Frame]:
    """Find the frame of every body of the scene by name; the base comes first."""
    base = response.scene.base if response.scene.base in response.bodies else ""
    world = entity("world")
    frames: dict[str, Frame] = {}
    free: list[str] = []  # bodies that move in the base's frame
    if base:
        driven = response.bodies[base]
        frames[base] = Frame(path=child(world, base), position=driven.position, orientation=driven.orientation)
    for body in response.scene.bodies:
        if body.name in frames:
            continue
        if not (body.moves and body.name in response.bodies):
            path = world if body.name == "world" else child(world, body.name)
            frames[body.name] = Frame(path=path, position=body.position[None], orientation=body.orientation[None])
            continue
        parent = None  # the first in whose frame the body never moves
        some = slice(None, None, max(1, response.time.size // _CHECKED_ROWS))
        for carrier in [*([base] if base else []), *free]:
            position, orientation = relative_pose(response, body.name, carrier, some)
            aligned = orientation * np.sign(orientation @ orientation[0])[:, None]
            if max(np.ptp(position, axis=0).max(), np.ptp(aligned, axis=0).max()) < _SAME:
                parent = carrier
                break
        if parent is None:
            free.append(body.name)
        position, orientation = relative_pose(response, body.name, parent if parent is not None else base)
        few = slice(0, 1) if parent is not None else slice(None)
        path = child(frames[parent or base].path if parent or base else world, body.name)
        frames[body.name] = Frame(path=path, position=position[few], orientation=orientation[few])
    return frames


def relative_pose(response: Response, name: str, carrier: str, rows: slice = slice(None)) -> tuple[Array, Array]:
    """Find position (n_t, 3) and orientation (n_t, 4) of a body in the frame of another one; "" is the world."""
    position, orientation = response.bodies[name].position[rows], response.bodies[name].orientation[rows]
    if not carrier:
        return position, orientation
    moved = response.bodies[carrier]
    back = conjugate(moved.orientation[rows])
    return rotate(back, position - moved.position[rows]), multiply(back, orientation)


def rotate(quaternion: Array, vector: Array) -> Array:
    """Turn vectors (..., 3) by quaternions (..., 4), w first."""
    w, u = quaternion[..., :1], quaternion[..., 1:]
    return vector + 2.0 * np.cross(u, np.cross(u, vector) + w * vector)


def conjugate(quaternion: Array) -> Array:
    return quaternion * np.array([1.0, -1.0, -1.0, -1.0])


def multiply(a: Array, b: Array) -> Array:
    """Multiply quaternions (..., 4), w first."""
    w, u = a[..., :1], a[..., 1:]
    real = w * b[..., :1] - np.sum(u * b[..., 1:], axis=-1, keepdims=True)
    return np.concatenate([real, w * b[..., 1:] + b[..., :1] * u + np.cross(u, b[..., 1:])], axis=-1)


def grown(position: Array, orientation: Array, about: Array, turned: Array, factor: float) -> tuple[Array, Array]:
    """Enlarge poses by `factor`: positions (n_t, 3) from `about`, quaternions (n_t, 4) from `turned`."""
    turn = multiply(orientation, conjugate(turned))
    turn = turn * np.where(turn[:, :1] < 0.0, -1.0, 1.0)
    turn[:, 1:] *= factor
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return about + factor * (position - about), multiply(turn, np.broadcast_to(turned, turn.shape))


def quaternion_of(matrix: Array) -> Array:
    """Convert a rotation matrix (3, 3) to a quaternion (4,), w first."""
    quaternion: Array = scipy.spatial.transform.Rotation.from_matrix(matrix).as_quat(scalar_first=True)
    return quaternion


_COILS = 8  # turns of the rope
_AROUND = 28  # sections of one turn of the rope
_SECTION = 7  # corners of the rope's cross-section
_ROPE = 0.075  # diameter of the rope over the width of the device, as in catalogue drawings
_LENGTH = 1.9  # length of the bars over the width


def draw_geoms(rec: Stream, path: str, geoms: Sequence[Geom], extent: float) -> None:
    """Log the geoms of a body: those of one shape together, because every entity costs two kilobytes; meshes alone.

    They stand in the body's axes about its centre of mass; `extent` [m] of the scene is for planes without an end.
    """
    for shape in dict.fromkeys(geom.shape for geom in geoms):
        same = [geom for geom in geoms if geom.shape == shape]
        if shape in ("mesh", "plane"):
            for number, geom in enumerate(same):
                corners, triangles = geom.vertices, geom.faces
                if shape == "plane":
                    x, y = (half if half > 0.0 else 2.0 * extent for half in geom.size[:2])
                    corners = np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]])
                    triangles = np.array([[0, 1, 2], [0, 2, 3]])
                mesh = rr.Mesh3D(
                    vertex_positions=geom.position + rotate(geom.orientation, corners),
                    triangle_indices=triangles.astype(np.uint32), albedo_factor=rgba8(geom.rgba),
                )  # fmt: skip
                rec.log(child(path, "geoms", geom.name or f"{shape}_{number}"), mesh, static=True)
        else:
            rec.log(child(path, "geoms", shape), _solids(shape, same), static=True)


def quaternion(orientation: Array) -> rr.Quaternion:
    """Convert a quaternion (4,), w first, to a quaternion of rerun."""
    return rr.Quaternion(xyzw=np.roll(orientation, -1))


def drawn_size(mount: SceneMount, extent: float) -> tuple[float, float]:
    """Find height and width [m] of a mount; unknown sizes suit a scene of `extent` [m]."""
    height = mount.height if np.isfinite(mount.height) else float(np.clip(0.03 * extent, 0.01, 0.1))
    return height, mount.width if np.isfinite(mount.width) else 1.1 * height


def _solids(shape: str, geoms: list[Geom]) -> rr.AsComponents:
    """Make the boxes, cylinders, capsules or ellipsoids of rerun that draw geoms of one shape."""
    sizes = np.array([geom.size for geom in geoms])
    centers = np.array([geom.position for geom in geoms])
    common = {
        "quaternions": [quaternion(geom.orientation) for geom in geoms], "colors": [rgba8(geom.rgba) for geom in geoms],
        "labels": [geom.name for geom in geoms], "show_labels": False, "fill_mode": "Solid",
    }  # fmt: skip
    if shape == "box":
        return rr.Boxes3D(half_sizes=sizes, centers=centers, **common)
    if shape == "cylinder":
        return rr.Cylinders3D(lengths=2.0 * sizes[:, 1], radii=sizes[:, 0], centers=centers, **common)
    if shape == "capsule":
        # A capsule of rerun runs from its origin along z; MuJoCo's is centred.
        axes = np.array([rotate(geom.orientation, np.array([0.0, 0.0, 1.0])) for geom in geoms])
        starts = centers - sizes[:, 1:2] * axes
        return rr.Capsules3D(lengths=2.0 * sizes[:, 1], radii=sizes[:, 0], translations=starts, **common)
    halves = np.repeat(sizes[:, :1], 3, axis=1) if shape == "sphere" else sizes
    return rr.Ellipsoids3D(half_sizes=halves, centers=centers, **common)


def rgba8(rgba: Array) -> list[int]:
    """Convert a colour (4,) from 0 to 1 into bytes from 0 to 255."""
    return [int(part) for part in np.round(np.clip(rgba, 0.0, 1.0) * 255)]


def coil(width: float) -> tuple[Array, npt.NDArray[np.uint32], Array]:
    """Mesh a wire rope wound around two bars: vertices, triangles, normals.

    x is across the bars (roll), y along them (shear), z from the base's bar at 0 to the payload's bar at 1: the height
    is left to the transform, which stretches and shears.
    """
    turns = np.linspace(0.0, 2.0 * np.pi * _COILS, _COILS * _AROUND + 1)
    length = _LENGTH * width * 0.92
    wire = np.column_stack(
        [0.5 * width * (1.0 - _ROPE) * np.sin(turns), length * (turns / turns[-1] - 0.5), 0.5 * (1.0 - np.cos(turns))]
    )
    angle = np.linspace(0.0, 2.0 * np.pi, _SECTION, endpoint=False)
    out = np.column_stack([np.sin(turns), np.zeros_like(turns), -np.cos(turns)])  # away from the middle of the turn
    normals = np.cos(angle)[None, :, None] * out[:, None] + np.sin(angle)[None, :, None] * np.array([0.0, 1.0, 0.0])
    # z is in heights and x in metres: the section is round where the height is about the width.
    scale = 0.5 * _ROPE * np.array([width, width, 1.0])
    return wrap(wire[:, None] + normals * scale, normals)


def block(width: float) -> tuple[Array, npt.NDArray[np.uint32], Array]:
    """Mesh a waisted rubber block of unit height: vertices, triangles, normals, in the axes of `coil`."""
    z = np.linspace(0.0, 1.0, 9)
    radius = 0.5 * width * (1.0 - 0.22 * np.sin(np.pi * z))
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    normals = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)[None].repeat(z.size, axis=0)
    vertices = normals * radius[:, None, None] + z[:, None, None] * np.array([0.0, 0.0, 1.0])
    return wrap(vertices, normals)


def wrap(vertices: Array, normals: Array) -> tuple[Array, npt.NDArray[np.uint32], Array]:
    """Mesh a tube: vertices and normals are (n_along, n_around, 3)."""
    along, around = vertices.shape[:2]
    i, j = np.meshgrid(np.arange(along - 1), np.arange(around), indexing="ij")
    a, b = i * around + j, i * around + (j + 1) % around
    triangles = np.stack([a, b, a + around, b, b + around, a + around], axis=-1).reshape(-1, 3)
    return vertices.reshape(-1, 3), triangles.astype(np.uint32), normals.reshape(-1, 3)


_FAINT = 0.2  # opacity of a bending body, which is drawn unbent behind its net


def bending_at(response: Response, mount: SceneMount, body: str, rows: Rows) -> Array:
    """Find the displacement by bending of a mount's point on a body [m], in the body's axes, (n, 3).

    It follows from the mount's other point and its deflection. It is 0 if the body does not bend, or if the bodies at both ends
    do, whose shares are then unknown.
    """
    names = {mount.base_body, mount.payload_body}
    bending = {body.name for body in response.scene.bodies if body.bends and body.name in names}
    if bending != {body} or names - response.bodies.keys():
        return np.zeros((rows.size, 3))
    position, orientation = relative_pose(response, (names - {body}).pop(), body)
    stretched = response.mounts[mount.name].deflection[rows] @ mount.axes.T
    if body == mount.base_body:
        return np.asarray(position[rows] + rotate(orientation[rows], mount.payload_point) - stretched - mount.base_point)
    return np.asarray(position[rows] + rotate(orientation[rows], mount.base_point + stretched) - mount.payload_point)


def see_through(body: SceneBody) -> Sequence[Geom]:
    """List the geoms of a body, transparent if it bends."""
    return [replace(geom, rgba=geom.rgba * [1.0, 1.0, 1.0, _FAINT]) for geom in body.geoms] if body.bends else body.geoms


def log_bending(rec: Stream, frames: Mapping[str, Frame], response: Response, rows: Rows, factor: float) -> None:
    """Log a net through the mounts' points on each body that bends, bending enlarged."""
    for body in (bent.name for bent in response.scene.bodies if bent.bends):
        points = [
            (mount, mount.base_point if mount.base_body == body else mount.payload_point)
            for mount in response.scene.mounts if body in (mount.base_body, mount.payload_body)
        ]  # fmt: skip
        if len(points) < 2:
            continue
        feet = np.array([point for _, point in points])
        bent = np.stack([bending_at(response, mount, body, rows) for mount, _ in points], axis=1)
        ends = (feet + factor * (bent - bent[0]))[:, _edges(feet)]  # (n_t, n_edges, 2, 3)
        net = child(frames[body].path, "bending")
        rec.log(net, rr.LineStrips3D.from_fields(colors=[NET], radii=[rr.Radius.ui_points(3.0)]), static=True)
        strips = rr.LineStrips3D.columns(strips=ends.reshape(-1, 2, 3)).partition(np.full(rows.size, ends.shape[1]))
        rec.send_columns(net, at(response.time[rows]), strips)


def _edges(feet: Array) -> Array:
    """Pair neighbouring feet of one level, (n, 2): edges of triangles from above, or a chain if they lie in a line."""
    try:
        corners = scipy.spatial.Delaunay(feet[:, :2]).simplices
    except (scipy.spatial.QhullError, ValueError):  # in one line, or fewer than three
        order = np.lexsort(feet.T)
        return np.stack([order[:-1], order[1:]], axis=1)
    pairs = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    apart = np.abs(feet[pairs[:, 0]] - feet[pairs[:, 1]])
    return np.unique(pairs[apart[:, 2] <= 0.5 * apart[:, :2].max(axis=1)], axis=0)
