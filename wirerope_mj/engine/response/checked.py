"""The metadata of a response's file, made into its parts, and held against each other and against the columns."""

import base64
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wirerope_mj.engine.response.histories import ColumnPlan, Numerics
from wirerope_mj.engine.response.peaks import KINDS, Peak, Peaks
from wirerope_mj.engine.response.scene import Scene
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import BETWEEN
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.structure import Place, keys_of, structure
from wirerope_mj.motions import RandomVibration, motion_from_dict
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.isolator.travel import RATINGS

_UNIT = 1e-6  # by which the length of a stored quaternion may differ from 1: far above rounding, far below a turn that shows


@dataclass(frozen=True, kw_only=True)
class Metadata:
    """Metadata of a response's file."""

    bodies: tuple[str, ...]
    points: tuple[str, ...]
    mounts: tuple[tuple[str, tuple[str, ...]], ...]  # names, and names of the internal states
    contacts: tuple[str, ...] = ()  # older responses have none
    peaks: Peaks
    scene: Scene
    motion: Entries
    events: tuple[tuple[float, str], ...]
    numerics: Numerics
    states: tuple[tuple[float, str], tuple[float, str]]  # the first and the last

    @cached_property
    def plan(self) -> ColumnPlan:
        return ColumnPlan(bodies=self.bodies, points=self.points, mounts=self.mounts, contacts=self.contacts)

    def __post_init__(self) -> None:
        if len(set(self.plan.names)) < len(self.plan.names):
            raise ValueError("`bodies`, `points` or `mounts` name one thing twice.")
        for name, states in self.mounts:
            if strange := [state for state in states if state.split(".")[0] not in AXES]:
                raise ValueError(f"`mounts` {name!r}: a state must begin with {', '.join(AXES)}, got {quoted(strange[0])}.")
        mounts = [name for name, _ in self.mounts]
        named = {"bodies": self.bodies, "points": self.points, "mounts": mounts, "travels": mounts}
        for group in (*KINDS, *(["travels"] if self.peaks.travels is not None else [])):
            if sorted(named[group]) != sorted(getattr(self.peaks, group)):
                raise ValueError(f"`peaks` `{group}` must be of {', '.join(named[group]) or 'none'}.")
        self._check_scene(mounts)
        check_motion("motion", self.motion)
        sizes = {len(_state(text)) for _, text in self.states}
        if len(sizes) > 1:
            raise ValueError("`states` must be of one size, the first and the last.")

    def _check_scene(self, mounts: Sequence[str]) -> None:
        """Raise ValueError unless bodies, mounts, limits and geoms of the scene fit the response and each other."""
        bodies = [body.name for body in self.scene.bodies]
        if not all(bodies.count(name) == 1 for name in self.bodies):  # bodies without a name may be several
            raise ValueError(f"`scene` `bodies` must name each of {', '.join(self.bodies)} once, got {', '.join(bodies)}.")
        if sorted(mount.name for mount in self.scene.mounts) != sorted(mounts):
            raise ValueError(f"`scene` `mounts` must be those of the response, {', '.join(mounts) or 'none'}.")
        for mount in self.scene.mounts:
            for key in ("payload_body", "base_body"):
                one_of(f"scene.mounts.{mount.name}.{key}", getattr(mount, key), (*bodies, "world"))
            for rating in mount.travel:
                one_of(f"scene.mounts.{mount.name}.travel", rating, RATINGS)
        known = (*bodies, *self.points, *mounts)
        for limit in self.scene.limits:
            for end in [limit.name] if limit.name in known else limit.name.split(BETWEEN):
                one_of("scene.limits", end, known)
        for body in self.scene.bodies:
            for orientation in (body.orientation, *(geom.orientation for geom in body.geoms)):
                if abs(math.hypot(*orientation) - 1.0) > _UNIT:
                    raise ValueError(f"`scene` {body.name!r}: `orientation` must be a quaternion of length 1.")
            for geom in body.geoms:
                if geom.faces.size and not (geom.faces.min() >= 0 and geom.faces.max() < len(geom.vertices)):
                    last = len(geom.vertices) - 1
                    raise ValueError(f"`scene` {body.name!r}: `faces` must number vertices from 0 to {last}.")
                if geom.shape == "mesh" and not len(geom.vertices):
                    raise ValueError(f"`scene` {body.name!r}: `vertices` must not be empty: its shape is a mesh.")


def read_metadata(content: Entries, columns: Sequence[str], place: Place) -> Metadata:
    """Rebuild a response's metadata from its stored `content`; raises the error of `place` unless it fits these columns."""

    def peak(value: object, place: Place) -> Peak:
        numbers = value if isinstance(value, list) and all(type(number) in (int, float) for number in value) else []
        if len(numbers) != Peak.SIZE or not all(map(math.isfinite, numbers)):
            raise place.fault(f"it must be {Peak.SIZE} finite numbers, got {quoted(value, 60)}.")
        return Peak.from_list(numbers)

    known = {key: value for key, value in content.items() if key in keys_of(Metadata)}
    metadata = structure(Metadata, known, place, {Peak: peak})
    if list(columns) != metadata.plan.names:
        missing = [name for name in metadata.plan.names if name not in columns]
        unknown = [name for name in columns if name not in metadata.plan.names]
        first = f"{missing[0]!r} is missing" if missing else f"{unknown[0]!r} is unknown" if unknown else "their order"
        raise place.fault(f"its columns are not those of its bodies, points and mounts: {first}.")
    return metadata


def check_motion(key: str, motion: object) -> None:
    """Raise ValueError naming the key unless `motion` has the form that `BaseMotion.to_dict` writes."""
    if not isinstance(motion, dict) or not isinstance(motion.get("kind"), str):
        raise ValueError(f"`{key}` must be a table with a `kind`, got {quoted(motion, 60)}.")
    if not isinstance(motion.get("path", ""), str):
        raise ValueError(f"`{key}.path` must be a text, got {quoted(motion['path'], 60)}.")
    terms = motion.get("terms", [])
    if not isinstance(terms, list):
        raise ValueError(f"`{key}.terms` must be a list, got {quoted(terms, 60)}.")
    for number, term in enumerate(terms):
        check_motion(f"{key}.terms.{number}", term)
    if "motion" in motion:
        check_motion(f"{key}.motion", motion["motion"])
    if motion["kind"] == RandomVibration.kind:  # criteria make it again
        try:
            motion_from_dict({name: value for name, value in motion.items() if name != "description"})
        except (ModelError, ValueError) as error:
            raise ValueError(f"`{key}`: {error}") from None


def _state(text: str) -> bytes:
    try:
        content = base64.b64decode(text, validate=True)
        values = np.frombuffer(content, dtype="<f8")
    except ValueError:
        raise ValueError("`states` must be float64 numbers in base64.") from None
    if not np.isfinite(values).all():
        raise ValueError(f"`states` must be finite; number {int(np.argmin(np.isfinite(values)))} is not.")
    return content
