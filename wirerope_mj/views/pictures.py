"""Charts and scenes as files: the drawings of a page below each other, as PNG, SVG or PDF.

Resvg draws the page's own SVG, so that a picture shows what the page shows; its letters are those of the package's fonts, and
those of this machine's fonts that these lack.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from textwrap import wrap

from wirerope_mj.content.blocks import SceneView
from wirerope_mj.content.panels import WIDTH, Chart
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.views.plots import scene_svg
from wirerope_mj.views.plots.letters import FAMILY, fonts_for, text_of
from wirerope_mj.views.plots.svg_chart import chart_svg, safe_text

_ZOOM = 1.6  # pixels to a unit of a drawing
_LINE, _TITLE, _NOTE = 18.0, 96, 125  # height of a line; letters of a line of a title, of a caption
_EDGE = 6.0  # left free below
_STYLE = ".halo,.name{paint-order:stroke;stroke:#fff;stroke-width:2px}"  # of names that stand on lines


def save_pictures(blocks: Sequence[Chart | SceneView], path: str | Path, *, title: str = "") -> None:
    """Write drawings below each other under a title, scenes with their captions, whole or not at all.

    The ending of `path` says as what: .png, .svg or .pdf. ValueError for another; WireRopeError if WeasyPrint, which writes
    PDF, is not installed.
    """
    picture, height = _picture(blocks, title)
    save_svg(picture, (WIDTH, height), Path(path))


def save_svg(picture: str, size: tuple[float, float], path: Path) -> None:
    """Write an <svg> element of some width and height as the path's ending says, whole or not at all; errors as above."""
    kind = path.suffix.lower()
    if kind not in (".png", ".svg", ".pdf"):
        raise ValueError(f"the picture {path} must end with .png, .svg or .pdf.")
    with atomic_file(path) as temporary:
        if kind == ".svg":
            temporary.write_text(picture, encoding="utf-8")
        elif kind == ".png":
            temporary.write_bytes(_png(picture))
        else:
            from wirerope_mj.views.report.pdf import write_pdf

            write_pdf(f"<style>@page{{size:{size[0]:g}px {size[1]:g}px;margin:0}}body{{margin:0}}</style>{picture}", temporary)


def _picture(blocks: Sequence[Chart | SceneView], title: str) -> tuple[str, float]:
    """Return all drawings as one, and its height."""
    lines = wrap(title, _TITLE)
    parts = [_text(0.5 * WIDTH, _LINE * (n + 1), one, 'font-size="14" font-weight="bold"') for n, one in enumerate(lines)]
    y = _LINE * len(lines) + _EDGE if lines else 0.0
    for block in blocks:
        if isinstance(block, SceneView):
            for line in wrap(block.caption, _NOTE):
                y += _LINE
                parts.append(_text(0.5 * WIDTH, y - 5.0, line, 'font-size="11"'))
        for drawing, x, top, below in _placed(block, y):
            parts.append(drawing.replace("<svg ", f'<svg x="{x:.1f}" y="{top:.1f}" ', 1))
            y = max(y, below)
    y += _EDGE
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {y:g}" width="{WIDTH:g}" height="{y:g}"'
    return f'{head} font-family="Helvetica, Arial, sans-serif"><style>{_STYLE}</style>{"".join(parts)}</svg>', y


def _placed(block: Chart | SceneView, top: float) -> Iterator[tuple[str, float, float, float]]:
    """Yield the drawings of a block with where they stand: left, top and bottom; narrow ones beside each other."""
    chart = isinstance(block, Chart)
    scale = 1.0 if chart else WIDTH / scene_svg.WIDTH
    left = below = 0.0
    for drawing in [chart_svg(block)] if isinstance(block, Chart) else scene_svg.scene_svgs(block):
        found = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawing)
        assert found is not None
        width, height = scale * float(found[1]), scale * float(found[2])
        if left + width > WIDTH + 1.0:
            left, top = 0.0, below
        below = max(below, top + height)
        yield drawing.replace("<svg ", f'<svg width="{width:.1f}" height="{height:.1f}" ', 1), left, top, below
        left += width


def _text(x: float, y: float, text: str, look: str) -> str:
    return f'<text x="{x:g}" y="{y:g}" text-anchor="middle" fill="#1c2430" {look}>{safe_text(text)}</text>'


def _png(picture: str) -> bytes:
    from resvg_py import svg_to_bytes

    return svg_to_bytes(
        svg_string=picture, background="#fff", zoom=_ZOOM, skip_system_fonts=True, font_files=fonts_for(text_of(picture)),
        font_family=FAMILY, sans_serif_family=FAMILY,
    )  # fmt: skip
