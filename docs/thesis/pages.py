"""Pages from templates: every number of a page is one of numbers.json, which the chapters compute."""

import json
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType

from docs.thesis import FOLDER

CHAPTERS = ("chapter_2", "chapter_4", "chapter_5", "chapter_6", "chapter_7", "questions")
NUMBERS = FOLDER / "numbers.json"


def chapter(name: str) -> ModuleType:
    """Return the module of a chapter: `numbers()` computes, `pictures()` draws by name."""
    return import_module(f"docs.thesis.{name}")


def stored() -> dict[str, dict[str, float]]:
    """Return the numbers of all chapters as they were computed last."""
    numbers: dict[str, dict[str, float]] = json.loads(NUMBERS.read_text(encoding="utf-8"))
    return numbers


def written(name: str, numbers: Mapping[str, float]) -> str:
    """Return the page of a chapter with its numbers in place; a true minus sign stands before negative ones."""
    template = (FOLDER / "templates" / f"{name}.md").read_text(encoding="utf-8")
    return template.format_map({key: _Number(value) for key, value in numbers.items()})


class _Number(float):
    def __format__(self, form: str) -> str:
        return super().__format__(form).replace("-", "−")


def page(name: str) -> Path:
    """Return where a page is written."""
    return FOLDER / f"{name}.md"
