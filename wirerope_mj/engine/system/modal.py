"""The modes of flexible parts that a model declares, resolved to ids of the compiled model.

<tuple name="flexible/deck">
<element objtype="body" objname="deck"/>                    the part's body, whose axes its shapes are in
<element objtype="body" objname="mode/deck/1"/>             a body of unit mass on a slide for every mode
<element objtype="numeric" objname="flexible/deck"/>        participations along x, y, z, mode by mode
<element objtype="site" objname="deck/m1"/>                 then every site on it, with its shapes x, y, z, mode by mode
<element objtype="numeric" objname="shapes/deck/m1"/>
</tuple>
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import mujoco
import numpy as np

from wirerope_mj.engine.flexible.part import RESIDUAL
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ModelError

FLEXIBLE = "flexible/"
_BODY, _SITE, _NUMERIC = mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_SITE, mujoco.mjtObj.mjOBJ_NUMERIC


@dataclass(frozen=True, kw_only=True)
class DeclaredMode:
    """A mode of a flexible part: q'' + 2 zeta omega q' + omega^2 q = Phi^T f - Gamma a_base."""

    part: str
    residual: bool  # whether it is a residual vector, which has no resonance
    owner: int  # body that bends
    body: int  # on the slide that has its coordinate
    dof: int
    # Gamma along the world's axes [sqrt(kg)], (3,); zero of a part that is not on the base
    participation: Array = field(compare=False)
    shapes: Mapping[int, Array] = field(compare=False)  # Phi [1/sqrt(kg)] in the axes of the site, (3,), by site


def declared_modes(model: mujoco.MjModel) -> tuple[DeclaredMode, ...]:
    """Read the modes of all flexible parts of a compiled model; ModelError if a part's tuple is incomplete."""
    modes: list[DeclaredMode] = []
    tuples = [t for t in range(model.ntuple) if FLEXIBLE in model.tuple(t).name]
    if tuples:
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
    for t in tuples:
        name = model.tuple(t).name
        elements = slice(int(model.tuple_adr[t]), int(model.tuple_adr[t] + model.tuple_size[t]))
        kinds = [mujoco.mjtObj(kind) for kind in model.tuple_objtype[elements]]
        ids = model.tuple_objid[elements].tolist()
        n = sum(kind == _BODY for kind in kinds) - 1
        sites = [_SITE, _NUMERIC] * ((len(kinds) - n - 2) // 2)
        if n < 1 or kinds != [_BODY] * (n + 1) + [_NUMERIC, *sites]:
            raise ModelError(
                f"tuple {name!r} must hold the part's body, the body of each of its modes, the numeric with their "
                "participations, and then sites, each with the numeric of its shapes."
            )
        owner, bodies = ids[0], ids[1 : n + 1]
        participations = _rows(model, ids[n + 1], n, name)
        shapes: list[dict[int, Array]] = [{} for _ in bodies]
        for site, numeric in zip(ids[n + 2 :: 2], ids[n + 3 :: 2], strict=True):
            if model.body_weldid[model.site_bodyid[site]] != model.body_weldid[owner]:
                raise ModelError(
                    f"tuple {name!r}: site {model.site(site).name!r} is not on the part's body {model.body(owner).name!r}."
                )
            to_site = data.site_xmat[site].reshape(3, 3).T @ data.xmat[owner].reshape(3, 3)
            for mode, row in zip(shapes, _rows(model, numeric, n, name), strict=True):
                mode[site] = to_site @ row
        turned = participations @ data.xmat[owner].reshape(3, 3).T
        modes += [
            DeclaredMode(
                part=name.replace(FLEXIBLE, "", 1), residual=model.body(body).name.endswith(RESIDUAL), owner=owner, body=body,
                dof=_slide(model, body, name), participation=along, shapes=shape,
            )
            for body, along, shape in zip(bodies, turned, shapes, strict=True)
        ]  # fmt: skip
    return tuple(modes)


def _rows(model: mujoco.MjModel, numeric: int, n: int, name: str) -> Array:
    data = model.numeric(numeric).data
    if data.size != 3 * n:
        raise ModelError(
            f"tuple {name!r}: numeric {model.numeric(numeric).name!r} must hold x, y, z of each of the {n} modes, "
            f"{3 * n} numbers; it has {data.size}."
        )
    return np.array(data).reshape(n, 3)


def _slide(model: mujoco.MjModel, body: int, name: str) -> int:
    """Return the velocity coordinate of a mode's slide; ModelError unless its body is as a mode's must be."""
    joint = int(model.body_jntadr[body])
    alone = model.body_parentid[body] == 0 and model.body_jntnum[body] == 1 and not model.body_geomnum[body]
    if not alone or model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_SLIDE or abs(model.body_mass[body] - 1.0) > 1e-12:
        raise ModelError(
            f"tuple {name!r}: {model.body(body).name!r}, the body of a mode, must have a mass of 1 kg, no geom, and one slide "
            "on the world."
        )
    if abs(float(model.jnt_axis[joint] @ model.opt.gravity)) > 1e-9 * float(np.linalg.norm(model.opt.gravity)):
        raise ModelError(
            f"tuple {name!r}: the slide of {model.body(body).name!r} must be across gravity: a mode has no weight."
        )
    return int(model.jnt_dofadr[joint])
