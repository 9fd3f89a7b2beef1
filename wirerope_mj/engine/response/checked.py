"""Checks of what stands in a response's file besides its samples: names, shapes, types, finite numbers.

Each raises ValueError that names the key, such as `peaks.bodies.floor.acceleration`, and says what must stand there.
"""

import base64
import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from wirerope_mj.engine.response.columns import ColumnPlan
from wirerope_mj.engine.response.contacts import ContactPeak
from wirerope_mj.engine.response.histories import Numerics
from wirerope_mj.engine.response.scene import Geom, Scene, SceneBody, SceneMount
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.motions import RandomVibration, motion_from_dict
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import RATINGS

_SHAPES = ("box", "sphere", "capsule", "cylinder", "ellipsoid", "plane", "mesh")
_PEAKS = {
    "bodies": ("acceleration",),
    "points": ("acceleration", "relative_displacement"),
    "mounts": ("deflection", "force"),
}
_PEAK = 17  # numbers of a peak, as `Peak.to_list` writes them
_UNIT = 1e-6  # by which the length of a stored quaternion may differ from 1: far above rounding, far below a turn that shows


def check_content(content: Any, columns: Sequence[str]) -> None:
    """Raise ValueError unless all that `response_metadata` writes stands in `content` and describes these columns."""
    parts = ("peaks", "scene", "motion", "events", "numerics", "states", "bodies", "points", "mounts")
    _table(content, "the metadata", parts)
    plan = _checked_plan(content)
    if list(columns) != plan.names:
        missing = [name for name in plan.names if name not in columns]
        strange = [name for name in columns if name not in plan.names]
        first = f"{missing[0]!r} is missing" if missing else f"{strange[0]!r} is unknown" if strange else "their order"
        raise ValueError(f"its columns are not those of its bodies, points and mounts: {first}.")
    _check_peaks(content["peaks"], plan)
    _check_scene(content["scene"], plan)
    check_motion(content["motion"], "motion")
    for i, event in enumerate(_sequence(content["events"], "events")):
        time, text = _sequence(event, f"events.{i}", 2)
        _number(time, f"events.{i}.0")
        _text(text, f"events.{i}.1")
    _check_numerics(content["numerics"])
    sizes = {_state_size(state, f"states.{i}") for i, state in enumerate(_sequence(content["states"], "states", 2))}
    if len(sizes) > 1:
        raise ValueError("`states` must be of one size, the first and the last.")


def _checked_plan(content: Mapping[str, Any]) -> ColumnPlan:
    for room in ("bodies", "points"):
        for i, name in enumerate(_sequence(content[room], room)):
            _text(name, f"{room}.{i}")
    mounts = []
    for i, mount in enumerate(_sequence(content["mounts"], "mounts")):
        name, states = _sequence(mount, f"mounts.{i}", 2)
        _text(name, f"mounts.{i}.0")
        for j, state in enumerate(_sequence(states, f"mounts.{i}.1")):
            _text(state, f"mounts.{i}.1.{j}")
            if state.split(".")[0] not in AXES:
                raise ValueError(f"`mounts.{i}.1.{j}` must begin with {', '.join(AXES)}, got {state!r}.")
        mounts.append((name, tuple(states)))
    plan = ColumnPlan(bodies=content["bodies"], points=content["points"], mounts=mounts)
    if len(set(plan.names)) < len(plan.names):
        raise ValueError("`bodies`, `points` or `mounts` name one thing twice.")
    return plan


def _check_peaks(peaks: Any, plan: ColumnPlan) -> None:
    _table(peaks, "peaks", tuple(_PEAKS))
    names = {"bodies": plan.bodies, "points": plan.points, "mounts": [name for name, _ in plan.mounts]}
    for room, quantities in _PEAKS.items():
        _table(peaks[room], f"peaks.{room}", names[room], exactly=True)
        for name, entry in peaks[room].items():
            _table(entry, f"peaks.{room}.{name}", quantities, exactly=True)
            for quantity in quantities:
                _numbers(entry[quantity], f"peaks.{room}.{name}.{quantity}", _PEAK)
    contacts = peaks.get("contacts")  # older responses have none
    if contacts is not None:
        _table(contacts, "peaks.contacts", ())
        for name, contact in contacts.items():
            _check_contact(contact, f"peaks.contacts.{name}")


def _check_contact(contact: Any, where: str) -> None:
    _record(contact, where, ContactPeak)
    for key in ("geoms", "bodies"):
        for i, name in enumerate(_sequence(contact[key], f"{where}.{key}", 2)):
            _text(name, f"{where}.{key}.{i}")
    for key in ("touches", "duration", "force", "penetration"):
        _number(contact.get(key, 0.0), f"{where}.{key}")
    for key in ("first_touch", "force_time", "penetration_time"):
        if contact.get(key) is not None:  # of a pair that never touched
            _number(contact[key], f"{where}.{key}")
    if not isinstance(contact.get("from_start", False), bool):
        raise ValueError(f"`{where}.from_start` must be true or false, got {_shown(contact['from_start'])}.")


def _check_scene(scene: Any, plan: ColumnPlan) -> None:
    _record(scene, "scene", Scene)
    for i, body in enumerate(_sequence(scene["bodies"], "scene.bodies")):
        _check_body(body, f"scene.bodies.{i}")
    bodies = [body["name"] for body in scene["bodies"]]
    if not all(bodies.count(name) == 1 for name in plan.bodies):  # bodies without a name may be several
        raise ValueError(f"`scene.bodies` must name each of {', '.join(plan.bodies)} once, got {', '.join(bodies)}.")
    for i, mount in enumerate(_sequence(scene["mounts"], "scene.mounts")):
        _check_mount(mount, f"scene.mounts.{i}", bodies)
    mounts = [mount["name"] for mount in scene["mounts"]]
    if sorted(mounts) != sorted(name for name, _ in plan.mounts):
        raise ValueError(f"`scene.mounts` must be the mounts of the response, got {', '.join(mounts) or 'none'}.")
    for i, limit in enumerate(_sequence(scene.get("limits", []), "scene.limits")):  # older responses have none
        where = f"scene.limits.{i}"
        _record(limit, where, PayloadLimit)
        _numbers(limit["values"], f"{where}.values")
        if limit["name"] not in (*bodies, *plan.points):
            raise ValueError(f"`{where}.name` must be a body or a point of the response, got {limit['name']!r}.")
        try:
            PayloadLimit(kind=limit["kind"], name=limit["name"], values=tuple(limit["values"]))
        except ValueError as error:
            raise ValueError(f"`{where}`: {error}") from None


def _check_body(body: Any, where: str) -> None:
    _record(body, where, SceneBody)
    for key in ("moves", "on_base"):
        if not isinstance(body[key], bool):
            raise ValueError(f"`{where}.{key}` must be true or false, got {body[key]!r}.")
    _numbers(body["position"], f"{where}.position", 3)
    _quaternion(body["orientation"], f"{where}.orientation")
    for i, geom in enumerate(_sequence(body["geoms"], f"{where}.geoms")):
        place = f"{where}.geoms.{i}"
        _record(geom, place, Geom)
        if geom["shape"] not in _SHAPES:
            raise ValueError(f"`{place}.shape` must be one of {', '.join(_SHAPES)}, got {geom['shape']!r}.")
        for key, size in (("size", 3), ("position", 3), ("rgba", 4)):
            _numbers(geom[key], f"{place}.{key}", size)
        _quaternion(geom["orientation"], f"{place}.orientation")
        vertices = _sequence(geom.get("vertices", []), f"{place}.vertices")
        for i_vertex, vertex in enumerate(vertices):
            _numbers(vertex, f"{place}.vertices.{i_vertex}", 3)
        for i_face, face in enumerate(_sequence(geom.get("faces", []), f"{place}.faces")):
            _numbers(face, f"{place}.faces.{i_face}", 3)
            if not all(0 <= number < len(vertices) for number in face):
                raise ValueError(f"`{place}.faces.{i_face}` must number vertices from 0 to {len(vertices) - 1}.")
        if geom["shape"] == "mesh" and not vertices:
            raise ValueError(f"`{place}.vertices` must not be empty: its shape is a mesh.")


def _check_mount(mount: Any, where: str, bodies: Sequence[str]) -> None:
    _record(mount, where, SceneMount)
    for key in ("payload_body", "base_body"):
        if mount[key] not in (*bodies, "world"):
            raise ValueError(f"`{where}.{key}` must be a body of the scene, got {mount[key]!r}.")
    if not isinstance(mount.get("stop", False), bool):  # older responses have none
        raise ValueError(f"`{where}.stop` must be true or false, got {_shown(mount['stop'])}.")
    for key in ("payload_point", "base_point"):
        _numbers(mount[key], f"{where}.{key}", 3)
    for i, row in enumerate(_sequence(mount["axes"], f"{where}.axes", 3)):
        _numbers(row, f"{where}.axes.{i}", 3)
    for key in ("height", "width", "static_load"):
        _positive(mount[key], f"{where}.{key}", or_nan=True)
    _table(mount["travel"], f"{where}.travel", ())
    for rating, travel in mount["travel"].items():
        if rating not in RATINGS:
            raise ValueError(f"`{where}.travel` may hold {', '.join(RATINGS)}, got {rating!r}.")
        _positive(travel, f"{where}.travel.{rating}")


def check_motion(motion: Any, where: str) -> None:
    """Raise ValueError that names the key unless `motion` is built as `BaseMotion.to_dict` writes one."""
    _table(motion, where, ("kind",))
    for key in ("kind", "path"):
        _text(motion.get(key, ""), f"{where}.{key}")
    for i, term in enumerate(_sequence(motion.get("terms", []), f"{where}.terms")):
        check_motion(term, f"{where}.terms.{i}")
    if "motion" in motion:
        check_motion(motion["motion"], f"{where}.motion")
    if motion["kind"] == RandomVibration.kind:  # criteria make it again
        try:
            motion_from_dict({key: value for key, value in motion.items() if key != "description"})
        except (ModelError, ValueError) as error:
            raise ValueError(f"`{where}`: {error}") from None


def _check_numerics(numerics: Any) -> None:
    _record(numerics, "numerics", Numerics)
    _positive(numerics["timestep"], "numerics.timestep")
    _positive(numerics["accuracy"], "numerics.accuracy", or_nan=True)
    if not isinstance(numerics["error_estimate"], float | int) or numerics["error_estimate"] < 0.0:
        raise ValueError(f"`numerics.error_estimate` must be >= 0 or NaN, got {numerics['error_estimate']!r}.")
    if isinstance(numerics["steps"], bool) or not isinstance(numerics["steps"], int) or numerics["steps"] < 0:
        raise ValueError(f"`numerics.steps` must be an integer >= 0, got {numerics['steps']!r}.")
    _table(numerics["versions"], "numerics.versions", ())
    for name, version in numerics["versions"].items():
        _text(version, f"numerics.versions.{name}")


def _state_size(state: Any, where: str) -> int:
    time, text = _sequence(state, where, 2)
    _number(time, f"{where}.0")
    _text(text, f"{where}.1")
    try:
        values = np.frombuffer(base64.b64decode(text, validate=True), dtype="<f8")
    except ValueError:
        raise ValueError(f"`{where}.1` must be float64 numbers in base64.") from None
    if not np.isfinite(values).all():
        raise ValueError(f"`{where}.1` must be finite; number {int(np.argmin(np.isfinite(values)))} is not.")
    return int(values.size)


def _table(value: Any, where: str, keys: Sequence[str], *, exactly: bool = False) -> None:
    if not isinstance(value, dict):
        raise ValueError(f"`{where}` must be a table, got {_shown(value)}.")
    for key in keys:
        if key not in value:
            raise ValueError(f"`{where}` lacks {key!r}.")
    unknown = [key for key in value if key not in keys]
    if exactly and unknown:
        raise ValueError(f"`{where}` has an unknown {unknown[0]!r}; known: {', '.join(keys) or 'none'}.")


def _record(value: Any, where: str, kind: Any) -> None:
    """Check the keys of a stored dataclass, and all of its texts."""
    known = {field.name: field for field in fields(kind)}
    needed = [name for name, field in known.items() if field.default is MISSING and field.default_factory is MISSING]
    _table(value, where, needed)
    _table({key: None for key in value if key not in known}, where, (), exactly=True)
    for name, field in known.items():
        if field.type is str and name in value:
            _text(value[name], f"{where}.{name}")


def _sequence(value: Any, where: str, size: int | None = None) -> list[Any]:
    if not isinstance(value, list) or (size is not None and len(value) != size):
        count = "" if size is None else f" of {size}"
        raise ValueError(f"`{where}` must be a list{count}, got {_shown(value)}.")
    return value


def _text(value: Any, where: str) -> None:
    if not isinstance(value, str):
        raise ValueError(f"`{where}` must be a string, got {_shown(value)}.")


def _numbers(value: Any, where: str, size: int | None = None) -> None:
    if not isinstance(value, list) or len(value) != (len(value) if size is None else size):
        raise ValueError(f"`{where}` must be {'' if size is None else f'{size} '}numbers, got {_shown(value)}.")
    for i, number in enumerate(value):
        _number(number, f"{where}.{i}")


def _number(value: Any, where: str) -> None:
    if not _is_finite(value):
        raise ValueError(f"`{where}` must be a finite number, got {_shown(value)}.")


def _positive(value: Any, where: str, *, or_nan: bool = False) -> None:
    if or_nan and isinstance(value, float) and math.isnan(value):
        return
    if not _is_finite(value) or value <= 0.0:
        raise ValueError(f"`{where}` must be a number > 0{' or NaN' if or_nan else ''}, got {_shown(value)}.")


def _is_finite(value: Any) -> bool:
    """Return whether a value is a number that a float can hold; booleans are none."""
    return isinstance(value, int | float) and not isinstance(value, bool) and bool(abs(value) <= np.finfo(float).max)


def _quaternion(value: Any, where: str) -> None:
    _numbers(value, where, 4)
    if abs(math.hypot(*value) - 1.0) > _UNIT:
        raise ValueError(f"`{where}` must be a quaternion of length 1, got {_shown(value)}.")


def _shown(value: Any) -> str:
    """Return a value as a message shows it: not all of a long one."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:56]} .."
