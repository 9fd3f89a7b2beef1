"""Lines on what of a model can vary, and distributions read from options such as "NAME = Normal(1, 0.1)"."""

import ast
import inspect
from collections.abc import Sequence
from typing import get_args

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import centre_of_mass, sprung_joints
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.plain_text import quoted, short
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.laws import Law
from wirerope_mj.mounts.laws.law import FACTORS
from wirerope_mj.studies.vary.body_quantities import bodies_of
from wirerope_mj.studies.vary.distributions import Distribution
from wirerope_mj.studies.vary.mount_quantities import MOUNT_FACTORS
from wirerope_mj.studies.vary.quantity import WORLD

_AXES = ", ".join(WORLD)


def available_lines(system: System, motion: BaseMotion) -> list[str]:
    """Return a line for every group of quantities that can vary: its name with NAME in place of mounts or bodies.

    Mounts whose laws have the same parameters stand together, with their values where these are equal.
    """
    lines, groups = [], dict[tuple[Law | None, ...], list[str]]()
    for name, mount in system.mounts.items():
        groups.setdefault(tuple(mount.written.axes.values()), []).append(name)
    for mounts in groups.values():
        axes = system.mounts[mounts[0]].written.axes
        laws = {axis: law for axis, law in axes.items() if law is not None}
        lines.append(f"mounts {', '.join(mounts)}:")
        for axis, law in laws.items():
            if law.factors:
                lines.append(f"  {', '.join(f'mount/NAME/{axis}/{factor}' for factor in FACTORS)}  factor on all its laws")
                if shared := law.factors[len(FACTORS) :]:
                    lines.append(f"  mount/NAME/{axis}/PARAMETER  factor in all its laws: {', '.join(shared)}")
                lines += [
                    _law_line(f"{axis}/laws[{number}].PARAMETER", component) for number, component in enumerate(law.components)
                ]
            else:
                lines.append(_law_line(f"{axis}/PARAMETER", law))
        devices = [system.mounts[mount].written for mount in mounts]
        if any(device.stiffening is not None for device in devices):
            lines.append("  mount/NAME/stiffening/cycles, mount/NAME/stiffening/after_50  value or factor")
        spread = any(device.spread is not None for device in devices)
        lines += ["  mount/NAME/spread  specimens"] if spread else []
    if system.mounts:
        lines.append("all mounts: mount/NAME/fitted, mount/NAME/failed, mount/NAME/isolator (choices)")
        on = [f"mount/NAME/{name}  factor on {description}" for name, (_, description) in MOUNT_FACTORS.items()]
        lines.append(f"  {'; '.join(on)}")
        lines.append(f"  mount/NAME/position_shift/AXIS  shift [m] along the world's {_AXES}")
        lines.append(f"  mount/NAME/turn/AXIS  angle [°] by which it leans about the world's {_AXES}")
        lines.append("  several: mount/m01,m05,-m04/position_shift/x, those behind a minus moving the other way")
    if bodies := bodies_of(system):
        lines.append("bodies, with the model's mass and centre of mass from the body's origin:")
        for body in bodies:
            centre = ", ".join(f"{0.0 if abs(value) < 1e-9 else value:.4g}" for value in centre_of_mass(system, body))
            lines.append(f"  {body}: {float(system.model.body(body).mass[0]):.4g} kg, centre ({centre}) m")
        lines += ["  body/NAME/mass  value [kg] or factor", f"  body/NAME/centre/AXIS  value [m] along the body's {_AXES}"]
        lines.append(f"  body/NAME/centre_shift/AXIS  shift [m] along the world's {_AXES}")
    if joints := sprung_joints(system.model):
        lines.append("joints with springs, with the natural frequency of each alone:")
        lines += [f"  {name}: {frequency:.4g} Hz" for name, frequency in joints.items()]
        lines.append("  joint/NAME/frequency  value [Hz] or factor")
    if motion.up is not None:
        return [*lines, f"motion {motion.description}: nothing, a fall has no level but its height"]
    lines += [f"motion {motion.description}:", "  motion/level  factor"]
    one_line = np.linalg.matrix_rank(motion.directions, tol=1e-9) == 1  # 1e-9: rounding of unit vectors
    if one_line and np.linalg.matrix_rank(system.assembly.tables.drive) == len(WORLD):  # the base is driven along all axes
        lines.append("  motion/azimuth, motion/elevation  values [deg]")
    return lines


def _law_line(name: str, law: Law) -> str:
    """Return the line of one law's parameters."""
    values = ", ".join(f"{key} = {_text(value)}" for key, value in law.to_dict().items() if key != "law")
    values += " (what is 0 takes no factors)" if 0.0 in law.to_dict().values() else ""
    return f"  mount/NAME/{name}  value [SI] or factor; {law.name}: {values}"


def _text(value: object) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_text, value))}]"
    return f"{value:.4g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value)


EXAMPLE = "mount/m*/axial/alpha = Normal(1, 0.1, relative, each)"
_GROUP = "group"  # The argument of every distribution that is a string
_KINDS: dict[str, type] = {kind.__name__: kind for kind in get_args(Distribution)}


def read_vary(texts: Sequence[str]) -> dict[str, Distribution]:
    """Return distributions by the names of quantities, from texts "NAME = Normal(1, 0.1, relative)".

    A distribution is written as in Python, with numbers, strings in quotes, True and False; nothing is evaluated. A flag
    such as `relative` may stand for `relative=True`, and a group without quotes: `group=ropes`. ValueError if a text is
    not of this form, or the distribution cannot be; says what there is.
    """
    distributions: dict[str, Distribution] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise ValueError(f'what varies must be written like "{EXAMPLE}", got {quoted(text)}.')
        if name in distributions:
            raise ValueError(f"{quoted(name)} is said twice; a quantity has one distribution.")
        distributions[name] = _distribution(name, value)
    return distributions


def signatures() -> list[str]:
    return [_signature(kind) for kind in _KINDS]


def _distribution(name: str, text: str) -> Distribution:
    """Parse the distribution of the quantity `name`, a call as in Python, of which nothing is evaluated."""
    shown_text, name = quoted(text), short(name)
    try:
        call = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):  # the last two of brackets in brackets
        raise ValueError(f"{name!r}: {shown_text} cannot be read; write it like {EXAMPLE.partition('= ')[2]}.") from None
    function = call.func if isinstance(call, ast.Call) else call
    kind = function.id if isinstance(function, ast.Name) else ""
    if kind not in _KINDS:
        raise ValueError(f"{name!r}: {shown_text} is no distribution; there are {', '.join(signatures())}.")
    positional: list[object] = []
    named: Entries = {}
    if isinstance(call, ast.Call):
        for arg in call.args:
            if any(isinstance(part, ast.Name) and part.id in ("nan", "inf") for part in ast.walk(arg)):
                raise ValueError(f"{name!r}: numbers must be finite, got {short(ast.unparse(arg))}.")
            if isinstance(arg, ast.Name):
                if arg.id not in (flags := _flags(kind)):
                    message = f"{kind} has no flag {quoted(arg.id)}; it has {' and '.join(flags) or 'none'}"
                    raise ValueError(f"{name!r}: {message}. A string as a value stands in quotes.")
                named[arg.id] = True
            else:
                positional.append(_value(name, arg))
        for keyword in call.keywords:  # a group may stand without quotes, since it is always a string
            bare = keyword.arg == _GROUP and isinstance(keyword.value, ast.Name)
            named[keyword.arg or "**"] = ast.unparse(keyword.value) if bare else _value(name, keyword.value)
    for flag in _flags(kind):
        if not isinstance(named.get(flag, False), bool):
            raise ValueError(f"{name!r}: `{flag}` must be True or False, got {quoted(named[flag])}.")
    try:
        inspect.signature(_KINDS[kind]).bind(*positional, **named)
    except TypeError as error:
        fault = str(error).replace("positional arguments", "values").replace("an unexpected keyword", "an unknown")
        raise ValueError(f"{name!r}: {fault}; it is written {_signature(kind)}.") from None
    try:
        distribution: Distribution = _KINDS[kind](*positional, **named)
    except ValueError as error:
        raise ValueError(f"{name!r}: {error}") from None
    return distribution


def _flags(kind: str) -> list[str]:
    """Return the names of the arguments of a distribution that are True or False."""
    parameters = inspect.signature(_KINDS[kind]).parameters
    return [name for name, parameter in parameters.items() if isinstance(parameter.default, bool)]


def _value(name: str, node: ast.expr) -> object:
    try:
        return ast.literal_eval(node)
    except (ValueError, MemoryError, RecursionError):
        text = f"{name!r}: {quoted(ast.unparse(node))} must be a number, a string in quotes, True, False or a list of them."
        raise ValueError(text) from None


def _signature(kind: str) -> str:
    """Return the notation of a distribution: `Normal(mean, deviation, relative, each, low=, high=)`."""
    flags, parts = _flags(kind), []
    for name, parameter in inspect.signature(_KINDS[kind]).parameters.items():
        if parameter.kind is parameter.VAR_POSITIONAL:
            parts.append("value, value, ...")
        elif name in flags or parameter.default is parameter.empty:
            parts.append(name)
        else:
            parts.append(f"{name}=")
    return f"{kind}({', '.join(parts)})"
