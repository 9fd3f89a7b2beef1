"""Changes that make a variant of a system from the model as written."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from wirerope_mj.foundation.arguments import finite, positive
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.mounts.isolator import Isolator

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Changes:
    """Isolators, masses, centres of mass, positions and inclinations of mounts that differ from those of another system."""

    isolators: Mapping[str, Isolator] = field(default_factory=dict)  #: isolators by mount
    masses: Mapping[str, float] = field(default_factory=dict)  #: factors on mass and moments of inertia, by body
    #: shifts of the centre of mass [m], world axes of the modelled geometry, by body
    centres: Mapping[str, Vector] = field(default_factory=dict)
    #: shifts of both sites [m], world axes of the modelled geometry, by mount
    positions: Mapping[str, Vector] = field(default_factory=dict)
    #: rotation vectors of both sites' axes [rad], world axes of the modelled geometry, by mount
    turns: Mapping[str, Vector] = field(default_factory=dict)
    #: factors on the natural frequency that a joint's spring gives, its damping ratio kept, by joint
    tunings: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for mount, isolator in self.isolators.items():
            if not isinstance(isolator, Isolator):
                raise ValueError(f"`isolators[{mount!r}]` must be an Isolator, got {isolator!r}.")
        checked = {
            "isolators": dict(self.isolators),
            "masses": {body: positive(f"masses[{body!r}]", factor) for body, factor in self.masses.items()},
            "centres": {body: _shift("centres", body, shift) for body, shift in self.centres.items()},
            "positions": {mount: _shift("positions", mount, shift) for mount, shift in self.positions.items()},
            "turns": {mount: _shift("turns", mount, turn, "rad") for mount, turn in self.turns.items()},
            "tunings": {joint: positive(f"tunings[{joint!r}]", factor) for joint, factor in self.tunings.items()},
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)

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
        isolators = {
            mount: Isolator.from_dict(isolator, where=f"isolator of mount {mount!r}")
            for mount, isolator in content.get("isolators", {}).items()
        }
        rest = {name: content.get(name, {}) for name in ("masses", "centres", "positions", "turns", "tunings")}
        return cls(isolators=isolators, **rest)


def _shift(name: str, key: str, shift: Iterable[object], unit: str = "m") -> Vector:
    try:
        x, y, z = (finite(name, value) for value in shift)
    except (TypeError, ValueError):
        raise ValueError(f"`{name}[{key!r}]` must be three finite numbers [{unit}], got {shift!r}.") from None
    return x, y, z
