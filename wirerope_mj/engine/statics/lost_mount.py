"""A mount that a layout lacks: one place is empty that its own symmetry fills, and the weight stands off the mounts."""

from collections.abc import Iterator, Sequence

import numpy as np

from wirerope_mj.engine.system import Mount
from wirerope_mj.foundation.arrays import Array

_UPRIGHT = 0.7  # rise of a mount's axis from which it carries weight (45 degrees)
_SAME = 0.02  # of the distance of the mounts, within which two places are one
# distance of the middle of the mounts from the centre of mass, over that of the mounts: from which weight stands off them;
# and over what it was, when the empty place is filled
_OFF, _CENTRED = 0.04, 0.5


def lost_mounts(body: str, mounts: Sequence[Mount], centre: Array) -> Iterator[str]:
    """Yield a warning of the one place (3,) [m] that would make mounts symmetric and put the weight into their middle.

    Mounts of one part that stand so on purpose, as under an L-shaped frame, have its weight in their middle.
    """
    carrying = [mount for mount in mounts if mount.axes[2, 2] > _UPRIGHT]
    if len(carrying) < 3 or len({mount.isolator_name for mount in carrying}) > 1:
        return
    places = np.array([mount.position for mount in carrying])
    apart = float(np.hypot(*np.ptp(places[:, :2], axis=0)))
    off = float(np.linalg.norm(places[:, :2].mean(axis=0) - centre[:2]))
    if off < _OFF * apart:
        return
    found = []
    for axis in (0, 1):
        mirrored = places.copy()
        mirrored[:, axis] = places[:, axis].min() + places[:, axis].max() - places[:, axis]
        alone = np.linalg.norm(mirrored[:, None] - places[None], axis=2).min(axis=1) > _SAME * apart
        if np.count_nonzero(alone) == 1:
            place = mirrored[alone][0]
            filled = np.vstack([places, place])
            found.append((float(np.linalg.norm(filled[:, :2].mean(axis=0) - centre[:2])), place, carrying[int(alone.argmax())]))
    if found and (best := min(found, key=lambda place: place[0]))[0] < _CENTRED * off:
        at = ", ".join(f"{x:.4g}" for x in np.round(best[1], 6).tolist())
        yield (
            f"body {body!r}: {best[2].name!r} has no mount opposite at ({at}) m, where all others have one, and the middle "
            f"of the mounts stands {off:.3g} m off the centre of mass: is a row of mounts missing, or a sign of another wrong?"
        )
