"""The limits of the payload that a model states: <numeric name="limit/acceleration/rack" data="98.1"/>."""

import mujoco

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import SIZES, PayloadLimit

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
        subject = prefix + subject
        if subject not in known[kind]:
            raise ModelError(
                f"numeric {name!r}: there is no body of the payload and no point/ site {subject!r} with {kind}. "
                f"There are {known[kind] or 'none'}."
            )
        try:
            limit = PayloadLimit(kind=kind, name=subject, values=tuple(model.numeric(i).data.tolist()))
        except ValueError as error:
            raise ModelError(f"numeric {name!r}: {error}") from None
        if any((other.kind, other.name) == (kind, subject) for other in limits):
            raise ModelError(f"numeric {name!r}: the {kind} of {subject!r} is limited twice.")
        limits.append(limit)
    return tuple(limits)


def limit_subjects(model: mujoco.MjModel, base: int) -> dict[str, list[str]]:
    """Return the names of the bodies and points that a limit of each kind may be on."""
    points = [model.site(s).name.replace(POINT, "", 1) for s in range(model.nsite) if POINT in model.site(s).name]
    bodies = [b for b in range(1, model.nbody) if model.body_weldid[b] not in (0, base)]
    shaped = [b for b in bodies if model.body_geomnum[b]]  # a body without geoms has no corners
    return {
        "acceleration": [*(model.body(b).name for b in bodies), *points],
        "clearance": [*(model.body(b).name for b in shaped), *points],
    }
