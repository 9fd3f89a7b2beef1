"""What tables and job of a board say, as its forms show it."""

from collections.abc import Mapping, Sequence
from dataclasses import fields

from wirerope_mj.content.blocks import Document
from wirerope_mj.engine.system import System
from wirerope_mj.motions.registry import SPOKEN_MOTIONS
from wirerope_mj.runs.board.job_text import motions_of, parsed
from wirerope_mj.runs.board.parts import part_names
from wirerope_mj.runs.board.placing import TABLE_OF
from wirerope_mj.runs.board.table_text import TableText
from wirerope_mj.runs.board.what_if import Slider
from wirerope_mj.runs.scenario_file import subjects_of
from wirerope_mj.views.board.columns import Form, Sheet

# Keys of a job that are set as they are, with their labels and examples
_SETTINGS = {
    "name": ("Title", "Genset"), "deck": ("Flexible deck", "10 Hz 800 kg 4 %"), "temperature": ("Temperature", "-20 degC"),
}  # fmt: skip
_OTHERS = ("levels", "record")  # that move the base besides phrases


def form_of(
    tables: Mapping[str, TableText], job: str, system: System, sliders: Sequence[Slider], values: Mapping[str, float],
    doubts: Sequence[str],
) -> Form:  # fmt: skip
    """Compose the forms of tables and of the text of a job, with what is doubtful about it, and the sliders at their values."""
    content, prefixes = parsed(job).unwrap(), {kind: prefix for prefix, kind in TABLE_OF.items()}
    document = content.get("document", {})
    texts = [field.name for field in fields(Document) if isinstance(field.default, str)]
    return Form(
        sheets=[
            Sheet(
                kind=kind, prefix=prefixes[kind], rows=table.rows,
                units={column: table.unit(column) for column in table.header.names},
            )
            for kind, table in tables.items()
        ],
        missing=[kind for kind in ("stops", "points") if tables and kind not in tables],
        settings=[(key, str(content.get(key, "")), label, example) for key, (label, example) in _SETTINGS.items()],
        cases=[
            (str(case.get("name", "")), motions_of(case), ", ".join(f"{key} {case[key]}" for key in _OTHERS if key in case))
            for case in content.get("case", [])
        ],
        doubts={said: why for said, _, why in (doubt.replace('"', "").partition(": ") for doubt in doubts)},
        limits={key: str(value) for key, value in content.get("limits", {}).items()},
        document=[(key, str(document.get(key, "")), key.capitalize(), "") for key in texts],
        parts=part_names(), subjects=[f"{kind}/{name}" for kind, names in subjects_of(system).items() for name in names],
        motions={kind: form.example for kind, form in SPOKEN_MOTIONS.items()}, edited=bool(job), found="", loops="",
        sliders=[
            (each.key, each.label, each.note, each.minimum, each.maximum, value, each.text(value), value != each.nominal)
            for each in sliders for value in [values.get(each.key, each.nominal)]
        ],
    )  # fmt: skip
