"""The contents of a board's forms, from its tables and its job."""

from collections.abc import Mapping
from dataclasses import fields

from wirerope_mj.content.blocks import Document
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.motions.registry import SPOKEN_MOTIONS
from wirerope_mj.runs.board.job_text import motions_of, parsed
from wirerope_mj.runs.board.loaded import Loaded
from wirerope_mj.runs.board.parts import part_names
from wirerope_mj.runs.board.placing import ADDED, PREFIX_OF
from wirerope_mj.runs.scenario_file import subjects_of

# Keys of a job that are set as they are, with their labels and examples
_SETTINGS = {
    "name": ("Title", "Genset"), "deck": ("Flexible deck", "10 Hz 800 kg 4 %"), "temperature": ("Temperature", "-20 degC"),
}  # fmt: skip
_OTHERS = ("levels", "record")  # that move the base besides phrases


def form_of(loaded: Loaded, found: Mapping[str, str]) -> Entries:
    """Compose the values that the template of the left column shows; `found` is HTML of parts that were looked for."""
    job, values = parsed(loaded.texts.get("job", "")).unwrap(), loaded.values
    document = job.get("document", {})
    texts = [field.name for field in fields(Document) if isinstance(field.default, str)]
    return {
        "sheets": [
            {
                "kind": kind, "prefix": PREFIX_OF[kind], "rows": table.rows,
                "units": {column: table.unit(column) for column in table.header.names},
            }
            for kind, table in loaded.tables.items()
        ],
        "missing": [kind for kind in ADDED if loaded.tables and kind not in loaded.tables],
        "settings": [(key, str(job.get(key, "")), label, example) for key, (label, example) in _SETTINGS.items()],
        "cases": [
            (str(case.get("name", "")), motions_of(case), ", ".join(f"{key} {case[key]}" for key in _OTHERS if key in case))
            for case in job.get("case", [])
        ],
        "doubts": {said: why for said, _, why in (doubt.replace('"', "").partition(": ") for doubt in loaded.doubts)},
        "limits": job.get("limits", {}),
        "document": [(key, str(document.get(key, "")), key.capitalize(), "") for key in texts],
        "parts": part_names(),
        "subjects": [f"{kind}/{name}" for kind, names in subjects_of(loaded.system).items() for name in names],
        "motions": {kind: form.example for kind, form in SPOKEN_MOTIONS.items()},
        "edited": bool(loaded.texts), **found,
        "sliders": [(each, values.get(each.key, each.nominal)) for each in loaded.sliders],
    }  # fmt: skip
