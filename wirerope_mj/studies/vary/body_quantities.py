"""Quantities of bodies and joints that vary in a study: masses, centres of mass, natural frequencies of sprung joints."""

from collections.abc import Sequence

import numpy as np

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import body_axes, centre_of_mass, is_aligned, moving_bodies, sprung_joints
from wirerope_mj.foundation.arrays import AnyArray, Booleans
from wirerope_mj.studies.vary.distributions import Choice, Distribution, Normal, Uniform
from wirerope_mj.studies.vary.quantity import (
    NEAR,
    WORLD,
    Draft,
    Entry,
    InputColumn,
    Positive,
    Quantity,
    Shift,
    check_axis,
    check_finite,
)


def bodies_of(system: System) -> list[str]:
    """Return the moving bodies without the base, whose mass has no effect."""
    return [body for body in moving_bodies(system.model) if body != system.base]


class BodyColumn(InputColumn):
    """Column of a study's inputs that acts on moving bodies."""

    noun = "moving body with a mass (the driven base does not count)"

    @classmethod
    def existing(cls, system: System) -> dict[str, bool]:
        return dict.fromkeys(bodies_of(system), False)


class Mass(BodyColumn, Positive):
    """Mass [kg] of bodies, with their moments of inertia."""

    form = "body/NAME/mass"
    model_unit = "kg"
    into = "masses"

    def nominal_of(self, system: System, target: str) -> float:
        return float(system.model.body(target).mass[0])


class CentreShift(BodyColumn, Shift):
    """Shift [m] of the centre of mass along an axis of the world."""

    form = "body/NAME/centre_shift/x"
    into = "centre_shifts"

    def nominal_of(self, system: System, target: str) -> float:
        return float((body_axes(system, target) @ centre_of_mass(system, target))[WORLD.index(self.key[0])])

    def remedy(self, system: System) -> str:
        return f"say {_as_other_kind(self, system, 'centre')!r}"


class Centre(BodyColumn):
    """Position [m] of the centre of mass along an axis of the body, from the body's origin; its key is the axis."""

    form = "body/NAME/centre/x"
    model_unit = "m"
    bounds = "finite"

    @classmethod
    def resolve(cls, entry: Entry) -> tuple[InputColumn, ...]:
        check_axis(entry, "a position [m]")
        return super().resolve(entry)

    def nominal_of(self, system: System, target: str) -> float:
        return float(centre_of_mass(system, target)[WORLD.index(self.key[0])])

    def apply(self, draft: Draft, value: float) -> None:
        check_finite(self.name, value)
        for body in self.targets:
            centre = draft.centres.setdefault(body, centre_of_mass(draft.system, body))
            centre[WORLD.index(self.key[0])] = value

    def moved(self, system: System, values: AnyArray) -> Booleans:
        return np.asarray(values != self.nominal(system)[0])

    def check(self, distribution: Distribution, system: System) -> None:
        """Raise ValueError if positions look like shifts, or are no positions in the model as written.

        A value whose middle is nearer to 0 than to the model's is refused: it is what a shift looks like, and taken as a
        position it would move the centre of mass to the body's origin unnoticed. All that is refused can be said as a shift.
        """
        shift = _as_other_kind(self, system, "centre_shift")
        for body in self.targets:
            if is_aligned(system, body):
                raise ValueError(
                    f"`vary`: {self.name!r}: MuJoCo has moved the origin of body {body!r} into its centre of mass (`align` of "
                    f"its free joint), so that positions in its axes are not those of the model; say shifts: {shift!r}."
                )
        nominal, text = self.nominal(system), self.nominal_text(system)
        if max(nominal) - min(nominal) > NEAR:
            raise ValueError(
                f"`vary`: {self.name!r} is one position for bodies whose centres of mass stand at {text} in the model; name "
                f"one body, or say shifts: {shift!r}."
            )
        if isinstance(distribution, Normal):
            middle = distribution.mean
        elif isinstance(distribution, Uniform):
            middle = (distribution.low + distribution.high) / 2.0
        else:
            assert isinstance(distribution, Choice)  # the others are for other quantities
            middle = (min(distribution.choices) + max(distribution.choices)) / 2.0
        if abs(nominal[0]) > NEAR and abs(middle) < abs(middle - nominal[0]):
            raise ValueError(
                f"`vary`: {self.name!r} is the position of the centre of mass in the body's axes [m], and stands at {text} in "
                f"the model; values around {middle:g} m are nearer to 0 than to that, as shifts are. If they are shifts, say "
                f"{shift!r}, along the world's axes; if the centre is to stand there, say {shift!r} with shifts that bring it "
                f"there, {middle - nominal[0]:.4g} m along this axis of the body."
            )


def check_centres(quantities: Sequence[Quantity], system: System) -> None:
    """Raise ValueError if centres of mass are stated in two ways, or positions of them look like shifts."""
    columns = [(part, quantity.distribution) for quantity in quantities for column in quantity.columns for part in column.parts]
    absolute = {body: column.name for column, _ in columns if isinstance(column, Centre) for body in column.targets}
    for column, distribution in columns:
        if isinstance(column, Centre):
            column.check(distribution, system)
        for body in column.targets if isinstance(column, CentreShift) else ():
            if body in absolute:
                raise ValueError(
                    f"`vary`: {absolute[body]!r} is a position and {column.name!r} a shift of the same body {body!r}; say all "
                    "of them in one of these ways."
                )


def _as_other_kind(column: Centre | CentreShift, system: System, noun: str) -> str:
    """Return a column's name with `noun`, "centre" or "centre_shift"; AXIS for its axis unless body and world axes agree."""
    start, _, axis = column.name.rpartition("/")
    parallel = all(np.allclose(body_axes(system, body), np.eye(3), atol=1e-9) for body in column.targets)
    return f"{start.rpartition('/')[0]}/{noun}/{axis if parallel else 'AXIS'}"


class Tuning(Positive):
    """Natural frequency [Hz] that a joint's spring gives what stands on it alone; its damping ratio stays."""

    form = "joint/NAME/frequency"
    model_unit = "Hz"
    noun = "joint with a spring"
    into = "tunings"

    @classmethod
    def existing(cls, system: System) -> dict[str, bool]:
        return dict.fromkeys(sprung_joints(system.model), False)

    def nominal_of(self, system: System, target: str) -> float:
        return sprung_joints(system.model)[target]
