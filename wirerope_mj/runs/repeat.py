"""A run or a study computed again from its folder alone, and the differences from the stored numbers."""

import math
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.engine.response.histories import same_columns
from wirerope_mj.engine.response.scene import scene_to_dict
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.in_lanes import moving_indices
from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.engine.simulation.simulate import versions
from wirerope_mj.foundation.arrays import Integers
from wirerope_mj.foundation.errors import RecordError, WireRopeError
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.foundation.toml_file import flat_entries
from wirerope_mj.runs.folder import SUMMARY, Alterations, alterations
from wirerope_mj.runs.scenario_file import check_one_run, scenario_content, system_and_motion
from wirerope_mj.runs.write import is_streamed, read_summary, summary_content

# A difference, relative to what its kind of number is compared with, and where it is; infinite for texts and NaN.
Difference = tuple[float, str]
# Largest difference relative to a column's peak that another processor's rounding explains; a wrong input is far above.
AGREES = 1e-9


@dataclass(frozen=True, kw_only=True, repr=False)
class Replay(Summarised):
    """Comparison of a run with itself computed again, and the files of its folder that were altered."""

    # every stored number has the same bits: samples, peaks, states, scene, events, step, and those of summary.json
    identical: bool
    # of a stored number: of a sample relative to the largest of its column, of a peak to the largest of its components;
    # infinite where a text differs, or where there is something else
    largest_difference: float
    column: str  # where it is, a column or what else is stored; "" if all is identical
    response: Response | None  # what was computed; None if its samples were streamed and are gone
    # files that are not as they were written; None without checksums, as in older runs
    alterations: Alterations | None = None

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {} if self.identical else {"largest difference": f"{self.largest_difference:.1e} in {self.column}"}
        known = "as written" if self.intact else "altered since they were written"
        lines["files"] = "not known" if self.alterations is None else known
        if self.identical:
            return "Replay: every stored number is bit-identical", lines
        return f"Replay: {'in agreement' if self.agrees else 'DIFFERENT'}", lines

    @property
    def agrees(self) -> bool:
        """True if the numbers agree within the rounding of another processor."""
        return self.identical or self.largest_difference <= AGREES

    @property
    def intact(self) -> bool:
        """True if no file is known to be altered or missing."""
        return self.alterations is None or self.alterations.intact


def replay(folder: str | Path, *, progress: bool = False) -> Replay:
    """Compute a stored run again and compare it; nothing outside its folder is read.

    Raises:
        RecordError: the folder is not a complete run, or its files are damaged or not of one run; names those that were
            altered since it was written.
        ModelError: the model or an isolator in it is not what it must be.
    """
    folder = Path(folder)
    altered = alterations(folder) if folder.is_dir() else None
    try:
        content = scenario_content(folder)
        system, motion = system_and_motion(folder, content)
        stored = load_response(folder)
        check_one_run(folder, content, system, stored)
        computed = summary_content(judged_run(system, motion, stored, content), seconds=0.0)
        same_version = stored.numerics.versions.get("wirerope-mj") == versions()["wirerope-mj"]
        # Another version may write other texts and entries; folders without checksums are older than some of the sentences.
        texts = same_version and altered is not None
        without = _OF_THIS_TIME
        differences = list(_plain_differences(read_summary(folder), computed, SUMMARY, texts=texts, without=without))
        arguments = {key: value for key, value in content["simulate"].items() if key != "accuracy"}
        arguments.setdefault("engine", "mujoco")  # older runs knew no other
        long = is_streamed(arguments)
        with tempfile.TemporaryDirectory() as out:
            again = simulate(system, motion, **arguments, out=out if long else None, progress=progress)
            differences += _sample_differences(stored, again)
            differences += _peak_differences(stored, again)
            parts = np.split(moving_indices(system), [system.model.nq, system.model.nq + system.model.nv])
            differences += _rest_differences(stored, again, parts)
    except (WireRopeError, ValueError) as error:
        if altered is None or altered.intact:
            raise
        raise type(error)(f"{error} {altered.text}") from None  # of which it may be the consequence
    nonzero = [difference for difference in differences if difference[0] > 0.0]
    worst = max(nonzero, default=(0.0, ""))
    # the summary repeats what the response says, which is named first
    of_response = max((difference for difference in nonzero if not difference[1].startswith(SUMMARY)), default=worst)
    difference, where = of_response if (of_response[0] > AGREES) == (worst[0] > AGREES) else worst
    return Replay(
        identical=not where, largest_difference=difference, column=where, response=None if long else again, alterations=altered
    )


def replay_study(folder: str | Path, *, progress: bool = False) -> tuple[float, str]:
    """Simulate every variant of a study or a search again from its folder alone, and compare the tables.

    Returns:
        The largest difference of a measure, relative to the largest of its column, infinite where a text or what is missing
        differs; and the column, "" if every number has the same bits.

    Raises:
        RecordError: the folder is no study, is not complete, or is damaged.
    """
    from wirerope_mj.studies.engines.local import run_local  # late: with it comes all that studies need
    from wirerope_mj.studies.study import chunk_size, chunks, load_study

    result = load_study(folder)
    if not result.complete:
        raise RecordError(result.message)
    study = result.study
    numbers = range(math.ceil(study.size / chunk_size(study)))
    again = {}
    with share_bar("study", "variants", enabled=progress) as update:
        for part in run_local(study.work, chunks(study, numbers)):
            again[part.number] = part.table
            update(len(again) / len(numbers), study.size * len(again) / len(numbers))
    worst = (0.0, "")
    for name in again[0].column_names:
        old, new = (
            np.concatenate([np.asarray(table[name]) for table in tables])
            for tables in ([result.table], [again[number] for number in numbers])
        )
        same = (old == new) | ((old != old) & (new != new))
        if not same.all():
            sizes = np.abs(old.astype(float)) if old.dtype.kind == "f" else np.ones(1)
            apart = np.abs(old - new)[~same] if old.dtype.kind == "f" else np.array([math.inf])
            size = np.nanmax(sizes) or 1.0
            largest = float(np.nan_to_num(apart, nan=math.inf).max() / size)
            worst = max(worst, (largest, name))
    return worst


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


def _sample_differences(stored: Response, again: Response) -> Iterator[Difference]:
    """Yield the differences of samples, relative to the largest of their vector: single components may be nearly zero."""
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
    """Return the name of the vector of which a column is a component, or else the column's own."""
    vector, _, component = name.rpartition("/")
    return vector if component in ("w", "x", "y", "z", "roll", "shear", "axial") else name


def _peak_differences(stored: Response, again: Response) -> Iterator[Difference]:
    """Yield the differences of peaks: values relative to the largest of their peak, instants to the end of the run.

    The instant of a component that is rounding, as along an axis in which nothing moves, says nothing unless the component
    has the same bits, and neither does that of a value that is reached twice: their difference is `NEGLIGIBLE` then.
    """
    end = max(float(stored.time[-1]), again.timestep)
    expected, repeated = stored.peaks.to_dict(), again.peaks.to_dict()
    contacts, contacts_again = expected.pop("contacts"), repeated.pop("contacts")
    travels, travels_again = expected.pop("travels"), repeated.pop("travels")
    if contacts is not None:  # older responses have none
        for name, contact in contacts.items():
            if name in contacts_again:  # nor what stands beside them here
                contacts_again[name] |= {key: contact[key] for key in _ADDED if contact[key] in (None, "")}
        yield from _plain_differences(contacts, contacts_again, "peaks.contacts")
    if travels is not None:
        yield from _plain_differences(travels, travels_again, "peaks.travels")
    expected, repeated = flat_entries(expected), flat_entries(repeated)
    for where in [where for where in expected if expected[where] != repeated[where]]:
        peak, index = where.rsplit(".", 1)
        largest = max(abs(expected[f"{peak}.0"]), abs(repeated[f"{peak}.0"]), np.finfo(float).tiny)
        ratio = abs(expected[where] - repeated[where]) / (end if int(index) in _INSTANTS else largest)
        reached = f"{peak}.{_INSTANTS.get(int(index), 0)}"
        same = abs(expected[reached] - repeated[reached]) <= NEGLIGIBLE * largest
        yield NEGLIGIBLE if same and expected[reached] != repeated[reached] else ratio, f"peaks.{peak}"


_ADDED = ("energy", "axis", "gap_below", "gap_above", "rest", "closing_speed", "closing_time")  # Not in older contacts
# Positions of the instants in `Peak.to_list`, and of the values that are reached then.
_INSTANTS = {1: 0, **{8 + axis: 5 + axis for axis in range(3)}, **{14 + axis: 11 + axis for axis in range(3)}}


def _rest_differences(stored: Response, again: Response, parts: Sequence[Integers]) -> Iterator[Difference]:
    """Yield the differences of states, scene, events and step, relative to themselves.

    Of states each of the `parts`, positions, rates and internal states by their indices, is compared with its largest number.
    What else a state holds is the engine's own, and follows from them: if it is not identical, its difference is `NEGLIGIBLE`.
    """
    for name in ("initial_state", "final_state"):
        a, b = getattr(stored, name), getattr(again, name)
        expected, repeated = a.values, b.values
        # older states end before the memory of contacts, of travels, or of the speeds at which stops close
        stops = [contact for contact in (stored.peaks.contacts or {}).values() if contact.mount]
        if stored.peaks.travels is None or any(not stop.axis for stop in stops):
            repeated = repeated[: expected.size]
        if expected.shape != repeated.shape or a.time != b.time:
            yield np.inf, name
            continue
        if not np.array_equal(expected, repeated):
            ratios = [
                np.abs(expected[i] - repeated[i]).max(initial=0.0) / max(float(np.abs(expected[i]).max(initial=0.0)), _SMALLEST)
                for i in parts
            ]
            yield max(NEGLIGIBLE, *map(float, ratios)), name
    pairs = {
        "scene": (scene_to_dict(stored.scene), scene_to_dict(again.scene)),
        "events": ([list(event) for event in stored.events], [list(event) for event in again.events]),
        "numerics": tuple({key: asdict(run.numerics)[key] for key in ("timestep", "steps")} for run in (stored, again)),
    }
    for name, (stored_part, repeated_part) in pairs.items():
        yield from _plain_differences(stored_part, repeated_part, name)


def _plain_differences(
    expected: object, repeated: object, where: str, *, texts: bool = True, without: tuple[str, ...] = ()
) -> Iterator[Difference]:
    """Yield the differences between values of TOML or JSON: numbers relative to themselves, anything else infinite."""
    expected_entries, repeated_entries = (flat_entries(value, label=_label) for value in (expected, repeated))
    for key in dict.fromkeys((*expected_entries, *repeated_entries)):
        if key.startswith(without) if without else False:
            continue
        if key not in expected_entries or key not in repeated_entries:
            if texts:
                yield np.inf, f"{where} {key}"
            continue
        a, b = expected_entries[key], repeated_entries[key]
        if _is_number(a) and _is_number(b):
            if a != b and not (a != a and b != b):  # NaN says in both that something is not known
                known = np.isfinite(a) and np.isfinite(b)
                yield abs(a - b) / max(abs(a), abs(b)) if known else np.inf, f"{where} {key}"
        elif a != b and (texts or _is_number(a) or _is_number(b)):
            if not texts and key.startswith("judged.") and key.rpartition(".")[2] in _JUDGEMENT:
                continue
            yield np.inf, f"{where} {key}"


def _label(item: object, number: int) -> str:
    """Name an entry of a list by its criterion, subject or name, if it has any, or else by its number."""
    known = [str(item[key]) for key in _LABELS if key in item] if isinstance(item, Mapping) else []
    return " of ".join(known) or str(number)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
