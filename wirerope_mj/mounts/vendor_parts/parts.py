"""Parts of the vendors' tables, and isolators by name: files, those of the catalogue, and these parts, whose fits ship.

The tables state load, travel and stiffnesses in compression, at 45 degrees, and in shear or roll.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
from functools import cache
from os.path import exists, isfile  # as those of `Path`, but a name that is too long is none
from pathlib import Path

from wirerope_mj.foundation.errors import ModelError, RecordError, WireRopeError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.foundation.table_files import number_in, read_header, rows_below
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.foundation.units import FORCE_UNITS, LENGTH_UNITS, STIFFNESS_UNITS, in_si
from wirerope_mj.mounts.isolator import Isolator

MODES = ("compression", "45", "shear")  # Loading modes of the tables; shear stands for roll as well
_UNITS = {"-": 1.0, **LENGTH_UNITS, **FORCE_UNITS, **STIFFNESS_UNITS}


@dataclass(frozen=True, kw_only=True)
class Series:
    """A vendor's table."""

    file: str  # its name below `models/isolators/vendors`
    source: str  # the documents
    damping: float  # damping ratio that a fit aims at [-], within `damping_range`
    damping_range: tuple[float, float]  # of the series, as the vendor states it [-]


# The tables that ship; the damping ratios are those of the catalogue's fitted isolators.
SERIES = (
    Series(
        file="enidine_wr.csv", source="ITT Enidine WR series catalogue ENI877R4, read from a public transcription",
        damping=0.11, damping_range=(0.05, 0.15),
    ),
    Series(
        file="vmc_cb.csv", source="VMC/Aeroflex and Socitec CB data sheets, read from a public transcription",
        damping=0.20, damping_range=(0.15, 0.20),
    ),
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ModeValues:
    """Values of one loading mode; None = not stated."""

    static_load: float | None = None  # largest static load [N]
    travel: float | None = None  # largest dynamic deflection [m]
    vibration: float | None = None  # stiffness of small vibration [N/m]
    shock: float | None = None  # mean stiffness over the travel [N/m]

    def scaled(self, fraction: float) -> "ModeValues":
        """Return the values with a fraction of the loops: load and stiffnesses in proportion, the same travel."""
        stated = {name: getattr(self, name) for name in ("static_load", "vibration", "shock")}
        return replace(self, **{name: fraction * value for name, value in stated.items() if value is not None})


@dataclass(frozen=True, kw_only=True)
class VendorPart:
    """One row of a vendor's table, in SI units."""

    name: str
    series: Series
    loops: int | None  # number of loops; None = not stated, as for the next four
    rope: float | None  # diameter of the rope [m]
    height: float | None  # unloaded [m]
    width: float | None  # across the bars [m]
    bar: float | None  # thickness of one bar [m]
    modes: Mapping[str, ModeValues]  # values by loading mode

    def with_loops(self, loops: int) -> "VendorPart":
        """Return the part with fewer loops: load and stiffness in proportion (the vendor's own rule).

        ValueError: the part has no more loops than that, or the vendor does not say how many.
        """
        if self.loops is None or not 0 < loops < self.loops:
            have = "an unknown number of" if self.loops is None else str(self.loops)
            raise ValueError(f"`loops` must be an integer > 0 below those of {self.name} ({have} loops), got {loops}.")
        modes = {mode: values.scaled(loops / self.loops) for mode, values in self.modes.items()}
        return replace(self, name=f"{self.name} ({loops} of {self.loops} loops)", loops=loops, modes=modes)


@cache
def vendor_parts() -> tuple[VendorPart, ...]:
    """Return the parts of all tables that ship, in their order."""
    folder = catalogue_folder() / "vendors"
    return tuple(part for series in SERIES for part in read_table(folder / series.file, series))


def read_table(path: Path, series: Series) -> list[VendorPart]:
    """Return the parts of a CSV table whose header carries the units, such as `compression travel [mm]`.

    Lines that begin with # are comments. ModelError names file, line, column and rule.
    """
    parts = []
    try:
        header = read_header(path, kind="table of isolators", example='"part, loops [-], height [mm]"')
        factors = {name: header.factor(i, _UNITS) for i, name in enumerate(header.names) if name != "part"}
        for _, location, cells in rows_below(header):
            row = dict(zip(header.names, cells, strict=True))
            values = {name: _stated(location, name, row[name], factor) for name, factor in factors.items()}
            loops, stated = values["loops"], [item.name for item in fields(ModeValues)]
            modes = {mode: ModeValues(**{name: values.get(f"{mode} {name}") for name in stated}) for mode in MODES}
            measures = {name: values.get(name) for name in ("rope", "height", "width", "bar")}
            count = None if loops is None else round(loops)
            parts.append(VendorPart(name=row["part"], series=series, loops=count, modes=modes, **measures))
    except RecordError as error:
        raise ModelError(str(error)) from None
    return parts


def _stated(location: str, name: str, cell: str, factor: float) -> float | None:
    """Return a cell in SI; an empty one is not stated."""
    if not cell:
        return None
    value = number_in(location, name, cell)
    if value <= 0.0:
        raise RecordError(f'{location}: "{cell}" in column "{name}" must be > 0, or empty if it is not stated.')
    return in_si(value, factor)


def load_isolator(path: str | Path | VendorPart, *, beside: str | Path | None = None) -> Isolator:
    """Load the isolator in a file, or by name: of the catalogue ("enidine_wr16_400") or of a vendor's table ("CB1500-30").

    Args:
        path: of the file, or a name; a part of a vendor's table is its shipped file, or what was fitted to its row.
        beside: folder in which a name is looked for first, see `find_isolator`.

    Raises:
        ModelError: the file is missing, is not TOML, or breaks a rule, and the message names file, axis, key and rule; or the
            vendor states too little of the part.
        ConvergenceError: no law has all the values that the vendor states.
    """
    found = path
    if not isinstance(path, VendorPart) and (beside is not None or not (Path(path).suffix or exists(path))):
        found = find_isolator(path, beside)
    if isinstance(found, VendorPart):
        shipped = shipped_file(found)
        if shipped is None:
            return _fitted(found.name) if found in vendor_parts() else _fit(found)
        found = catalogue_folder() / f"{shipped}.toml"
    return _read(Path(found))


def _read(path: Path) -> Isolator:
    return Isolator.from_dict(read_toml(path, "isolator file"), where=path)


def find_isolator(name: str | Path, beside: str | Path | None = None) -> Path | VendorPart:
    """Find the isolator file called `name`, or the part of the vendors' tables.

    A file is looked up as it stands under the folder `beside` (that of the model file; the current folder by default), then
    by its last part in the catalogue that ships with the package. The ending `.toml` may be left out. ModelError: there is
    neither; names the nearest.
    """
    catalogue = catalogue_folder()
    wanted = Path(f"{name}" if f"{name}".endswith(".toml") else f"{name}.toml")
    candidates = [Path(beside or ".") / wanted, catalogue / wanted.name]
    for candidate in candidates:
        if isfile(candidate):
            return candidate
    parts = {part.name.lower(): part for part in vendor_parts()}
    if (part := parts.get(wanted.stem.lower())) is not None:
        shipped = shipped_file(part)
        return part if shipped is None else catalogue / f"{shipped}.toml"
    looked = " and ".join(dict.fromkeys(str(candidate) for candidate in candidates))
    files = sorted(path.stem for path in catalogue.glob("*.toml"))
    spelt = {entry.lower(): entry for entry in [*files, *(part.name for part in parts.values())]}
    near = ", ".join(spelt[match] for match in get_close_matches(wanted.stem.lower(), spelt, n=5, cutoff=0.5))
    raise ModelError(
        f"there is no isolator {short(str(name))!r}: looked for {looked}. The catalogue holds {', '.join(files) or 'nothing'}; "
        f"`wirerope isolators --all` lists the {len(parts)} parts of the vendors' tables as well."
        + (f" Nearest: {near}." if near else "")
    )


def catalogue(pattern: str = "*") -> dict[str, Isolator | str]:
    """Load the parts of the vendors' tables whose names match a pattern, or say why a part has no isolator.

    ValueError if no name matches.
    """
    found: dict[str, Isolator | str] = {}
    for part in vendor_parts():
        if fnmatchcase(part.name.lower(), pattern.lower()):
            try:
                found[part.name] = load_isolator(part)
            except WireRopeError as error:
                found[part.name] = str(error).removeprefix(f"{part.name}: ")
    if not found:
        text = f"no part of the vendors' tables is called {pattern!r}; `wirerope isolators --all` lists them."
        raise ValueError(text)
    return found


def shipped_file(part: VendorPart) -> str | None:
    """Name the isolator file of a part, as `socitec_cb1400_30`; None where none ships, as for fewer loops."""
    if part not in vendor_parts():
        return None
    ending = "_" + part.name.lower().replace("-", "_")
    return next((path.stem for path in catalogue_folder().glob("*.toml") if path.stem.endswith(ending)), None)


@cache
def _fitted(name: str) -> Isolator:
    """Read the fit of a part of the tables, or fit it, once: half a second that every mount of a model would take again."""
    fit = catalogue_folder() / "vendors" / "fitted" / f"{name}.toml"
    return _read(fit) if isfile(fit) else _fit(next(part for part in vendor_parts() if part.name == name))


def _fit(part: VendorPart) -> Isolator:
    from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_part  # fitting loads SciPy, which a file does not need

    return fit_part(part)
