"""Tables of files made into the classes that state their fields, bounds and units once.

A class is a dataclass. The type of a field says what its key may hold: `float` is a finite number, and
`Annotated[float, bounds("m", gt=0.0)]` a length > 0. msgspec brings values into their types, holds them to their bounds and
writes their schemas (`schema.py` beside this file); keys, units, lines and what a message says of them are done here.
"""

import math
import re
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from datetime import date
from difflib import get_close_matches
from functools import cache, reduce
from operator import or_
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import msgspec
import numpy as np

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.faults import each
from wirerope_mj.foundation.plain_text import quoted, short
from wirerope_mj.foundation.toml_file import line_of
from wirerope_mj.foundation.units import in_si

T = TypeVar("T")
UNKNOWN = "unknown"  # mark of a number that may be NaN, where it is not known, or infinite
NEEDED = "needed"  # mark of a field that a file must state, though it has a default in Python
DATE = "date"  # mark of a text that may stand in a file as a date of TOML


def bounds(unit: str = "", **limits: Any) -> msgspec.Meta:
    """Mark the unit of a field and its bounds gt, ge, lt, le, or min_length, as `msgspec.Meta` does."""
    return msgspec.Meta(**limits, extra_json_schema={"unit": unit} if unit else None)


Positive = Annotated[float, bounds(gt=0.0)]
NotNegative = Annotated[float, bounds(ge=0.0)]


@dataclass(frozen=True, eq=False)
class In:
    """Mark of a field whose key in a file ends with one of some units, `travel_mm`; if `bare`, it may stand alone, in SI."""

    units: Mapping[str, float | tuple[float, ...]]  # their values in SI: of a number or of all in a list, or of columns
    bare: bool = False


@dataclass(frozen=True)
class Key:
    """Mark of a field whose key in a file is another than its name."""

    name: str


@dataclass(frozen=True, eq=False)
class Among:
    """Mark of a mapping field whose keys stand in the table itself, beside the keys of other fields."""

    keys: Collection[str]


@dataclass(frozen=True)
class Shape:
    """Mark of a field that is an array of numbers, and the sizes of its axes; None may be any."""

    sizes: tuple[int | None, ...]
    finite: bool = True  # else what is not known may be NaN


@dataclass(frozen=True)
class Place:
    """Location of a table, by its file and the keys that lead to it; builds the errors that name both."""

    file: Path | str  # lines are found in a path, and not in a text, which messages begin with all the same
    keys: tuple[str | int, ...] = ()
    error: type[Exception] = ModelError
    remedy: str = ""  # with which every message ends

    def at(self, *keys: str | int) -> "Place":
        """Return the place of a table or an entry inside this one."""
        return replace(self, keys=(*self.keys, *keys))

    @property
    def folder(self) -> Path:
        """Folder of the file, from which relative paths in it start."""
        return self.file.parent if isinstance(self.file, Path) else Path()

    @property
    def table(self) -> str:
        """Name of the table in TOML, "[limits.travel]" or "[[stage]] 2"; "" for the whole file."""
        dotted = ".".join(key for key in self.keys if isinstance(key, str))
        numbers = [key for key in self.keys if isinstance(key, int)]
        if len(numbers) == 1 and self.keys[-1] is numbers[0]:
            return f"[[{dotted}]] {numbers[0] + 1}"
        return f"[{'.'.join(map(str, self.keys))}]" if dotted else ""

    def fault(self, text: str) -> Exception:
        """Build the error of a fault in the table, at the line of the first `key` or [table] that `text` names."""
        named = [table or key for table, key in re.findall(r"\[(\w+)\]|`([^`]+)`", text)]
        line = line_of(self.file, self.keys, named) if isinstance(self.file, Path) else None
        where = f"{self.file}, line {line}" if line else str(self.file)
        return self.error(" ".join(filter(None, (f"{where}:", self.table, text, self.remedy))))


Readers = Mapping[type, Callable[[Any, Place], Any]]  # of classes that are not read field by field


def structure(kind: type[T], table: object, place: Place, readers: Readers | None = None) -> T:
    """Build a dataclass from a table of a file.

    Args:
        kind: of which the fields are the keys of the table; a field that is a dataclass is a table in it.
        table: as TOML or JSON is read.
        place: where it stands, for messages.
        readers: of tables that are not read field by field, by the class that they return.

    Raises:
        Exception: `place.error`; names file, line, table and key, what must hold of it, what was got, and the nearest key.
    """
    if not isinstance(table, dict):
        raise place.fault(f"it must be a table, got {quoted(table)}.")
    dataclass_: Any = kind
    known, needed = keys_of(dataclass_), needed_keys(dataclass_)
    values, unknown = dict[str, Any](), [key for key in table if key not in known]

    def read(key: str) -> None:
        if key in unknown:
            meant = "".join(f" Did you mean `{near}`?" for near in get_close_matches(key, known, n=1))
            others = f"; known: {', '.join(known)}." if key is unknown[0] else ", too."  # which are many
            raise place.fault(f"`{short(key)}` is unknown{others}{meant}")
        field = known[key]
        value = _structured(field.hint, table[key], place, key, readers or {})
        if field.among:
            values.setdefault(field.field, {})[key] = value
        elif field.field in values:
            raise place.fault(f"`{field.field}` is stated twice, as `{key}`, too.")
        else:
            values[field.field] = _in_si(value, field.factor)

    each(read, table)
    for name, keys in needed.items():
        if name not in values:
            said = " or ".join(f"`{key}`" for key in keys)
            raise place.fault(f"{said} is missing; needed: {', '.join(keys[0] for keys in needed.values())}.")
    try:
        return kind(**values)
    except ValueError as error:
        raise place.fault(str(error)) from None


def check(value: Any) -> None:
    """Convert the fields of a frozen dataclass to their types, in its `__post_init__`; ValueError names a wrong one."""
    kind: Any = type(value)
    for name, hint in _hints(kind).items():
        object.__setattr__(value, name, checked(name, getattr(value, name), hint))


def checked(name: str, value: object, hint: Any) -> Any:
    """Convert a value to its type, integers to floats; ValueError states what must hold and what was got."""
    if type(value) is float and math.isfinite(value) and _is_number_within(value, hint):
        return value
    marks = marks_of(hint)
    if shape := next((mark for mark in marks if isinstance(mark, Shape)), None):
        try:
            array = np.array(value, dtype=np.float64)
        except (TypeError, ValueError):
            array = np.array(math.nan)
        if not array.size and None in shape.sizes:
            return np.zeros([size or 0 for size in shape.sizes])
        fits = len(shape.sizes) == array.ndim and all(
            size in (None, n) for size, n in zip(shape.sizes, array.shape, strict=True)
        )
        if not fits or (shape.finite and not np.isfinite(array).all()):
            sizes = " x ".join("n" if size is None else str(size) for size in shape.sizes)
            raise ValueError(f"`{name}` must be {sizes} finite numbers, got {quoted(value, 60)}.")
        return array
    if UNKNOWN in marks and isinstance(value, float) and not math.isfinite(value):
        return value
    value = str(value) if isinstance(value, date) and DATE in marks else _plain(value)
    if value is None and (NoneType, ()) in options_of(hint):
        return None
    how, inner = tables_in(hint)
    if how is None and isinstance(value, inner):
        return value
    if how is tuple and isinstance(value, list | tuple) and all(isinstance(entry, inner) for entry in value):
        return tuple(value)
    for option, _ in options_of(hint):
        if get_origin(option) in (dict, Mapping) and isinstance(value, Mapping):
            return {key: checked(f"{name}[{key!r}]", entry, get_args(option)[1]) for key, entry in value.items()}
    values = _values_in(hint)
    try:
        if values is not NoneType and _is_finite(value):
            converted = msgspec.convert(value, values)
            return tuple(converted) if isinstance(converted, list) else converted
    except msgspec.ValidationError:
        pass
    meant = ""
    for most in (mark.le for mark in marks if isinstance(mark, msgspec.Meta) and unit_of(mark) == "m"):
        if most is not None and isinstance(value, int | float) and most < value <= 1e3 * most:
            meant = f" If these are millimetres, write {1e-3 * value:.6g}."
    raise ValueError(f"`{name}` must be {said_of(hint)}, got {quoted(value)}.{meant}")


def said_of(hint: Any, *, plural: bool = False) -> str:
    """Describe a type: "a finite number > 0 [m]"."""
    return " or ".join(_said_of(option, marks, plural) for option, marks in options_of(hint) if option is not NoneType)


def _said_of(option: Any, marks: tuple[Any, ...], plural: bool) -> str:
    """Describe one type of a union, with the bounds and the unit in its marks."""
    origin, args = get_origin(option) or option, get_args(option)
    if origin is Literal:
        text = f"{'one of ' if len(args) > 1 else ''}{', '.join(map(repr, args))}"
    elif origin is tuple and args[-1] is not Ellipsis:
        text = f"{'lists of ' if plural else ''}{len(args)} {said_of(args[0], plural=True)}"
    elif origin in (tuple, list, Sequence):
        text = f"{'lists' if plural else 'a list'} of {said_of(args[0], plural=True)}"
    elif origin in (dict, Mapping):
        text = f"{'tables' if plural else 'a table'} of {said_of(args[1], plural=True)}"
    elif option in _KINDS:
        text = _KINDS[option][plural]
    else:
        text = "tables" if plural else f"{'an' if option.__name__[0] in 'AEIOU' else 'a'} {option.__name__}"
    metas = [mark for mark in marks if isinstance(mark, msgspec.Meta)]
    signs = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
    limits = [(sign, getattr(meta, name)) for meta in metas for name, sign in signs.items()]
    bounded = " and".join(f" {sign} {limit:g}" for sign, limit in limits if limit is not None)
    text += re.sub(r"^ >= (\S+) and <= ", r" from \1 to ", bounded)
    text += "".join(f" [{unit}]" for meta in metas if (unit := unit_of(meta)))
    return text + (" that is not empty" if any(meta.min_length for meta in metas) else "")


_KINDS = {
    float: ("a finite number", "finite numbers"), int: ("an integer", "integers"), bool: ("true or false", "flags"),
    str: ("a text", "texts"),
}  # fmt: skip


def unit_of(meta: msgspec.Meta) -> str:
    return str((meta.extra_json_schema or {}).get("unit", ""))


def _is_class(option: Any) -> bool:
    return isinstance(option, type) and option not in (*_KINDS, NoneType, Any) and get_origin(option) is None


def _plain(value: object) -> object:
    if isinstance(value, list | tuple):
        return type(value)(map(_plain, value)) if type(value) in (list, tuple) else value
    return value.tolist() if isinstance(value, np.generic | np.ndarray) else value


def _is_finite(value: object) -> bool:
    if isinstance(value, list | tuple):
        return all(map(_is_finite, value))
    if isinstance(value, dict):
        return all(map(_is_finite, value.values()))
    return not isinstance(value, float | int) or abs(value) <= sys.float_info.max


@cache
def options_of(hint: Any, marks: tuple[Any, ...] = ()) -> list[tuple[Any, tuple[Any, ...]]]:
    """Return the types of a union, or the only one, each with its marks."""
    if get_origin(hint) is Annotated:
        return options_of(hint.__origin__, (*marks, *hint.__metadata__))
    if get_origin(hint) in (Union, UnionType):
        return [option for arg in get_args(hint) for option in options_of(arg, marks)]
    return [(hint, marks)]


def _is_number_within(value: float, hint: Any) -> bool:
    def holds(meta: msgspec.Meta) -> bool:
        above = (meta.gt is None or value > meta.gt) and (meta.ge is None or value >= meta.ge)
        return above and (meta.lt is None or value < meta.lt) and (meta.le is None or value <= meta.le)

    return hint is float or any(
        option is float and all(holds(mark) for mark in marks if isinstance(mark, msgspec.Meta))
        for option, marks in options_of(hint)
    )


@cache
def marks_of(hint: Any) -> tuple[Any, ...]:
    return tuple(mark for _, marks in options_of(hint) for mark in marks)


@cache
def _hints(kind: Any) -> dict[str, Any]:
    hints = get_type_hints(kind, include_extras=True)
    return {item.name: hints[item.name] for item in fields(kind) if item.init}


@cache
def bounds_of(kind: Any) -> dict[str, msgspec.Meta]:
    """Collect the marks of `bounds` on the fields of a class, by their names."""
    metas = {name: [m for m in marks_of(hint) if isinstance(m, msgspec.Meta)] for name, hint in _hints(kind).items()}
    return {name: marks[0] for name, marks in metas.items() if marks}


@dataclass(frozen=True)
class _Filled:
    field: str
    hint: Any
    factor: float | tuple[float, ...] | None = None
    among: bool = False
    meant: Any = None  # what a mapping of `Among` holds under the key: it has `example` and `summary`


@cache
def keys_of(kind: Any) -> dict[str, _Filled]:
    """Return the keys that a class's table may have in a file, and the field that each fills."""
    keys: dict[str, _Filled] = {}
    for name, hint in _hints(kind).items():
        marks = marks_of(hint)
        spelled = next((mark.name for mark in marks if isinstance(mark, Key)), name)
        units = next((mark for mark in marks if isinstance(mark, In)), None)
        among = next((mark for mark in marks if isinstance(mark, Among)), None)
        if among:
            entry, meant = get_args(options_of(hint)[0][0])[1], among.keys if isinstance(among.keys, Mapping) else {}
            keys |= {key: _Filled(name, entry, among=True, meant=meant.get(key)) for key in among.keys}
        if not among and (units is None or units.bare):
            keys[spelled] = _Filled(name, hint)
        keys |= {f"{spelled}_{unit}": _Filled(name, hint, factor) for unit, factor in (units.units if units else {}).items()}
    return keys


@cache
def needed_keys(kind: Any) -> dict[str, list[str]]:
    """Return the required fields, each with the keys that may state it."""
    items = {item.name: item for item in fields(kind)}
    keys: dict[str, list[str]] = {}
    for key, field in keys_of(kind).items():
        item = items[field.field]
        if NEEDED in marks_of(field.hint) or item.default is item.default_factory is MISSING:
            keys.setdefault(field.field, []).append(key)
    return keys


def _structured(hint: Any, value: Any, place: Place, key: Any, readers: Readers) -> Any:
    """Convert the value of a key: tables and lists of tables to their classes, all else to its type."""
    how, inner = tables_in(hint)
    if how is None and inner in readers:
        return readers[inner](value, place.at(key))
    if inner is Path and isinstance(value, str):
        return place.folder / value
    if how is None and isinstance(value, dict) and inner is not Path:
        return structure(inner, value, place.at(key), readers)
    values = [get_args(option)[1] for option, _ in options_of(hint) if get_origin(option) in (dict, Mapping)]
    if values and isinstance(value, dict):
        return {name: _structured(values[0], entry, place.at(key), name, readers) for name, entry in value.items()}
    if how is tuple and isinstance(value, list) and all(isinstance(entry, dict) for entry in value):
        return tuple(each(lambda one: _structured(inner, one[1], place.at(key), one[0], readers), enumerate(value)))
    if hint is Any:
        return value
    try:
        return checked(key, value, hint)
    except ValueError as error:
        said = "the path of a file" if inner is Path else "a table"
        raise place.fault(str(error).replace(said_of(inner), said) if how is None else str(error)) from None


@cache
def _values_in(hint: Any) -> Any:
    """Return the part of a type that msgspec converts: without dataclasses, and lists and mappings of these."""
    if tables_in(hint)[0] is float:
        return hint
    options = [
        Annotated[(option, *marks)] if marks else option
        for option, marks in options_of(hint)
        if option is not NoneType and tables_in(option)[0] is float
    ]
    return reduce(or_, options) if options else NoneType


@cache
def tables_in(hint: Any) -> tuple[Any, Any]:
    """Return the container of tables in a type (None, `tuple` or a mapping) and their class; `float` twice without tables."""
    for option, _ in options_of(hint):
        origin, args = get_origin(option), get_args(option)
        if _is_class(option):
            return None, option
        if origin in (tuple, dict, Mapping) and _is_class(inner := options_of(args[0 if origin is tuple else -1])[0][0]):
            return origin, inner
    return float, float


def _in_si(value: Any, factor: float | tuple[float, ...] | None) -> Any:
    if factor is None or isinstance(value, str):
        return value
    if isinstance(factor, tuple):
        return tuple(tuple(map(in_si, row, factor)) for row in value)
    return tuple(in_si(number, factor) for number in value) if isinstance(value, list | tuple) else in_si(value, factor)
