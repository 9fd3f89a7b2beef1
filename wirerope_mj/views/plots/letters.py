"""Fonts of pictures: the package's own, fonts of this machine for other letters, and warnings of missing letters."""

import os
import re
import sys
import warnings
from collections.abc import Collection
from functools import cache
from html import unescape
from pathlib import Path

from wirerope_mj.foundation.errors import FontWarning
from wirerope_mj.foundation.plain_text import short

FAMILY = "DejaVu Sans"
# What the package's fonts have for certain: with nothing else in a text no font need be opened.
_COMMON = re.compile("[\\s\u0020-\u007e\u00a0-\u017f\u0370-\u0377\u037a-\u037e\u0384-\u038a\u038c\u038e-\u03a1\u03a3-\u04ff"
                     "\u2010-\u2027\u2030-\u205e\u2070\u2071\u2074-\u208e\u2190-\u22ff]*")  # fmt: skip
_FONTS = {".ttf", ".otf", ".ttc", ".otc"}
_MOST_QUOTED = 5  # names that a message quotes


BROUGHT = tuple(str(Path(__file__).parent / "fonts" / name) for name in ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf"))
"""The files of the package's own fonts, which look alike on every machine."""


def fonts_for(text: str) -> list[str]:
    """Find fonts that have the letters of a text, the package's own first; warn of letters that no font has."""
    files = list(BROUGHT)
    if _COMMON.fullmatch(text):
        return files
    missing = {letter for letter in text if letter.isprintable() and not letter.isspace()} - _letters_in(files[0])
    # A plain face before bold and slanted ones, which one font has of the same letters.
    for path in sorted(_system_fonts(), key=lambda path: ("Regular" not in path, "Sans" not in path, path)) if missing else ():
        if found := missing & _letters_in(path):
            files.append(path)
            missing -= found
        if not missing:
            break
    warn_of_letters(text, missing)
    return files


@cache
def _letters_in(path: str) -> frozenset[str]:
    """Read the letters of a font file; empty if it cannot be read."""
    from fontTools.ttLib import TTFont, TTLibError

    try:
        with TTFont(path, fontNumber=0, lazy=True) as font:
            return frozenset(map(chr, font.getBestCmap() or ()))
    except (OSError, TTLibError, AssertionError, KeyError):  # no readable font
        return frozenset()


def _system_fonts() -> list[str]:
    """Find the font files in the folders of this machine's system."""
    home, windows = Path.home(), os.environ.get("WINDIR", "C:/Windows")
    by_platform: dict[str, list[str | Path]] = {
        "win32": [f"{windows}/Fonts", home / "AppData/Local/Microsoft/Windows/Fonts"],
        "darwin": ["/System/Library/Fonts", "/Library/Fonts", home / "Library/Fonts"],
    }
    of_linux: list[str | Path] = ["/usr/share/fonts", "/usr/local/share/fonts", home / ".local/share/fonts", home / ".fonts"]
    folders = by_platform.get(sys.platform, of_linux)
    return [str(path) for folder in folders for path in Path(folder).rglob("*") if path.suffix.lower() in _FONTS]


def text_of(markup: str) -> str:
    """Extract the texts that are read on a page or a drawing, one a line."""
    return unescape(re.sub(r"(?s)<(style|script)\b.*?</\1>|<[^>]*>", "\n", markup))


def warn_of_letters(text: str, missing: Collection[str]) -> None:
    """Warn of the names in a text with letters that no font has; names end where lines and cells do."""
    if not missing:
        return
    word = rf"\S*[{re.escape(''.join(sorted(missing)))}]\S*"
    names = list(dict.fromkeys(re.findall(rf"{word}(?: {word})*", text)))
    more = f" and {len(names) - _MOST_QUOTED} more" if len(names) > _MOST_QUOTED else ""
    quoted = ", ".join(f'"{short(name, 40)}"' for name in names[:_MOST_QUOTED])
    warnings.warn(
        f"no font of this machine has the letters of {quoted}{more}: boxes stand in their place. Install a font that has them "
        "(on Debian the package fonts-noto-cjk for Chinese, Japanese and Korean), and write this again.",
        FontWarning,
        stacklevel=3,
    )
