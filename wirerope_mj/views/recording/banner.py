"""The banner of a recording: the answer on a tile in its colour, and beside it what it is about in a line or two."""

from collections.abc import Sequence

import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.views.colours import DARK, hexadecimal
from wirerope_mj.views.pictures import drawn_png
from wirerope_mj.views.plots.letters import FAMILY, fonts_for
from wirerope_mj.views.recording.paths import Stream, child, entity
from wirerope_mj.views.recording.views import Pane

PATH = entity("verdict")
_TONES = {"exceeded": DARK.exceeded, "within": DARK.within, "near": DARK.unjudged, "unjudged": DARK.unjudged}
_WIDTH, _HEIGHT = 600, 200  # pixels of the tile's picture, three times its size on a full-HD screen
_SHARES = [1, 11]  # widths of tile and text


def banner_view(tone: str, texts: Sequence[Pane]) -> Pane:
    """Lay out the banner: the tile with the answer, on the colour of its tone, beside the texts."""
    tile = rrb.Spatial2DView(
        origin=child(PATH, "tile"), name=" ", background=_TONES.get(tone, DARK.accent),
        visual_bounds=rrb.VisualBounds2D(x_range=[0.0, _WIDTH], y_range=[0.0, _HEIGHT]),
    )  # fmt: skip
    return rrb.Horizontal(tile, *texts, column_shares=_SHARES, name="banner")


def log_tile(rec: Stream, answer: str, tone: str) -> None:
    """Log an answer in large letters, such as "FAIL", on the colour of its tone; what follows " of " in small ones below."""
    said, _, part = answer.partition(" of ")
    size = min(110.0, 1.2 * _WIDTH / max(len(said), 1))
    lines = [(said, size, 0.5 * (_HEIGHT + 0.7 * size) - (30.0 if part else 0.0)), (f"of {part}" if part else "", 44.0, 180.0)]
    texts = "".join(
        f'<text x="{0.5 * _WIDTH}" y="{y:.0f}" font-size="{height:.0f}" font-weight="bold" text-anchor="middle">{text}</text>'
        for text, height, y in lines
    )
    picture = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{_HEIGHT}" font-family="{FAMILY}" '
        f'fill="{hexadecimal(DARK.ground)}">{texts}</svg>'
    )
    png = drawn_png(picture, fonts_for(answer), hexadecimal(_TONES.get(tone, DARK.accent)))
    rec.log(child(PATH, "tile"), rr.EncodedImage(contents=png, media_type="image/png"), static=True)
