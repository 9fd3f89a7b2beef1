"""MuJoCo's data, lent out: to make them anew costs more than most of what is computed with them."""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


class Scratch:
    """Data for models of one layout, those of a system and of its variants; several threads may borrow at once."""

    def __init__(self) -> None:
        self._free: list[mujoco.MjData] = []

    @contextmanager
    def data(self, model: mujoco.MjModel) -> Iterator[mujoco.MjData]:
        """Lend data as `MjData(model)` makes them: the model's initial state, and nothing computed yet."""
        try:
            data = self._free.pop()
        except IndexError:
            data = mujoco.MjData(model)
        else:
            mujoco.mj_resetData(model, data)
        yield data
        self._free.append(data)  # not after an error: nobody knows what it left

    def __reduce__(self) -> tuple[type["Scratch"], tuple[()]]:
        """Carry nothing to another process; a copy lends for itself."""
        return Scratch, ()
