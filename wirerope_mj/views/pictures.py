"""Charts and scenes as files: the drawings of a page below each other, as PNG, SVG or PDF.

Resvg draws the page's own SVG, so that a picture shows what the page shows; its letters are those of the package's fonts, and
those of this machine's fonts that these lack.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap

from wirerope_mj.content.blocks import WIDTH, Chart, SceneView
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.views.colours import LIGHT, hexadecimal
from wirerope_mj.views.plots import scene_svg
from wirerope_mj.views.plots.letters import FAMILY, fonts_for, text_of
from wirerope_mj.views.plots.svg_chart import chart_svg, safe_text
from wirerope_mj.views.typesetting import typeset

_ZOOM = 1.6  # pixels to a unit of a drawing
_LINE, _TITLE, _NOTE = 18.0, 96, 125  # height of a line; letters of a line of a title, of a caption
_EDGE = 6.0  # margin below
_SHEET = f"""#set text(font: "{FAMILY}") // of drawings, too
#let sheet = json(bytes(sys.inputs.report))
#set page(width: sheet.width * 0.75pt, height: sheet.height * 0.75pt, margin: 0pt)
#set document(date: none)
#image(bytes(sheet.svg), format: "svg", width: 100%)"""
_GROUND, _INK = hexadecimal(LIGHT.ground), hexadecimal(LIGHT.text)
STYLE = f".halo,.name{{paint-order:stroke;stroke:{_GROUND};stroke-width:2px}}"  # of names that stand on lines


def save_pictures(blocks: Sequence[Chart | SceneView], path: str | Path, *, title: str = "") -> None:
    """Write drawings below each other under a title, scenes with their captions, whole or not at all.

    The suffix of `path` is the format: .png, .svg or .pdf. ValueError for others; WireRopeError if Typst, which writes PDF,
    is not installed.
    """
    picture, height = joined_svg(blocks, title)
    save_svg(picture, (WIDTH, height), Path(path))


def save_svg(picture: str, size: tuple[float, float], path: Path) -> None:
    """Write an <svg> element of a size in the format of the path's suffix, whole or not at all; errors of `save_pictures`."""
    kind = path.suffix.lower()
    if kind not in (".png", ".svg", ".pdf"):
        raise ValueError(f"the picture {path} must end with .png, .svg or .pdf.")
    with atomic_file(path) as temporary:
        if kind == ".svg":
            temporary.write_text(picture, encoding="utf-8")
        elif kind == ".png":
            temporary.write_bytes(drawn_png(picture, fonts_for(text_of(picture)), _GROUND, _ZOOM))
        else:
            typeset(_SHEET, {"svg": picture, "width": size[0], "height": size[1]}, temporary)


def drawn_png(picture: str, fonts: Sequence[str], background: str | None = None, zoom: float | None = None) -> bytes:
    """Draw an <svg> element with the letters of font files as PNG, without a background if none is given."""
    from resvg_py import svg_to_bytes

    return bytes(svg_to_bytes(
        svg_string=picture, background=background, zoom=zoom, skip_system_fonts=True, font_family=FAMILY,
        font_files=list(fonts), sans_serif_family=FAMILY,
    ))  # fmt: skip


def size_of(drawing: str) -> tuple[float, float]:
    """Read width and height of an <svg> element, in its units."""
    box = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawing)
    assert box is not None
    return float(box[1]), float(box[2])


def inset(drawing: str, box: Sequence[float]) -> str:
    """Place an <svg> element in a box of another: left, top, width, height."""
    x, y, width, height = box
    return drawing.replace("<svg ", f'<svg x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" ', 1)


def joined_svg(blocks: Sequence[Chart | SceneView], title: str = "") -> tuple[str, float]:
    """Join all drawings into an <svg> element, narrow ones beside each other; return it and its height."""
    lines = wrap(title, _TITLE)
    parts = [_text(_LINE * (n + 1), line, 'font-size="14" font-weight="bold"') for n, line in enumerate(lines)]
    y = _LINE * len(lines) + _EDGE if lines else 0.0
    for block in blocks:
        if isinstance(block, SceneView):
            for line in wrap(block.caption, _NOTE):
                y += _LINE
                parts.append(_text(y - 5.0, line, 'font-size="11"'))
            drawings, scale = scene_svg.scene_svgs(block), WIDTH / scene_svg.WIDTH
        else:
            drawings, scale = [chart_svg(block)], 1.0
        left, top = 0.0, y
        for drawing in drawings:
            width, height = (scale * side for side in size_of(drawing))
            if left + width > WIDTH + 1.0:
                left, top = 0.0, y
            y = max(y, top + height)
            parts.append(inset(drawing, (left, top, width, height)))
            left += width
    y += _EDGE
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {y:g}" width="{WIDTH:g}" height="{y:g}"'
    return f'{head} font-family="Helvetica, Arial, sans-serif"><style>{STYLE}</style>{"".join(parts)}</svg>', y


def _text(y: float, text: str, look: str) -> str:
    return f'<text x="{0.5 * WIDTH:g}" y="{y:g}" text-anchor="middle" fill="{_INK}" {look}>{safe_text(text)}</text>'
