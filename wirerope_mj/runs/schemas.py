"""JSON Schemas of the TOML files that people write, made of the classes that read them, for editors.

`python -m wirerope_mj.runs.schemas` writes those that ship, which a test holds against the classes.
"""

import json
from pathlib import Path

from wirerope_mj.assessment.durability.mission import Mission
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.schema import schema
from wirerope_mj.motions.registry import Levels
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.isolator.tables import law_schema
from wirerope_mj.mounts.laws import Law
from wirerope_mj.mounts.vendor_parts.curve_fit import CurveSheet
from wirerope_mj.mounts.vendor_parts.sheet import DataSheet
from wirerope_mj.mounts.vendor_parts.short_sheet import ShortSheet
from wirerope_mj.runs.job_file import JobFile
from wirerope_mj.runs.measured import ColumnMap
from wirerope_mj.runs.scenario_file import StoredScenario

SHIPPED = Path(__file__).parents[1] / "schemas"
# The classes of each kind of file: a data sheet is of one kind or the other.
FILES: dict[str, tuple[type, ...]] = {
    "isolator": (Isolator,), "datasheet": (DataSheet, CurveSheet, ShortSheet), "levels": (Levels,), "job": (JobFile,),
    "life": (Mission,), "map": (ColumnMap,), "scenario": (StoredScenario,),
}  # fmt: skip


def file_schema(kind: str) -> Entries:
    """Return the JSON Schema of a kind of file, a key of `FILES`."""
    schemas = [schema(file_class, {Law: {"$ref": "#/$defs/law"}}) for file_class in FILES[kind]]
    content: Entries = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    content |= schemas[0] if len(schemas) == 1 else {"anyOf": schemas}
    return content | ({"$defs": {"law": law_schema()}} if Isolator in FILES[kind] else {})


def write_schemas(folder: Path, *, force: bool = False) -> list[Path]:
    """Write the schemas of all kinds of files into a folder, each atomically, and return their paths.

    RecordError if one of the files is there, and `force` is not given.
    """
    paths = [folder / f"{kind}.json" for kind in FILES]
    for path in paths:
        if path.exists() and not force:
            raise RecordError(f"{path}: the file exists; --force replaces it.")
    folder.mkdir(parents=True, exist_ok=True)
    for path in paths:
        with atomic_file(path) as beside:
            beside.write_text(json.dumps(file_schema(path.stem), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return paths


if __name__ == "__main__":
    write_schemas(SHIPPED, force=True)
