"""PDF files, set by Typst with the package's fonts: it needs no other program, and no library of the system."""

import json
import re
from pathlib import Path
from types import ModuleType

from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.views.plots.letters import fonts_for, text_of


def load_typst() -> ModuleType:
    """Import Typst; WireRopeError if it is not installed."""
    try:
        import typst
    except ImportError:
        text = "a PDF needs Typst: pip install 'wirerope-mj[pdf]'. Or print the HTML page from a browser."
        raise WireRopeError(text) from None
    return typst


def typeset(template: str | Path, data: object, path: Path) -> None:
    """Write data as a PDF file, the same bytes for the same data.

    `template` is a text of Typst, or a file of the user's, which has all fonts of the machine and the files beside it. It reads
    `json(bytes(sys.inputs.report))`, so that no text in it is markup; drawings stand under the key "svg". Warns of the names
    with letters that no font has. WireRopeError without Typst, or if it cannot set the template.
    """
    typst = load_typst()
    texts: list[str] = []
    inputs = {"report": json.dumps(_plain(data, texts))}
    folders = {str(Path(file).parent) for file in fonts_for("\n".join(texts))}
    others = isinstance(template, Path)
    fonts = typst.Fonts(include_system_fonts=others, include_embedded_fonts=others, font_paths=sorted(folders))
    source = template if isinstance(template, Path) else template.encode()
    try:
        pages = typst.compile(source, format="pdf", font_paths=fonts, sys_inputs=inputs)
    except typst.TypstError as error:
        place = re.search(r"\S+:\d+:\d+", error.diagnostic or "")
        where = f"{template} ({place[0]})" if place else template
        raise WireRopeError(f"{where}: Typst cannot set this, {' '.join([error.message, *error.hints])}.") from None
    path.write_bytes(pages)  # here: Typst has words of its own for a full disk


def _plain(data: object, texts: list[str], *, drawing: bool = False) -> object:
    """Spell out invisible characters in all texts of data, and collect what is read of them."""
    if isinstance(data, str):
        clean = plain_lines(data)
        texts.append(text_of(clean) if drawing else clean)
        return clean
    if isinstance(data, dict):
        return {name: _plain(part, texts, drawing=name == "svg") for name, part in data.items()}
    return [_plain(part, texts) for part in data] if isinstance(data, list | tuple) else data
