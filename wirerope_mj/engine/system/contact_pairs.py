"""Pairs of geoms that may touch: how many a system's memory of contacts must hold, and what they are called."""

import mujoco
import numpy as np

from wirerope_mj.engine.response.contacts import ContactPeak
from wirerope_mj.foundation.errors import ModelError

MOST = 32  # rows for contacts that no `pair` declares: more seldom touch in one run, and each row is part of a state


def contact_capacity(model: mujoco.MjModel) -> int:
    """Return the rows of the memory of contacts: one for each declared pair, up to `MOST` for what else may touch."""
    if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT:
        return 0
    if model.nflex:
        return int(model.npair) + MOST
    return int(model.npair) + min(_pairs_by_type(model), MOST)


def declared_pairs(model: mujoco.MjModel) -> list[tuple[int, int]]:
    """Return the geoms of the model's declared pairs, in its order; none where contacts are disabled."""
    pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    return list(pairs)[: contact_capacity(model)]


def declared_contacts(model: mujoco.MjModel, base: int) -> dict[str, ContactPeak]:
    """Return the model's declared pairs by name, as contacts that have not touched; ModelError if one is there twice."""
    pairs = [payload_first(model, base, pair) for pair in declared_pairs(model)]
    for number, pair in enumerate(pairs):
        if set(pair) in map(set, pairs[:number]):
            raise ModelError(
                f"the <pair> of geoms {geom_name(model, pair[0])!r} and {geom_name(model, pair[1])!r} stands there twice, and "
                "their forces would be doubled. Remove one, or give it geoms of its own."
            )
    return {contact_name(model, pair): untouched(model, pair) for pair in pairs}


def untouched(model: mujoco.MjModel, pair: tuple[int, int]) -> ContactPeak:
    """Return the contact of two geoms that have not touched."""
    bodies = [model.body(model.geom_bodyid[geom]).name if geom >= 0 else "" for geom in pair]
    return ContactPeak(geoms=(geom_name(model, pair[0]), geom_name(model, pair[1])), bodies=(bodies[0], bodies[1]))


def contact_name(model: mujoco.MjModel, geoms: tuple[int, int]) -> str:
    """Return what a pair of geoms is called, "stop_1 on pad_1"."""
    one, other = (geom_name(model, geom) for geom in geoms)
    return f"{one} on {other}"


def geom_name(model: mujoco.MjModel, geom: int) -> str:
    """Return a geom's name, or its number and the body that it belongs to."""
    if geom < 0:
        return "a flexible body"
    return model.geom(geom).name or f"geom {geom} of {model.body(model.geom_bodyid[geom]).name or 'the world'}"


def payload_first(model: mujoco.MjModel, base: int, pair: tuple[int, int]) -> tuple[int, int]:
    """Return a pair of geoms with the one that is fixed to the base, or to the world, last; MuJoCo orders them by shape."""
    fixed = [geom < 0 or model.body_weldid[model.geom_bodyid[geom]] in (0, base) for geom in pair]
    return (pair[1], pair[0]) if fixed[0] and not fixed[1] else pair


def _pairs_by_type(model: mujoco.MjModel) -> int:
    """Return how many pairs of geoms MuJoCo may let touch by their contact types, those declared as `pair` besides."""
    types, affinities = model.geom_contype, model.geom_conaffinity
    meet = (types[:, np.newaxis] & affinities) != 0
    meet |= meet.T
    bodies = model.body_weldid[model.geom_bodyid]
    meet &= bodies[:, np.newaxis] != bodies
    return int(np.count_nonzero(np.triu(meet, 1)))
