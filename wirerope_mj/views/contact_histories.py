"""Histories of what was struck: forces of stops and of pairs of geoms, and the gaps of these pairs."""

from dataclasses import dataclass

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.peaks import ContactPeak
from wirerope_mj.foundation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Touching:
    """A stop or a pair of geoms that touched: peaks, force [N] (n_t,), gap [m] (n_t,) or None of a mount's stop."""

    name: str
    contact: ContactPeak
    force: Array
    gap: Array | None


def touching(response: Response) -> list[Touching]:
    """Return what touched and has histories, the largest force first.

    Pairs that the model does not declare have peaks alone, and so have stops that act beside other laws of their mount.
    """
    alone = {stop.name for stop in response.scene.stops}
    found = []
    for name, contact in (response.peaks.contacts or {}).items():
        if not contact.touches:
            continue
        if name in response.contacts:
            pair = response.contacts[name]
            found.append(Touching(name=name, contact=contact, force=pair.force, gap=pair.gap))
        elif contact.mount in alone:
            force = np.linalg.norm(response.mounts[contact.mount].force, axis=1)
            found.append(Touching(name=contact.called(name), contact=contact, force=force, gap=None))
    return sorted(found, key=lambda one: one.contact.force, reverse=True)
