"""Criteria of verdicts: a kind, an axis and a sense, and the text that outputs and files write."""

from typing import Any, Final

ACCELERATION: Final = "acceleration"
RATTLE_SPACE: Final = "rattle space"
TRAVEL: Final = "travel"
RMS: Final = "rms acceleration"
SIGMA: Final = "3-sigma acceleration"
LARGEST: Final = "largest acceleration"
STATIC_LOAD: Final = "static load in compression"


class Criterion(str):
    """Kind, axis and sense of a limit, as the text "acceleration along z" or "travel in compression", which it equals."""

    kind: str  # ACCELERATION, RATTLE_SPACE, TRAVEL, STATIC_LOAD, or the name of any other criterion
    axis: str  # "x", "y" or "z"; "" for the size of a vector, or none
    # "+" or "-" along an axis, a rating of `mounts.isolator.travel` for a travel, a history for a static load
    sense: str

    def __new__(cls, kind: str, *, axis: str = "", sense: str = "") -> "Criterion":
        """Compose the text: "acceleration along z", "rattle space along -x", "travel in roll", "static load .., relaxed"."""
        text = f"{kind} along {sense}{axis}" if axis else kind
        if sense and not axis:
            text += f"{' in ' if kind == TRAVEL else ', '}{sense}"
        criterion = super().__new__(cls, text)
        criterion.kind, criterion.axis, criterion.sense = kind, axis, sense
        return criterion

    def __reduce__(self) -> tuple[Any, ...]:
        return _criterion, (self.kind, self.axis, self.sense)


def _criterion(kind: str, axis: str, sense: str) -> Criterion:
    return Criterion(kind, axis=axis, sense=sense)


COMBINED: Final = Criterion("travel combined")
BOTTOMING: Final = Criterion("bottoming")
CONTACT: Final = Criterion("contact")
STOP: Final = Criterion("stop")
