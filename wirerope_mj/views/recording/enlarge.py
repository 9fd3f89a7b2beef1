"""Small motions drawn large: vibration of less than a millimetre cannot be seen in a scene of metres."""

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.animation import with_values
from wirerope_mj.views.recording.mounts import devices_of
from wirerope_mj.views.recording.poses import conjugate, multiply

FRACTION = 0.3  # Fraction of a mount's height that the largest deflection from its mean may take in the picture
_ROUND = (1.0, 2.0, 5.0)


def factor_of(response: Response, extent: float) -> float:
    """Return the round factor by which motions are drawn larger; 1 where they are large enough."""
    room = min((device.height for device in devices_of(response, extent)), default=0.1 * extent)
    moves = [mount.deflection for mount in response.mounts.values()]
    largest = max((float(np.ptp(move, axis=0).max()) / 2.0 for move in moves), default=0.0)
    if largest <= 0.0:
        return 1.0
    return max(round_down(FRACTION * room / largest), 1.0)


def round_down(factor: float) -> float:
    """Return the largest 1, 2 or 5 times a power of ten that is no larger."""
    decade = 10.0 ** np.floor(np.log10(factor))
    return float(decade * max(part for part in _ROUND if part * decade <= factor * (1.0 + 1e-9)))


def enlarged(response: Response, factor: float) -> Response:
    """Return the same motions, `factor` times as far from their mean relative to the base; forces stay as they are.

    Deflections grow alike, so that the mounts still end on the bodies: exactly where these only shift, and in the first
    order of the angle where they turn.
    """
    names = response.samples.names
    values = response.samples.columns(0, len(names)).copy()
    first = {name: column for column, name in enumerate(names)}
    base = response.scene.base
    carrier = response.bodies[base].position if base in response.bodies else np.zeros((1, 3))
    fixed = {body.name for body in response.scene.bodies if body.on_base} | {base}
    for name, body in response.bodies.items():
        if name not in fixed:
            at = first[f"bodies/{name}/position/x"]
            values[:, at : at + 3] = carrier + _grown(body.position - carrier, factor)
            at = first[f"bodies/{name}/orientation/w"]
            values[:, at : at + 4] = _turned(body.orientation, factor)
    for name, mount in response.mounts.items():
        at = first[f"mounts/{name}/deflection/roll"]
        values[:, at : at + 3] = _grown(mount.deflection, factor)
    return with_values(response, values)


def _grown(values: Array, factor: float) -> Array:
    mean = 0.5 * (values.min(axis=0) + values.max(axis=0))
    return np.asarray(mean + factor * (values - mean))


def _turned(orientation: Array, factor: float) -> Array:
    """Return orientations whose rotations from the first one are `factor` times as large."""
    turn = multiply(orientation, conjugate(orientation[:1]))
    turn = turn * np.where(turn[:, :1] < 0.0, -1.0, 1.0)
    turn[:, 1:] = _grown(turn[:, 1:], factor)
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return multiply(turn, orientation[:1])
