"""What a figure of the gallery is."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from matplotlib.figure import Figure as Picture

SHOCK = "S"
"""Chapter of the figures that are not in the thesis; they come last."""


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One figure: its picture, its caption, and the numbers that both show.

    Attributes:
        number: of the figure in the thesis, such as "3.1", or "S.1" and on.
        title: what is drawn.
        section: of the thesis that makes the statement, or "shock".
        statement: what the thesis says there, in our words; else what is asked.
        shown: what the picture shows of it, with numbers.
        parameters: what was drawn, and where its values come from.
        numbers: the computed values behind `shown`, by name; the tests hold them against closed forms.
        draw: makes the picture.
    """

    number: str
    title: str
    section: str
    statement: str
    shown: str
    parameters: str
    numbers: Mapping[str, float]
    draw: Callable[[], Picture]

    @property
    def place(self) -> tuple[float, int]:
        """Chapter and number, for sorting: 3.10 comes after 3.9."""
        chapter, number = self.number.split(".")
        return (math.inf if chapter == SHOCK else int(chapter)), int(number)

    @property
    def file(self) -> str:
        """Name of the picture's file."""
        chapter, number = self.number.split(".")
        return f"figure_{chapter}_{int(number):02d}.png"


def written(value: float, form: str = "g") -> str:
    """Return a number as it stands in a sentence, with a true minus sign."""
    return format(value, form).replace("-", "−")
