"""The limits of the payload that a model states: <numeric name="limit/acceleration/rack" data="98.1"/>."""

from collections.abc import Mapping, Sequence

import mujoco

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import BETWEEN, SIZES, PayloadLimit

LIMIT, POINT = "limit/", "point/"
COMBINED = LIMIT + "combined_travel"


def judges_combined_travel(model: mujoco.MjModel) -> bool:
    """Return whether mounts are judged on all axes at once: unless the model says 0 for it."""
    return all(model.numeric(i).data.any() for i in range(model.nnumeric) if model.numeric(i).name.endswith(COMBINED))


def declared_limits(model: mujoco.MjModel, base: int) -> tuple[PayloadLimit, ...]:
    """Return the limits in the order of the model; the name is what stands before and after `limit/KIND/`, joined.

    Raises:
        ModelError: a limit names no body of the payload and no point, is of an unknown kind, or has the wrong number of values.
    """
    known = limit_subjects(model, base)
    limits: list[PayloadLimit] = []
    for i in range(model.nnumeric):
        name = model.numeric(i).name
        if LIMIT not in name or name.endswith(COMBINED):
            continue
        prefix, _, rest = name.partition(LIMIT)
        kind, _, subject = rest.partition("/")
        if kind not in SIZES:
            raise ModelError(f"numeric {name!r}: a limit is called limit/KIND/NAME, KIND one of {', '.join(SIZES)}.")
        known_there = known[kind]
        if prefix + subject not in known_there and BETWEEN in subject:
            subject = BETWEEN.join(prefix + one if number else one for number, one in enumerate(subject.split(BETWEEN)))
        subject = prefix + subject
        if not is_subject(subject, kind, known):
            raise ModelError(
                f"numeric {name!r}: there is no body of the payload and no point/ site {subject!r} with {kind}. "
                f"There are {known_there or 'none'}."
            )
        try:
            limit = PayloadLimit(kind=kind, name=subject, values=tuple(model.numeric(i).data.tolist()))
        except ValueError as error:
            raise ModelError(f"numeric {name!r}: {error}") from None
        if any((other.kind, other.name) == (kind, subject) for other in limits):
            raise ModelError(f"numeric {name!r}: the {kind} of {subject!r} is limited twice.")
        limits.append(limit)
    return tuple(limits)


def is_subject(name: str, kind: str, known: Mapping[str, Sequence[str]]) -> bool:
    """Return whether a limit of this kind may be on this: a body or a point, or for a clearance two points."""
    if name in known[kind]:
        return True
    ends = name.split(BETWEEN)
    return kind == "clearance" and len(ends) == 2 and ends[0] != ends[1] and set(ends) <= set(known["point"])


def limit_subjects(model: mujoco.MjModel, base: int) -> dict[str, list[str]]:
    """Return the names of the bodies and points that a limit of each kind may be on, and all points as "point"."""
    points = [model.site(s).name.replace(POINT, "", 1) for s in range(model.nsite) if POINT in model.site(s).name]
    bodies = [b for b in range(1, model.nbody) if model.body_weldid[b] not in (0, base)]
    shaped = [b for b in bodies if model.body_geomnum[b]]  # a body without geoms has no corners
    return {
        "acceleration": [*(model.body(b).name for b in bodies), *points],
        "clearance": [*(model.body(b).name for b in shaped), *points],
        "point": points,
    }
