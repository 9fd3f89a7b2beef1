"""Differences between the numbers that a run's folder holds and those that are computed again."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.response.histories import same_columns
from wirerope_mj.engine.response.scene import scene_to_dict
from wirerope_mj.foundation.arrays import Entries, Integers
from wirerope_mj.runs.folder import SUMMARY

# A difference, relative to what its kind of number is compared with, and where it is; infinite for texts and NaN.
Difference = tuple[float, str]
# Next to the largest number of its vector: what is smaller is rounding, as along an axis in which nothing moves.
NEGLIGIBLE = 1e-9
_BLOCK = 64  # columns that are compared at once
# Entries of summary.json that are not the same when it is computed again, that older ones lack, or that say others anew.
_OF_THIS_TIME = (
    "numerics.seconds", "numerics.versions", "numerics.engine", "numerics.why_not_kernel", "numerics.samples_hold",
    "content",
)  # fmt: skip
# Entries of a judged value that another version may state where this one judges nothing, or the other way round.
_JUDGEMENT = ("limit", "margin")
_SMALLEST = 1e-3  # Scale of positions [m, rad], rates [m/s, rad/s] and internal states [N] that are smaller
_LABELS = ("criterion", "subject", "name")


def sample_differences(stored: Response, again: Response) -> Iterator[Difference]:
    """Yield the differences of samples, relative to the largest of their vector: a component may be all but nothing."""
    names = stored.samples.names
    if not same_columns(names, again.samples.names) or not np.array_equal(stored.time, again.time):
        yield np.inf, "the columns or the sample instants themselves"
        return
    largest: dict[str, float] = {}
    differences: dict[str, float] = {}
    for first in range(0, len(names), _BLOCK):
        block = names[first : first + _BLOCK]
        a = stored.samples.columns(first, first + len(block))
        b = again.samples.columns(first, first + len(block))
        for name, size, difference in zip(block, np.abs(a).max(axis=0), np.abs(a - b).max(axis=0), strict=True):
            largest[_vector(name)] = max(largest.get(_vector(name), np.finfo(float).tiny), float(size))
            if difference != 0.0:  # of NaN, too
                differences[name] = float(difference)
    for name, difference in differences.items():
        yield difference / largest[_vector(name)], name


def _vector(name: str) -> str:
    """Return the name of the vector of which a column is a component, or that of the column."""
    vector, _, component = name.rpartition("/")
    return vector if component in ("w", "x", "y", "z", "roll", "shear", "axial") else name


def peak_differences(stored: Response, again: Response) -> Iterator[Difference]:
    """Yield the differences of peaks: values relative to the largest of their peak, instants to the end of the run.

    The instant of a component that is rounding, as along an axis in which nothing moves, says nothing unless the component
    has the same bits, and neither does that of a value that is reached twice: their difference is `NEGLIGIBLE` then.
    """
    end = max(float(stored.time[-1]), again.timestep)
    mine, other = stored.peaks.to_dict(), again.peaks.to_dict()
    contacts, contacts_again = mine.pop("contacts"), other.pop("contacts")
    travels, travels_again = mine.pop("travels"), other.pop("travels")
    if contacts is not None:  # older responses have none
        for name, contact in contacts.items():
            if contact["energy"] is None and name in contacts_again:  # nor its energy
                contacts_again[name]["energy"] = None
        yield from _plain_differences(contacts, contacts_again, "peaks.contacts")
    if travels is not None:
        yield from _plain_differences(travels, travels_again, "peaks.travels")
    mine, other = _flat(mine), _flat(other)
    for where in [where for where in mine if mine[where] != other[where]]:
        peak, index = where.rsplit(".", 1)
        largest = max(abs(mine[f"{peak}.0"]), abs(other[f"{peak}.0"]), np.finfo(float).tiny)
        ratio = abs(mine[where] - other[where]) / (end if int(index) in _INSTANTS else largest)
        reached = f"{peak}.{_INSTANTS.get(int(index), 0)}"
        same = abs(mine[reached] - other[reached]) <= NEGLIGIBLE * largest
        yield NEGLIGIBLE if same and mine[reached] != other[reached] else ratio, f"peaks.{peak}"


# Positions of the instants in `Peak.to_list`, and of the values that are reached then.
_INSTANTS = {1: 0, **{8 + axis: 5 + axis for axis in range(3)}, **{14 + axis: 11 + axis for axis in range(3)}}


def rest_differences(stored: Response, again: Response, parts: Sequence[Integers]) -> Iterator[Difference]:
    """Yield the differences of states, scene, events and step, relative to themselves.

    Of states each of the `parts`, positions, rates and internal states by their indices, is compared with its largest number.
    What else a state holds is the engine's own, and follows from them: if it is not identical, its difference is `NEGLIGIBLE`.
    """
    for name in ("initial_state", "final_state"):
        a, b = getattr(stored, name), getattr(again, name)
        mine, other = a.values, b.values
        if stored.peaks.travels is None:  # older states end before the memory of contacts, or of travels
            other = other[: mine.size]
        if mine.shape != other.shape or a.time != b.time:
            yield np.inf, name
            continue
        if not np.array_equal(mine, other):
            ratios = [
                np.abs(mine[i] - other[i]).max(initial=0.0) / max(float(np.abs(mine[i]).max(initial=0.0)), _SMALLEST)
                for i in parts
            ]
            yield max(NEGLIGIBLE, *map(float, ratios)), name
    pairs = {
        "scene": (scene_to_dict(stored.scene), scene_to_dict(again.scene)),
        "events": ([list(event) for event in stored.events], [list(event) for event in again.events]),
        "numerics": tuple({key: asdict(one.numerics)[key] for key in ("timestep", "steps")} for one in (stored, again)),
    }
    for name, (here, there) in pairs.items():
        yield from _plain_differences(here, there, name)


def summary_differences(stored: Mapping[str, object], computed: Mapping[str, object], *, texts: bool) -> Iterator[Difference]:
    """Yield the differences between the stored content of summary.json and what the stored response gives.

    With `texts`, texts and the entries themselves are compared, which another version may write otherwise, as it may judge
    other values: the values are compared all the same.
    """
    yield from _plain_differences(stored, computed, SUMMARY, texts=texts, without=_OF_THIS_TIME)


def _plain_differences(
    mine: object, other: object, where: str, *, texts: bool = True, without: tuple[str, ...] = ()
) -> Iterator[Difference]:
    """Yield the differences between plain values: numbers relative to themselves, anything else infinite."""
    one, two = _flat(mine), _flat(other)
    for key in dict.fromkeys((*one, *two)):
        if key.startswith(without) if without else False:
            continue
        if key not in one or key not in two:
            if texts:
                yield np.inf, f"{where} {key}"
            continue
        a, b = one[key], two[key]
        if _is_number(a) and _is_number(b):
            if a != b and not (a != a and b != b):  # NaN says in both that something is not known
                known = np.isfinite(a) and np.isfinite(b)
                yield abs(a - b) / max(abs(a), abs(b)) if known else np.inf, f"{where} {key}"
        elif a != b and (texts or _is_number(a) or _is_number(b)):
            if not texts and key.startswith("judged.") and key.rpartition(".")[2] in _JUDGEMENT:
                continue
            yield np.inf, f"{where} {key}"


def _flat(value: object, where: str = "") -> Entries:
    """Return the numbers and texts in nested tables and lists by name; entries of a list by what they are called."""
    if isinstance(value, Mapping):
        items = [(str(key), item) for key, item in value.items()]
    elif isinstance(value, list | tuple):
        items = [(_label(item, number), item) for number, item in enumerate(value)]
    else:
        return {where: value}
    flat = {} if items or not where else {where: len(items)}
    for key, item in items:
        flat |= _flat(item, f"{where}.{key}" if where else key)
    return flat


def _label(item: object, number: int) -> str:
    known = [str(item[key]) for key in _LABELS if key in item] if isinstance(item, Mapping) else []
    return " of ".join(known) or str(number)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
