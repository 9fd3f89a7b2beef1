"""Letters that the viewer has: it ends where it is to write another one, wherever that stands in a recording."""

import re
from typing import Any

_UNKNOWN = re.compile(
    "[^\n\u0020-\u007e\u00a0-\u00ac\u00ae-\u0148\u014a-\u017f\u0386\u0388-\u038a\u038c\u038e-\u03a1\u03a3-\u03ce"
    "\u0401-\u040c\u040e-\u044f\u0451-\u045c\u045e\u045f\u2010\u2013\u2014\u2018-\u2022\u2026\u2030\u2032\u2033"
    "\u2070\u2074-\u207a\u2080-\u2089\u20ac\u2116\u2122\u2190-\u2193\u2202\u2206\u2211\u2212\u221a\u221e\u2248\u2260"
    "\u2264\u2265]"
)
"""What one of the two fonts of rerun 0.41 lacks, beyond Latin, Greek and Cyrillic."""


def known_letters(text: str) -> str:
    """Return text with letters that the viewer has: others as their numbers, as "U+5B89"."""
    return _UNKNOWN.sub(lambda match: f"U+{ord(match[0]):04X}", text)


class KnownLetters:
    """A recording stream whose texts hold only letters that the viewer has."""

    def __init__(self, rec: Any) -> None:
        self._rec = rec

    def __getattr__(self, name: str) -> Any:
        return getattr(self._rec, name)

    def send_recording_name(self, name: str) -> None:
        """Send the name of the recording."""
        self._rec.send_recording_name(known_letters(name))

    def log(self, path: str, *parts: Any, static: bool = False) -> None:
        """Log as the stream does."""
        batches = [_Shown(batch) for part in parts for batch in part.as_component_batches()]
        self._rec.log(path, batches, static=static)

    def send_columns(self, path: str, index: list[Any], columns: Any) -> None:
        """Send rows as the stream does."""
        self._rec.send_columns(path, index, [_Shown(column) for column in columns])


class _Shown:
    """A component's batch or column, as the stream takes it."""

    def __init__(self, batch: Any) -> None:
        self._batch = batch

    def component_descriptor(self) -> Any:
        return self._batch.component_descriptor()

    def as_arrow_array(self) -> Any:
        return _shown(self._batch.as_arrow_array())


def _shown(array: Any) -> Any:
    """Return an array of texts, or of lists of texts, with known letters; any other as it is."""
    import pyarrow as pa

    if pa.types.is_string(array.type):
        texts = array.to_pylist()
        known = [text if text is None else known_letters(text) for text in texts]
        return array if known == texts else pa.array(known, type=array.type)
    if pa.types.is_list(array.type) and pa.types.is_string(array.type.value_type):
        return pa.ListArray.from_arrays(array.offsets, _shown(array.values), type=array.type)
    return array
