"""A system: a MuJoCo model whose mounts act through the control callback."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import wraps
from os import PathLike
from pathlib import Path
from string import ascii_letters, digits
from typing import Annotated, TypeVar
from weakref import WeakKeyDictionary

import mujoco
import numpy as np

from wirerope_mj.engine.control.install import check_callbacks
from wirerope_mj.engine.system.assembly import Assembly, assemble
from wirerope_mj.engine.system.checks import check_joints, check_numbers, check_written, refusal_message
from wirerope_mj.engine.system.declared import (
    base_body,
    check_names,
    check_visible,
    declared_areas,
    declared_limits,
    declared_mounts,
    judges_combined_travel,
)
from wirerope_mj.engine.system.named_files import check_regular
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import ModelError, why_unread
from wirerope_mj.foundation.faults import reworded
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.foundation.plain_text import quoted, short
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.resources import model_file, shipped_models
from wirerope_mj.foundation.structure import Place, Positive, bounds, check, structure
from wirerope_mj.foundation.summary import Brief, ByName, Summarised
from wirerope_mj.mounts.isolator import BOTTOM, Isolator
from wirerope_mj.mounts.isolator.travel import beyond_law

Value = TypeVar("Value")
Vector = tuple[float, float, float]
_LETTERS = frozenset(f"{ascii_letters}{digits}_-")  # of a name that may name a folder


@dataclass(frozen=True, kw_only=True, repr=False)
class Mount(Brief):
    """An isolator between two sites of a model."""

    name: str  #: name of the mount
    isolator: Isolator  #: the device as it acts, stiffened by its cycles (`Isolator.conditioned`)
    written: Isolator  #: the device as its file has it
    isolator_name: str  #: what the model calls it
    #: payload_site, base_site: names of its sites
    payload_site: str
    base_site: str
    #: payload_body, base_body: names of the bodies that carry them
    payload_body: str
    base_body: str
    position: Array  #: point of both sites in the modelled geometry [m], world frame, (3,)
    axes: Array  #: roll, shear and axial direction as columns, world frame, modelled geometry, (3, 3)
    #: where its internal states stand among those of the system, one slice each for roll, shear, axial
    states: tuple[slice, slice, slice]

    def shift_for(self, isolator: Isolator) -> list[float] | None:
        """Return the shift of a mount's mid-height [m], (3,), when another isolator replaces its own below the payload's bar.

        None where one of the two does not state its height.
        """
        before, after = (device.geometry.height if device.geometry else None for device in (self.written, isolator))
        return (0.5 * (before - after) * self.axes[:, 2]).tolist() if before and after else None


@dataclass(frozen=True, kw_only=True)
class Changes:
    """Isolators, masses, centres of mass, positions and inclinations of mounts in which a system differs from another."""

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
        """Return the changes as TOML values, which `from_dict` restores bit by bit."""
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
        """Restore the changes that `to_dict` stored; ModelError or ValueError if a value is invalid."""

        def isolator(table: Entries, place: Place) -> Isolator:
            return Isolator.from_dict(table, where=f"isolator of mount {place.keys[-1]!r}")

        return structure(cls, content, Place("changes"), {Isolator: isolator})


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class System(Summarised):
    """A compiled model with mounts.

    `model` is ready to step while the callbacks are installed (`wirerope_mj.engine.control.installed`). Sensors `body/NAME`,
    `point/NAME` and `mount/NAME` hold what is observed of it, see `wirerope_mj.engine.control.layout`.
    """

    model: mujoco.MjModel  #: compiled model
    mounts: dict[str, Mount]  #: mounts by name, in the order of the model
    payloads: list[str]  #: names of the bodies at the root of what the mounts carry
    base: str  #: name of the driven base; "" if the base sites are fixed in the world
    mjcf: str  #: the model as written
    path: Path | None  #: file it was read from, None if it was given as text
    isolators: dict[str, Isolator]  #: isolators by what the model calls them
    limits: tuple[PayloadLimit, ...]  #: what the payload can bear, as far as the model says
    assembly: Assembly = field(repr=False)  #: where the parts of the model stand
    #: what a variant differs by from the model as written, in the order in which it was varied; see `wirerope_mj.varied`.
    #: `mjcf`, `path` and `isolators` say nothing of it, `model` and `mounts` hold it
    changes: tuple[Changes, ...] = ()
    #: whether mounts are judged on the travel along all axes at once; a model that says <numeric name="limit/combined_travel"
    #: data="0"/> switches that off
    combined_travel: bool = True
    #: the mounts on each area of the deck that the model names, <text name="area/NAME" data="m1 m2"/>
    areas: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def _summary(self) -> tuple[str, dict[str, str]]:
        mass = float(self.model.body_mass.sum())
        by_isolator: dict[str, list[str]] = {}
        for name, mount in self.mounts.items():
            by_isolator.setdefault(mount.isolator.name, []).append(name)
        lines = {"payloads": ", ".join(self.payloads), "base": self.base or "fixed in the world", "mass": f"{mass:.4g} kg"}
        lines |= {isolator: ", ".join(names) for isolator, names in by_isolator.items()}
        source = self.path.name if self.path else "MJCF text"
        return f"System of {source}: {len(self.mounts)} mounts, {self.model.nv} degrees of freedom", lines

    @property
    def bottoms(self) -> dict[str, str]:
        """Stops that act where mounts go solid, by the mount at whose sites they stand."""
        at = {(mount.payload_site, mount.base_site): name for name, mount in self.mounts.items() if not mount.isolator.is_stop}
        stops = {name: mount for name, mount in self.mounts.items() if BOTTOM in mount.isolator_name and mount.isolator.is_stop}
        return {at[sites]: name for name, stop in stops.items() if (sites := (stop.payload_site, stop.base_site)) in at}

    @property
    def name(self) -> str:
        """Name of the model's file without its ending; of a text the model name it states, else "model"."""
        if self.path:
            return self.path.stem
        stated = self.model.names.split(b"\0", 1)[0].decode("utf-8", "replace")
        return stated if stated and set(stated) <= _LETTERS else "model"


def load_system(source: str | Path, *, isolators: Mapping[str, Isolator] | None = None) -> System:
    """Return the system that an MJCF model and its isolators describe.

    Args:
        source: path of an MJCF file, the name of a model that ships with the package ("floating_floor"), or MJCF text.
        isolators: isolators in memory by the name that follows `isolator/` in the model; they go before files.

    Raises:
        ValueError: `source` is neither a path, a name nor text.
        ModelError: the model cannot be read, or its mounts, sites, isolators or base are not what they must be.
        SimulationError: the process has one of MuJoCo's callbacks set.
    """
    check_callbacks()
    text, path = _read(source)
    try:
        for name, isolator in (isolators or {}).items():
            if not isinstance(isolator, Isolator):
                raise ModelError(f"`isolators[{name!r}]` must be an Isolator, got {quoted(isolator, 80)}.")
        return _system(text, path, isolators or {})
    except ModelError as error:
        raise reworded(error, lambda text: ModelError(f"{path}: {text}" if path else text)) from error


def _system(text: str, path: Path | None, isolators: Mapping[str, Isolator]) -> System:
    """Build the system of an MJCF text, which may come from the file `path`."""
    check_written(text, path)
    if path is not None and "file" in text:
        check_regular(path)
    try:
        spec = mujoco.MjSpec.from_file(str(path)) if path else mujoco.MjSpec.from_string(text)
        check_names(spec)
        plain = spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        raise ModelError(refusal_message(str(error), text)) from None
    check_visible(plain)
    check_numbers(plain)
    check_joints(plain)
    declared = declared_mounts(spec, plain, folder=path.parent if path else None, isolators=isolators)
    base = base_body(plain, declared)
    for mount in declared:
        body, site = int(plain.site_bodyid[mount.payload_site]), plain.site(mount.payload_site).name
        if plain.body_weldid[body] == 0:
            raise ModelError(f"mount {mount.name!r}: payload site {site!r} is fixed in the world: give its body a joint.")
        if base and plain.body_rootid[body] == base and plain.body_weldid[body] == base:
            raise ModelError(f"mount {mount.name!r}: payload site {site!r} belongs to the base; swap the two sites.")
    try:
        assembly = assemble(spec, declared, base)
    except (ValueError, mujoco.FatalError) as error:  # a name that is added to every model, taken by the model's own
        raise ModelError(refusal_message(str(error), text)) from None
    model = assembly.model
    roots = [int(model.body_rootid[model.site_bodyid[d.payload_site]]) for d in declared]
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mounts = {
        d.name: Mount(
            name=d.name, isolator=d.isolator.conditioned, written=d.isolator, isolator_name=d.isolator_name,
            payload_site=model.site(d.payload_site).name, base_site=model.site(d.base_site).name,
            payload_body=model.body(model.site_bodyid[d.payload_site]).name,
            base_body=model.body(model.site_bodyid[d.base_site]).name, position=data.site_xpos[d.base_site].copy(),
            axes=data.site_xmat[d.base_site].reshape(3, 3).copy(), states=assembly.tables.states[d.name],
        )
        for d in declared
    }  # fmt: skip
    return System(
        model=model, mounts=ByName(mounts),
        payloads=[model.body(root).name for root in dict.fromkeys(roots)], base=model.body(base).name if base else "",
        mjcf=text, path=path, isolators={d.isolator_name: d.isolator for d in declared},
        limits=declared_limits(model, base), assembly=assembly, combined_travel=judges_combined_travel(model),
        areas=declared_areas(spec, [d.name for d in declared]),
    )  # fmt: skip


def _read(source: str | Path) -> tuple[str, Path | None]:
    """Return the MJCF text of a source, and the path of its file; None for a text that is given itself."""
    if isinstance(source, str) and source.lstrip().startswith("<"):
        return source, None
    if not isinstance(source, str | PathLike):
        raise ValueError(f"`source` must be the path of an MJCF file, or MJCF text, got {source!r}.")
    path = Path(source)
    try:
        path = model_file(path) or path
        text = regular(path).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise ModelError(
            f"{path}, line {line}: the model cannot be read: this is not text in UTF-8. An MJCF file is XML; save it in UTF-8."
        ) from None
    except (OSError, ValueError) as error:  # a path that holds NUL is a ValueError
        why = why_unread(error if isinstance(error, OSError) else FileNotFoundError())
        raise ModelError(
            f"{short(str(path))}: the model cannot be read: {why} Expected is the path of an MJCF file, MJCF text, which "
            f"begins with <, or the name of a model that ships with the package: {', '.join(shipped_models())}."
        ) from None
    if not text.lstrip("\ufeff").lstrip().startswith("<"):
        raise ModelError(f"{path}: this is not a model; an MJCF file is XML and begins with <mujoco>.")
    if "\\" in path.resolve().as_posix():
        raise ModelError(f"{path.resolve()}: MuJoCo takes the backslash in this path for a slash; rename the folder or file.")
    return text, path.resolve()


def beyond_laws(system: System, deflections: Array, *, fraction: float = 1.0) -> tuple[str, str] | None:
    """Find the first mount beyond a fraction of its law's travel, with a description; deflections (n_mounts, 3) [m]."""
    for (name, mount), row in zip(system.mounts.items(), deflections, strict=True):
        if beyond := beyond_law(mount.isolator.axes, row, row, fraction=fraction):
            return name, beyond
    return None


def mount_rates(system: System, data: mujoco.MjData) -> Iterator[tuple[Array, Array]]:
    """Yield for each mount how fast its payload's site moves and turns against its base's, by velocity coordinates.

    Both are in the world's axes, (3, n_v), at the positions computed in `data`.
    """
    model = system.model
    for sites in system.assembly.tables.sites:
        rates = np.zeros((2, 2, 3, model.nv))  # of payload and base: of displacements and of turns
        for site, (moves, turns) in zip(sites, rates, strict=True):
            mujoco.mj_jac(model, data, moves, turns, data.site_xpos[sites[0]], int(model.site_bodyid[site]))
            for dof, shape in shapes_at(system, int(site)):
                moves[:, dof] += data.site_xmat[site].reshape(3, 3) @ shape
        moves, turns = rates[0] - rates[1]
        yield moves, turns


def shapes_at(system: System, site: int) -> Iterator[tuple[int, Array]]:
    """Yield velocity coordinate and shape [1/sqrt(kg)] in the site's axes, (3,), of every mode that moves a site."""
    return iter(system.assembly.subjects.shapes.get(site, ()))


def once_per_system(compute: Callable[[System], Value]) -> Callable[[System], Value]:
    """Cache the results of `compute` with each system; all callers share them and must not change them."""
    known: WeakKeyDictionary[System, Value] = WeakKeyDictionary()

    @wraps(compute)
    def value_of(system: System) -> Value:
        try:
            return known[system]
        except KeyError:
            return known.setdefault(system, compute(system))

    return value_of
