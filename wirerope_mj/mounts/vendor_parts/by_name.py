"""Isolators by name: files, those of the catalogue, and parts of the vendors' tables, whose fits ship."""

from difflib import get_close_matches
from fnmatch import fnmatchcase
from functools import cache, lru_cache
from os.path import exists, isfile  # as those of `Path`, but a name that is too long is none
from pathlib import Path

from wirerope_mj.foundation.errors import ModelError, WireRopeError
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.regular_files import regular
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.foundation.toml_file import read_toml
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.vendor_parts.parts import VendorPart, vendor_parts


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
    file = path
    if not isinstance(path, VendorPart) and (beside is not None or not (Path(path).suffix or exists(path))):
        file = find_isolator(path, beside)
    if isinstance(file, VendorPart):
        shipped = shipped_file(file)
        if shipped is None:
            return _fitted_isolator(file.name) if file in vendor_parts() else _fit(file)
        file = catalogue_folder() / f"{shipped}.toml"
    return _read(Path(file))


def _read(path: Path) -> Isolator:
    try:
        content = regular(path).read_bytes()
    except OSError:
        content = b""  # reading it again says why
    return _isolator_in(path, content)


@lru_cache(maxsize=256)  # of a model whose mounts name the same files again and again
def _isolator_in(path: Path, content: bytes) -> Isolator:
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


def catalogue(pattern: str = "*", *, highest: float | None = None) -> dict[str, Isolator | str]:
    """Load the parts of the vendors' tables whose names match a pattern, or say why a part has no isolator.

    Parts above the height `highest` [m] have none. ValueError if no name matches.
    """
    isolators: dict[str, Isolator | str] = {}
    for part in vendor_parts():
        if fnmatchcase(part.name.lower(), pattern.lower()):
            if highest is not None and (part.height or 0.0) > highest:
                isolators[part.name] = f"it is higher than {1e3 * highest:g} mm"
                continue
            try:
                isolators[part.name] = load_isolator(part)
            except WireRopeError as error:
                isolators[part.name] = str(error).removeprefix(f"{part.name}: ")
    if not isolators:
        text = f"no part of the vendors' tables is called {pattern!r}; `wirerope isolators --all` lists them."
        raise ValueError(text)
    return isolators


def shipped_file(part: VendorPart) -> str | None:
    """Name the isolator file of a part, as `socitec_cb1400_30`; None where none ships, as for fewer loops."""
    if part not in vendor_parts():
        return None
    ending = "_" + part.name.lower().replace("-", "_")
    return next((path.stem for path in catalogue_folder().glob("*.toml") if path.stem.endswith(ending)), None)


@cache
def _fitted_isolator(name: str) -> Isolator:
    """Read the stored fit of a vendor's part, or fit it; cached, since a fit takes half a second."""
    fit = catalogue_folder() / "vendors" / "fitted" / f"{name}.toml"
    return _read(fit) if isfile(fit) else _fit(next(part for part in vendor_parts() if part.name == name))


def _fit(part: VendorPart) -> Isolator:
    from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_part  # fitting loads SciPy, which a file does not need

    return fit_part(part)
