"""Checks of a response's metadata: names, shapes, types, finite numbers.

Each raises ValueError that names the key, such as `peaks.bodies.floor.acceleration`, and says what must stand there.
"""

import base64
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from wirerope_mj.engine.response.histories import ColumnPlan, Numerics
from wirerope_mj.engine.response.peaks import KINDS, CombinedTravel, ContactPeak, Peak
from wirerope_mj.engine.response.scene import Geom, Scene, SceneBody, SceneMount
from wirerope_mj.foundation.arguments import finite, integer, not_negative, one_of, positive
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.motions import RandomVibration, motion_from_dict
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import RATINGS

# takes the key and the value, like the checks of arguments, and raises ValueError
Check = Callable[[str, Any], object]
_SHAPES = ("box", "sphere", "capsule", "cylinder", "ellipsoid", "plane", "mesh")
_UNIT = 1e-6  # by which the length of a stored quaternion may differ from 1: far above rounding, far below a turn that shows


def check_content(content: object, columns: Sequence[str]) -> None:
    """Raise ValueError unless all that `response_metadata` writes stands in `content` and describes these columns."""
    content = _table("the metadata", content, ("peaks", "scene", "motion", "events", "numerics", "states", *KINDS))
    plan = _checked_plan(content)
    if list(columns) != plan.names:
        missing = [name for name in plan.names if name not in columns]
        unknown = [name for name in columns if name not in plan.names]
        first = f"{missing[0]!r} is missing" if missing else f"{unknown[0]!r} is unknown" if unknown else "their order"
        raise ValueError(f"its columns are not those of its bodies, points and mounts: {first}.")
    _check_peaks(content["peaks"], plan)
    _check_scene(content["scene"], plan)
    check_motion("motion", content["motion"])
    _list(_row(finite, _text))("events", content["events"])
    _record(
        Numerics, timestep=positive, accuracy=_or_nan(positive), error_estimate=_estimate,
        steps=lambda key, value: integer(key, value, least=0), versions=_values(_text), motion_end=_or_nan(finite),
        slowest_period=_or_nan(positive),
    )("numerics", content["numerics"])  # fmt: skip
    _list(_row(finite, _state), 2)("states", content["states"])
    if len({len(values) for _, values in content["states"]}) > 1:
        raise ValueError("`states` must be of one size, the first and the last.")


def _checked_plan(content: Entries) -> ColumnPlan:
    for group in ("bodies", "points"):
        _list(_text)(group, content[group])
    _list(_row(_text, _list(_state_name)))("mounts", content["mounts"])
    _list(_text)("contacts", content.get("contacts", []))  # older responses have none
    plan = ColumnPlan.of(content)
    if len(set(plan.names)) < len(plan.names):
        raise ValueError("`bodies`, `points` or `mounts` name one thing twice.")
    return plan


def _check_peaks(peaks: object, plan: ColumnPlan) -> None:
    peaks = _table("peaks", peaks, KINDS)
    names = {"bodies": plan.bodies, "points": plan.points, "mounts": [name for name, _ in plan.mounts]}
    for group, kind in KINDS.items():
        _table(f"peaks.{group}", peaks[group], names[group], known=names[group])
        _values(_record(kind))(f"peaks.{group}", peaks[group])
    if peaks.get("contacts") is not None:  # older responses have none
        _values(_record(ContactPeak))("peaks.contacts", peaks["contacts"])
    if peaks.get("travels") is not None:
        _table("peaks.travels", peaks["travels"], names["mounts"], known=names["mounts"])
        _values(_record(CombinedTravel))("peaks.travels", peaks["travels"])


def _check_scene(scene: Entries, plan: ColumnPlan) -> None:
    _record(
        Scene, bodies=_list(_record(SceneBody, position=_numbers(3), orientation=_quaternion, geoms=_list(_geom))),
        mounts=_list(_mount), limits=_list(_limit), areas=_values(_list(_text)),
    )("scene", scene)  # fmt: skip
    bodies, mounts = ([entry["name"] for entry in scene[group]] for group in ("bodies", "mounts"))
    if not all(bodies.count(name) == 1 for name in plan.bodies):  # bodies without a name may be several
        raise ValueError(f"`scene.bodies` must name each of {', '.join(plan.bodies)} once, got {', '.join(bodies)}.")
    if sorted(mounts) != sorted(name for name, _ in plan.mounts):
        raise ValueError(f"`scene.mounts` must be the mounts of the response, got {', '.join(mounts) or 'none'}.")
    for i, mount in enumerate(scene["mounts"]):
        for key in ("payload_body", "base_body"):
            one_of(f"scene.mounts.{i}.{key}", mount[key], (*bodies, "world"))
    for i, limit in enumerate(scene.get("limits", ())):  # older responses have none
        one_of(f"scene.limits.{i}.name", limit["name"], (*bodies, *plan.points))


def _geom(key: str, geom: Entries) -> None:
    _record(
        Geom, size=_numbers(3), position=_numbers(3), orientation=_quaternion, rgba=_numbers(4),
        vertices=_list(_numbers(3)), faces=_list(_numbers(3)),
    )(key, geom)  # fmt: skip
    one_of(f"{key}.shape", geom["shape"], _SHAPES)
    n_vertices = len(geom.get("vertices", ()))
    for i, face in enumerate(geom.get("faces", ())):
        if not all(0 <= number < n_vertices for number in face):
            raise ValueError(f"`{key}.faces.{i}` must number vertices from 0 to {n_vertices - 1}.")
    if geom["shape"] == "mesh" and not n_vertices:
        raise ValueError(f"`{key}.vertices` must not be empty: its shape is a mesh.")


def _mount(key: str, mount: Entries) -> None:
    point, size = _numbers(3), _or_nan(positive)
    _record(
        SceneMount, payload_point=point, base_point=point, axes=_list(_numbers(3), 3),
        height=size, width=size, bar=size, static_load=size, travel=_values(positive), bolts=_list(size, 3),
    )(key, mount)  # fmt: skip
    _table(f"{key}.travel", mount["travel"], known=RATINGS)


def _limit(key: str, limit: Entries) -> None:
    _record(PayloadLimit, values=_numbers())(key, limit)
    try:
        PayloadLimit(kind=limit["kind"], name=limit["name"], values=tuple(limit["values"]))
    except ValueError as error:
        raise ValueError(f"`{key}`: {error}") from None


def check_motion(key: str, motion: Entries) -> None:
    """Raise ValueError that names the key unless `motion` is built as `BaseMotion.to_dict` writes one."""
    _table(key, motion, ("kind",))
    for name in ("kind", "path"):
        _text(f"{key}.{name}", motion.get(name, ""))
    _list(check_motion)(f"{key}.terms", motion.get("terms", []))
    if "motion" in motion:
        check_motion(f"{key}.motion", motion["motion"])
    if motion["kind"] == RandomVibration.kind:  # criteria make it again
        try:
            motion_from_dict({name: value for name, value in motion.items() if name != "description"})
        except (ModelError, ValueError) as error:
            raise ValueError(f"`{key}`: {error}") from None


def _state(key: str, text: str) -> None:
    _text(key, text)
    try:
        values = np.frombuffer(base64.b64decode(text, validate=True), dtype="<f8")
    except ValueError:
        raise ValueError(f"`{key}` must be float64 numbers in base64.") from None
    if not np.isfinite(values).all():
        raise ValueError(f"`{key}` must be finite; number {int(np.argmin(np.isfinite(values)))} is not.")


def _state_name(key: str, name: str) -> None:
    _text(key, name)
    if name.split(".")[0] not in AXES:
        raise ValueError(f"`{key}` must begin with {', '.join(AXES)}, got {name!r}.")


def _table(key: str, value: object, needed: Collection[str] = (), *, known: Collection[str] | None = None) -> Entries:
    """Check the keys of a table: those it needs, and, unless None, those it may have; returns it."""
    if not isinstance(value, dict):
        raise ValueError(f"`{key}` must be a table, got {_shown(value)}.")
    for name in needed:
        if name not in value:
            raise ValueError(f"`{key}` lacks {name!r}.")
    unknown = [] if known is None else [name for name in value if name not in known]
    if unknown:
        raise ValueError(f"`{key}` has an unknown {unknown[0]!r}; known: {', '.join(known or ()) or 'none'}.")
    return value


def _values(check: Check) -> Check:
    """Check a table's values, whatever its keys."""
    return lambda key, value: [check(f"{key}.{name}", item) for name, item in _table(key, value).items()]


def _record(kind: type, **checks: Check) -> Check:
    """Check a stored dataclass: its keys, and its values by their types unless `checks` names another check."""
    known = {field.name: field for field in fields(kind)}
    needed = [name for name, field in known.items() if field.default is MISSING and field.default_factory is MISSING]
    return lambda key, value: [
        (checks.get(name) or _BY_TYPE[known[name].type])(f"{key}.{name}", item)
        for name, item in _table(key, value, needed, known=known).items()
    ]


def _list(check: Check, size: int | None = None) -> Check:
    """Check a list's items, all by one check."""
    return lambda key, value: [check(f"{key}.{i}", item) for i, item in enumerate(_sequence(key, value, size))]


def _row(*checks: Check) -> Check:
    """Check a list of as many items as checks, each by its own."""
    return lambda key, value: [
        check(f"{key}.{i}", item)
        for i, (check, item) in enumerate(zip(checks, _sequence(key, value, len(checks)), strict=True))
    ]


def _sequence(key: str, value: object, size: int | None) -> list[object]:
    if not isinstance(value, list) or (size is not None and len(value) != size):
        raise ValueError(f"`{key}` must be a list{'' if size is None else f' of {size}'}, got {_shown(value)}.")
    return value


def _numbers(size: int | None = None) -> Check:
    def numbers(key: str, value: object) -> None:
        if not isinstance(value, list) or len(value) != (len(value) if size is None else size):
            raise ValueError(f"`{key}` must be {'' if size is None else f'{size} '}numbers, got {_shown(value)}.")
        _list(finite)(key, value)

    return numbers


def _or_nan(check: Check) -> Check:
    return lambda key, value: None if isinstance(value, float) and math.isnan(value) else check(key, value)


def _or_none(check: Check) -> Check:
    return lambda key, value: None if value is None else check(key, value)


def _estimate(key: str, value: object) -> None:
    if value != math.inf:  # what contacts leave
        _or_nan(not_negative)(key, value)


def _text(key: str, value: object) -> None:
    if not isinstance(value, str):
        raise ValueError(f"`{key}` must be a string, got {_shown(value)}.")


def _boolean(key: str, value: object) -> None:
    if not isinstance(value, bool):
        raise ValueError(f"`{key}` must be true or false, got {_shown(value)}.")


def _quaternion(key: str, value: list[float]) -> None:
    _numbers(4)(key, value)
    if abs(math.hypot(*value) - 1.0) > _UNIT:
        raise ValueError(f"`{key}` must be a quaternion of length 1, got {_shown(value)}.")


def _shown(value: object) -> str:
    """Return a value as a message shows it: not all of a long one."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:56]} .."


_BY_TYPE: dict[object, Check] = {
    str: _text, bool: _boolean, int: finite, float: finite, float | None: _or_none(finite),
    tuple[str, str]: _row(_text, _text), Peak: _numbers(Peak.SIZE),
}  # fmt: skip
