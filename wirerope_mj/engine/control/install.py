"""Installing the callbacks around stepping, and only there: MuJoCo's callbacks belong to the whole process."""

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal

import mujoco
import numba

from wirerope_mj.engine.control.native import Callbacks, native_callbacks
from wirerope_mj.engine.control.python import python_callbacks
from wirerope_mj.engine.control.structs import disagreement
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.errors import SimulationError

Kind = Literal["native", "python"]

_lock = threading.Lock()
_users = 0
_kind: Kind = "native"
_before: tuple[object, ...] = (None,) * 4


@contextmanager
def installed(model: mujoco.MjModel, data: mujoco.MjData, kind: Kind = "native") -> Iterator[Kind]:
    """Make the mounts of every system act for as long as the block runs; what was installed before comes back after it.

    MuJoCo's warnings are not printed meanwhile: their counters in `data.warning` are what a caller has to look at.

    Args:
        model: model of a system.
        data: data whose memory the native callback is verified with before it is installed.
        kind: "native", or "python" for callbacks in the interpreter.

    Yields:
        The kind that is installed: "python" where the native callback cannot be verified (with a RuntimeWarning).

    Raises:
        SimulationError: another thread steps with the other kind, or MuJoCo could not go on within the block.
    """
    one_of("callback", kind, ("native", "python"))
    kind = _verified(model, data) if kind == "native" else kind
    _acquire(kind)
    try:
        yield kind
    except mujoco.FatalError as error:
        raise SimulationError(_given_up(model, " ".join(str(error).split()))) from None
    finally:
        _release()


def _given_up(model: mujoco.MjModel, reason: str) -> str:
    """Return the message about a model that MuJoCo cannot step any further, from its own reason."""
    name = model.names.split(b"\0", 1)[0].decode("utf-8", "replace")
    remedy = (
        'Its contacts and constraints need more memory: write <size memory="100M"/> into the model.'
        if "memory" in reason
        else "Step it with a smaller `timestep`, or look for bodies that overlap in the modelled geometry."
    )
    return f"model {name!r}: MuJoCo gave up: {reason.rstrip('.')}. {remedy}"


def _verified(model: mujoco.MjModel, data: mujoco.MjData) -> Kind:
    if numba.config.DISABLE_JIT:
        reason: str | None = "Numba's compiler is switched off"
    else:
        field = disagreement(model, data)
        reason = None if field is None else f"{field} of mujoco {mujoco.__version__} does not stand where it should"
    if reason is None:
        return "native"
    warnings.warn(f"{reason}; the slower Python callback is used instead.", RuntimeWarning, stacklevel=4)
    return "python"


def _acquire(kind: Kind) -> None:
    global _users, _kind, _before
    with _lock:
        if _users and kind != _kind:
            raise SimulationError(f"another thread is stepping with the {_kind} callback; wait for it, or use it here.")
        if not _users:
            before = (
                mujoco.get_mjcb_control(),
                mujoco.get_mjcb_act_dyn(),
                mujoco.get_mjcb_sensor(),
                mujoco.get_mju_user_warning(),
            )
            _set(native_callbacks() if kind == "native" else python_callbacks(), _say_nothing)
            _before, _kind = before, kind
        _users += 1


def _release() -> None:
    global _users
    with _lock:
        _users -= 1
        if not _users:
            _set(Callbacks(*_before[:3]), _before[3])


def _say_nothing(message: str) -> None:
    """Take a warning without printing it."""


def _set(callbacks: Callbacks, warn: object) -> None:
    mujoco.set_mjcb_control(callbacks.control)
    mujoco.set_mjcb_act_dyn(callbacks.act_dyn)
    mujoco.set_mjcb_sensor(callbacks.sensor)
    mujoco.set_mju_user_warning(warn)
