"""Areas of the deck that a model names: <text name="area/forward" data="m1 m2 h*"/>, the mounts that stand on each."""

from collections.abc import Collection
from fnmatch import fnmatchcase

import mujoco

from wirerope_mj.foundation.errors import ModelError

AREA = "area/"


def declared_areas(spec: mujoco.MjSpec, mounts: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Return the mounts of every area, in the order of the model.

    Raises:
        ModelError: an area names no mount of the model, or a mount stands on two of them.
    """
    areas: dict[str, tuple[str, ...]] = {}
    taken: dict[str, str] = {}
    for text in spec.texts:
        name = text.name
        if AREA not in name:
            continue
        area, patterns = name.replace(AREA, "", 1), text.data.split()
        for pattern in patterns:
            if not any(fnmatchcase(mount, pattern) for mount in mounts):
                raise ModelError(
                    f"text {name!r}: there is no mount {pattern!r}. There are {', '.join(mounts) or 'none'}."
                )
        areas[area] = tuple(mount for mount in mounts if any(fnmatchcase(mount, pattern) for pattern in patterns))
        for mount in areas[area]:
            if mount in taken:
                raise ModelError(f"text {name!r}: mount {mount!r} stands on area {taken[mount]!r} already.")
            taken[mount] = area
    return areas
