"""Fonts of pictures: the letters that matplotlib brings, those of this machine that have others, and what no font has."""

import re
import warnings
from collections.abc import Collection
from functools import cache
from html import unescape
from importlib.util import find_spec
from pathlib import Path

from wirerope_mj.foundation.errors import FontWarning
from wirerope_mj.foundation.plain_text import short

FAMILY = "DejaVu Sans"
# What the fonts that matplotlib brings have for certain: with nothing else in a text no font need be opened.
_COMMON = re.compile("[\\s\u0020-\u007e\u00a0-\u017f\u0370-\u0377\u037a-\u037e\u0384-\u038a\u038c\u038e-\u03a1\u03a3-\u04ff"
                     "\u2010-\u2027\u2030-\u205e\u2070\u2071\u2074-\u208e\u2190-\u22ff]*")  # fmt: skip
_MOST = 5  # names that a message quotes


@cache
def brought_fonts() -> tuple[str, ...]:
    """Return the files of the letters that matplotlib brings, which look alike on every machine."""
    spec = find_spec("matplotlib")  # not imported, which takes longer than to draw
    assert spec is not None
    assert spec.origin is not None
    folder = Path(spec.origin).parent / "mpl-data" / "fonts" / "ttf"
    return tuple(str(folder / name) for name in ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf"))


def fonts_for(text: str) -> list[str]:
    """Return the files of fonts that have the letters of a text, those that matplotlib brings first; warn of other letters."""
    files = list(brought_fonts())
    if _COMMON.fullmatch(text):
        return files
    from matplotlib.font_manager import findSystemFonts
    from matplotlib.ft2font import FT2Font

    missing = {letter for letter in text if letter.isprintable() and not letter.isspace()}
    missing -= set(map(chr, FT2Font(files[0]).get_charmap()))
    # A plain face before bold and slanted ones, which one font has of the same letters.
    for path in (
        sorted(findSystemFonts(), key=lambda path: ("Regular" not in path, "Sans" not in path, path)) if missing else ()
    ):
        try:
            font = FT2Font(path)
        except (OSError, RuntimeError):  # not what its name says
            continue
        found = {letter for letter in missing if font.get_char_index(ord(letter))}
        if found:
            files.append(path)
            missing -= found
        if not missing:
            break
    warn_of_letters(text, missing)
    return files


def text_of(markup: str) -> str:
    """Return what is read of a page or a drawing, a line for each of its texts."""
    return unescape(re.sub(r"(?s)<(style|script)\b.*?</\1>|<[^>]*>", "\n", markup))


def warn_of_letters(text: str, missing: Collection[str]) -> None:
    """Warn of the names in a text with letters that no font has; names end where lines and cells do."""
    if not missing:
        return
    word = rf"\S*[{re.escape(''.join(sorted(missing)))}]\S*"
    names = list(dict.fromkeys(re.findall(rf"{word}(?: {word})*", text)))
    more = f" and {len(names) - _MOST} more" if len(names) > _MOST else ""
    quoted = ", ".join(f'"{short(name, 40)}"' for name in names[:_MOST])
    warnings.warn(
        f"no font of this machine has the letters of {quoted}{more}: boxes stand in their place. Install a font that has them "
        "(on Debian the package fonts-noto-cjk for Chinese, Japanese and Korean), and write this again.",
        FontWarning,
        stacklevel=3,
    )
