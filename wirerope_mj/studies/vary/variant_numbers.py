"""The variants of a study by the numbers in which their equations differ, without systems of their own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.kernel.equations import equations
from wirerope_mj.engine.kernel.variants import Numbers
from wirerope_mj.engine.simulation.engines import unsupported_motion
from wirerope_mj.engine.simulation.simulate import check_direction
from wirerope_mj.engine.simulation.stability import rates_of, variant_rates
from wirerope_mj.engine.system import System, once_per_system
from wirerope_mj.foundation.arrays import Array, Entries, Integers
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import AXES, Isolator
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.plane import Form, form_of, rates_in_plane
from wirerope_mj.studies.vary.quantity import Draft
from wirerope_mj.studies.vary.variants import Maker, Work, systems_valid


@dataclass(frozen=True, kw_only=True)
class Variants:
    """Variants by the numbers in which their equations differ."""

    indices: list[int]  # which of the rows they are
    motions: list[BaseMotion]  # of their bases
    isolators: Sequence[Mapping[str, Isolator]]  # of the mounts that have others than the system's
    numbers: Array  # of their equations, (n, n_num)
    rates: Array  # of their laws, as `rates_of` has them, (n, 5, 3 n_mounts)
    shifts: Array  # of their mounts along the world's axes [m], (n, n_mounts, 3)


@once_per_system
def _writer(system: System) -> Numbers:
    return Numbers(system, equations(system))


def variants_of(work: Work, rows: Sequence[Entries]) -> Variants:
    """Return the numbers of the variants that are valid and whose equations have the structure of the study's system."""
    system, make = work.system, Maker(work.system, work.motions, work.columns)
    table = pa.table({column.name: [row[column.name] for row in rows] for column in work.columns})
    valid = systems_valid(system, work.columns, table)
    own_rates = variant_rates(system).own
    laws: _Laws = {}
    checked: set[int] = set()  # of motions, by their identity: `make` keeps them
    written: _Written = {}
    indices, motions, isolators, numbers, rates, shifts = [], [], [], [], [], []
    for index, row in enumerate(rows):
        try:
            draft, motion = make.draft(row), make.motion(row)
            if id(motion) not in checked:
                if unsupported_motion(system, motion):
                    continue
                check_direction(system, motion)
                checked.add(id(motion))
            base = equations(system).num.copy(), own_rates.copy()
            if plain := valid and _plain(draft):
                _write_laws(draft, *base, laws)
            replaced = make.isolators(draft, draft.gone if plain else [*draft.isolators, *draft.parameters, *draft.gone])
            if not all(_write_isolator(system, mount, isolator, *base, written) for mount, isolator in replaced.items()):
                continue
            changes = make.moves(draft, {})
            _writer(system).write_springs(base[0], changes)
            if not _writer(system).write_geometry(base[0], changes):
                continue
        except (ValueError, WireRopeError):
            continue  # says so where it is made alone
        indices.append(index)
        motions.append(motion)
        isolators.append(replaced)
        numbers.append(base[0])
        rates.append(base[1])
        shifts.append([changes.positions.get(mount, (0.0, 0.0, 0.0)) for mount in system.mounts])
    return Variants(
        indices=indices, motions=motions, isolators=isolators, numbers=np.array(numbers), rates=np.array(rates),
        shifts=np.array(shifts),
    )  # fmt: skip


# By mount and identity of an isolator, which `Maker` keeps: its numbers and where they stand, the rates of its laws and
# the columns in which they stand; None if it has another structure than the system's.
_Written = dict[tuple[str, int], tuple[Integers, Array, slice, Array] | None]
# By law and parameters: its kernel's parameters, its rates, and the forms of its scales if it is coupled.
_Forms = list[Form]
_Laws = dict[object, tuple[Array, tuple[float, ...], _Forms]]


def _plain(draft: Draft) -> bool:
    """Tell whether a draft changes only parameters of laws, in isolators that act as their files state them."""
    mounts = draft.system.mounts
    return not draft.isolators and all(
        mounts[mount].written.conditioned is mounts[mount].written and all(part in AXES for part, _ in parameters)
        for mount, parameters in draft.parameters.items()
    )


def _write_isolator(system: System, mount: str, isolator: Isolator, numbers: Array, rates: Array, written: _Written) -> bool:
    """Write an isolator to the numbers of the equations and to the laws' rates; return False if it has another structure."""
    key = (mount, id(isolator))
    if key not in written:
        acting, first = isolator.conditioned, 3 * list(system.mounts).index(mount)
        written_numbers = _writer(system).of_isolator(mount, acting) if acting.holds_everywhere else None
        of_laws = np.array([rates_of(law) for law in acting.axes.values()]).T
        written[key] = None if written_numbers is None else (*written_numbers, slice(first, first + 3), of_laws)
    if (known := written[key]) is None:
        return False
    places, values, columns, of_laws = known
    numbers[places], rates[:, columns] = values, of_laws
    return True


def _write_laws(draft: Draft, numbers: Array, rates: Array, laws: _Laws) -> None:
    """Write new, valid parameters of laws to the numbers of the equations and to the laws' rates."""
    system, writer, gone = draft.system, _writer(draft.system), draft.gone
    for number, (mount, written) in enumerate(system.mounts.items()):
        if mount not in draft.parameters or mount in gone:
            continue
        forms_of_mount: dict[str, Entries] = {}
        for (axis, name), value in draft.parameters[mount].items():
            forms_of_mount.setdefault(axis, {})[name] = value
        isolator, forms = written.isolator, {}
        for axis, values in forms_of_mount.items():
            law, place = isolator.axes[axis], AXES.index(axis)
            assert law is not None  # the column has seen to it
            key = (id(law), tuple(sorted(values.items())))
            if key not in laws:
                varied = law.unchecked(values)
                laws[key] = _numbers_of(varied, coupled=place in isolator.coupled_axes)
            parameters, rates[:, 3 * number + place], forms[place] = laws[key]
            writer.write_law(numbers, mount, place, parameters)
        if isolator.coupled_axes and any(place in isolator.coupled_axes for place in forms):
            first, second = (forms.get(place) or _forms(isolator.axes[AXES[place]], laws) for place in isolator.coupled_axes)
            scales = map(rates_in_plane, first, second)
            writer.write_coupling(numbers, mount, np.array([value for scale in scales for value in scale]))


def _numbers_of(law: Law, *, coupled: bool) -> tuple[Array, tuple[float, ...], _Forms]:
    return law.kernel_parameters(), rates_of(law), [form_of(part) for part in law.components] if coupled else []


def _forms(law: Law | None, laws: _Laws) -> _Forms:
    """Return sigma, n, bound and yield deflection (`form_of`) of the components of a coupled law that does not vary."""
    assert law is not None  # it is coupled
    key = (id(law), ())
    if key not in laws:
        laws[key] = _numbers_of(law, coupled=True)
    return laws[key][2]
