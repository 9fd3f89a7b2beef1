"""Changes that make a variant of a system from the model as written."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.structure import Place, Positive, bounds, check, structure
from wirerope_mj.mounts.isolator import Isolator

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Changes:
    """Isolators, masses, centres of mass, positions and inclinations of mounts that differ from those of another system."""

    isolators: Mapping[str, Isolator] = field(default_factory=dict)  #: isolators by mount
    masses: Mapping[str, Positive] = field(default_factory=dict)  #: factors on mass and moments of inertia, by body
    #: shifts of the centre of mass [m], world axes of the modelled geometry, by body
    centres: Mapping[str, Annotated[Vector, bounds("m")]] = field(default_factory=dict)
    #: shifts of both sites [m], world axes of the modelled geometry, by mount
    positions: Mapping[str, Annotated[Vector, bounds("m")]] = field(default_factory=dict)
    #: rotation vectors of both sites' axes [rad], world axes of the modelled geometry, by mount
    turns: Mapping[str, Annotated[Vector, bounds("rad")]] = field(default_factory=dict)
    #: factors on the natural frequency that a joint's spring gives, its damping ratio kept, by joint
    tunings: Mapping[str, Positive] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check(self)

    def to_dict(self) -> Entries:
        """Return the changes as plain TOML values, from which `from_dict` makes them again to the last bit."""
        shifts = {"centres": self.centres, "positions": self.positions}
        shifts |= {"turns": self.turns} if self.turns else {}
        return {
            "isolators": {mount: isolator.to_dict() for mount, isolator in self.isolators.items()},
            "masses": dict(self.masses),
            **({"tunings": dict(self.tunings)} if self.tunings else {}),
            **{name: {key: list(shift) for key, shift in values.items()} for name, values in shifts.items()},
        }

    @classmethod
    def from_dict(cls, content: Entries) -> "Changes":
        """Return the changes that `to_dict` stored; ModelError or ValueError if one of them is not what it must be."""

        def isolator(table: Entries, place: Place) -> Isolator:
            return Isolator.from_dict(table, where=f"isolator of mount {place.keys[-1]!r}")

        return structure(cls, content, Place("changes"), {Isolator: isolator})
