"""A film as a file: frames of the page's own drawings, which resvg draws, written by the ffmpeg of imageio-ffmpeg.

What stays in all frames is drawn once; what moves is drawn in boxes, half of the frames by a copy of this process.
"""

import errno
import io
import math
import re
import signal
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import wrap

import numpy as np

from wirerope_mj.content.blocks import Chart, Panel
from wirerope_mj.content.film import PAUSE, RATE, Film, FilmedRun
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.foundation.processes import process_beside, run_beside
from wirerope_mj.views.colours import LIGHT, Color, hexadecimal
from wirerope_mj.views.pictures import STYLE, drawn_png, inset, size_of
from wirerope_mj.views.plots.letters import fonts_for, text_of
from wirerope_mj.views.plots.scene_svg import stage_svgs
from wirerope_mj.views.plots.svg_chart import chart_svg, safe_text

SIZE = (1920, 1080)
_EDGE, _GAP = 28.0, 14.0  # around a run, between its parts
_LETTER = 0.6  # mean width of a letter over its height
_TITLE, _TEXT, _NOTE = 32.0, 22.0, 18.0  # heights of letters
_MOST_LINES = 4  # of a title, a verdict, a passage
_CAPTION = 66.0  # height of the caption below all
_SMALLER = 0.88  # letters and drawings of two runs, over those of one
_SCENES = 0.45  # fraction of the height that scenes have above the curves of two runs
_UNIT = 1.7  # pixels to a unit of scenes and charts
_GIF = "fps=12.5,scale=960:-1:flags=area,split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=none"
Box = tuple[float, float, float, float]  # Left, top, width, height
Part = tuple[Box, str]  # What is drawn in a box, in the coordinates of the frame


class _Stage:
    """A run in its part of the frame: drawings that are the same in all frames, and those that change."""

    def __init__(self, run: FilmedRun, left: float, width: float, size: float) -> None:
        self.run, self.left, self.width, self.size = run, left + _EDGE, width - 2.0 * _EDGE, size
        self.colour = {"exceeded": LIGHT.exceeded, "within": LIGHT.within}.get(run.verdict.tone, LIGHT.unjudged)
        self.top, self.still = _EDGE, list[str]()
        heads = (run.title, _TITLE, LIGHT.text), (run.verdict.text, _TEXT, self.colour), (run.passage, _NOTE, LIGHT.text)
        for text, height, colour in heads:
            for line in wrap(text, int(self.width / (_LETTER * size * height)), max_lines=_MOST_LINES, placeholder=" …"):
                self.top += 1.3 * size * height
                self.still.append(_text(self.left, self.top, line, size * height, colour=colour, bold=height > _NOTE))

    def place(self, top: float) -> None:
        """Place scenes and curves below `top` [pixels]: of one run beside each other, of two runs below each other."""
        self.line, bottom, unit = top + 1.3 * _TEXT, SIZE[1] - _CAPTION, self.size * _UNIT
        top, alone = self.line + _GAP, self.size == 1.0
        width, height = (0.5 * self.width, bottom - top) if alone else (self.width, _SCENES * (bottom - top))
        placed, self._scenes = stage_svgs(self.run.motion.drawn(), width / unit, height / unit)
        self._boxes: list[Box] = []
        for left, down, drawing in placed:
            wide, high = size_of(drawing)
            self._boxes.append((self.left + unit * left, top + unit * down, unit * wide, unit * high))
            self.still.append(inset(drawing, self._boxes[-1]))
        right = max(box[0] + box[2] for box in self._boxes) + _GAP
        self._panels: list[tuple[Panel, Box, list[float]]] = []  # with areas, and the ranges of both axes
        if not self.run.panels:
            return
        left, top = (right, top) if alone else (self.left, top + height)
        rows, wide, least = [[panel] for panel in self.run.panels], (self.left + self.width - left) / unit, 40.0
        room = (bottom - top) / unit - size_of(chart_svg(Chart(rows=rows, height=least), wide))[1]
        svg = chart_svg(Chart(rows=rows, height=least + max(room, 0.0) / len(rows)), wide)
        self.still.append(inset(svg, (left, top, *(unit * side for side in size_of(svg)))))
        found = re.findall(r'data-ranges="(.*?)" data-area="(.*?)"', svg)
        for panel, data in zip(self.run.panels, found, strict=True):
            ranges, (x, y, across, high) = ([float(part) for part in numbers.split()] for numbers in data)
            self._panels.append((panel, (left + unit * x, top + unit * y, unit * across, unit * high), ranges))

    def moving(self, instant: float) -> Iterator[Part]:
        """Yield what moves, as it is at an instant [s]: its text, the scenes, a cursor in each panel with dots and value."""
        colour = self.colour if self.run.reached(instant) else LIGHT.text
        text = self.run.instant_text(instant)
        height = min(self.size * _TEXT, self.width / (_LETTER * len(text)))
        line = _text(self.left, self.line, text, height, colour=colour, bold=True)
        yield (self.left, self.line - _TEXT, self.width, 1.4 * _TEXT), line
        for box, drawing in zip(self._boxes, self._scenes(self.run.view(instant)), strict=True):
            yield box, inset(drawing, box).replace("<svg ", '<svg overflow="visible" ', 1)  # resvg clips slowly
        for (panel, box, ranges), value in zip(self._panels, self.run.values(instant), strict=True):
            left, top, width, height = box
            x = left + width * (instant - ranges[0]) / (ranges[1] - ranges[0])
            parts = [f'<path stroke="{hexadecimal(LIGHT.text)}" stroke-width="2" d="M{x:.1f} {top:.1f}v{height:.1f}"/>']
            for curve in panel.curves:
                y = top + height * (ranges[3] - float(np.interp(instant, curve.x, curve.y))) / (ranges[3] - ranges[2])
                parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="{hexadecimal(LIGHT.of(curve.kind))}"/>')
            yield (x - 8.0, top - 8.0, 16.0, height + 16.0), "".join(parts)
            said = _text(left + width, top - 9.0, value, self.size * _NOTE, anchor="end")
            yield (left + 0.5 * width, top - 9.0 - _NOTE, 0.5 * width, 1.4 * _NOTE), said


class Frames:
    """The frames of a film as pictures: what stays in all of them, and what moves."""

    def __init__(self, film: Film) -> None:
        self._film, width, size = film, SIZE[0] / len(film.runs), 1.0 if len(film.runs) == 1 else _SMALLER
        self._stages = [_Stage(run, n * width, width, size) for n, run in enumerate(film.runs)]
        top = max(stage.top for stage in self._stages) + _GAP
        for stage in self._stages:
            stage.place(top)
        lines = wrap(film.caption, int((SIZE[0] - 2.0 * _EDGE) / (_LETTER * _NOTE)))
        caption = [_text(_EDGE, SIZE[1] - _CAPTION + 1.35 * _NOTE * (n + 1), line, _NOTE) for n, line in enumerate(lines)]
        self.still = "".join([*caption, *(part for stage in self._stages for part in stage.still)])
        last = "".join(part for _, part in self.moving(film.instants.size - 1))
        self._fonts = fonts_for(text_of(self.still + last))

    def moving(self, number: int) -> list[Part]:
        """Draw what moves, in boxes, as it is in a frame."""
        return [part for stage in self._stages for part in stage.moving(float(self._film.instants[number]))]

    def background(self) -> bytes:
        """Draw what is the same in all frames as PNG."""
        return self._png(self.still, (0, 0, *SIZE), hexadecimal(LIGHT.ground))

    def write(self, numbers: Sequence[int], folder: Path) -> None:
        """Write what moves in the frames `numbers` as PNG files, whose names say frame, order and position."""
        for number in numbers:
            for order, (box, part) in enumerate(self.moving(number)):
                left, top = int(box[0]), int(box[1])
                png = self._png(part, (left, top, int(box[2]) + 2, int(box[3]) + 2))
                (folder / f"{number}_{order}_{left}_{top}.png").write_bytes(png)

    def _png(self, part: str, box: Sequence[int], background: str | None = None) -> bytes:
        head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{" ".join(map(str, box))}" width="{box[2]}" height="{box[3]}"'
        return drawn_png(f"{head}><style>{STYLE}</style>{part}</svg>", self._fonts, background)


def write_film(film: Film, path: Path, gif: Path | None = None) -> None:
    """Write a film as MP4, and as a GIF of half its size.

    WireRopeError without imageio-ffmpeg and Pillow, or if ffmpeg fails; OSError if the disk is full.
    """
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
        from PIL import Image

        program = get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        raise WireRopeError("a film needs imageio-ffmpeg and Pillow: pip install 'wirerope-mj[film]'.") from None
    frames, numbers = Frames(film), range(film.instants.size)
    with TemporaryDirectory() as folder:
        with run_beside(lambda: frames.write(numbers[1::2], Path(folder))):
            frames.write(numbers[::2], Path(folder))
            still = Image.open(io.BytesIO(frames.background())).convert("RGBA")
        parts: dict[int, list[tuple[int, int, int, Path]]] = {number: [] for number in numbers}
        for file in Path(folder).iterdir():
            number, order, left, top = map(int, file.stem.split("_"))
            parts[number].append((order, left, top, file))

        def images() -> Iterator[bytes]:
            for number in numbers:
                picture = still.copy()
                for _, left, top, file in sorted(parts[number]):
                    picture.alpha_composite(Image.open(file).convert("RGBA"), (left, top))
                content = picture.convert("RGB").tobytes()
                for _ in range(1 + (PAUSE if number == film.worst else 0)):
                    yield content

        raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{SIZE[0]}x{SIZE[1]}", "-r", str(RATE), "-i", "-"]
        h264 = ["-c:v", "libx264", "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
        _run_ffmpeg([program, *raw, *h264, _file(path)], images())
        if gif is not None:
            _run_ffmpeg([program, "-i", _file(path), "-filter_complex", _GIF, _file(gif)], ())


def _run_ffmpeg(command: Sequence[str], images: Iterable[bytes]) -> None:
    """Run ffmpeg over a file that is there already, with images at its input; errors as of `write_film`."""
    program, *options = command
    pipe = subprocess.PIPE
    quiet = [program, "-y", "-nostdin", "-loglevel", "error", *options]
    with process_beside(quiet, stdin=pipe, stdout=subprocess.DEVNULL, stderr=pipe) as process:
        assert isinstance(process.stdin, io.TextIOWrapper)
        with suppress(BrokenPipeError):  # it has ended, and says why
            for image in images:
                process.stdin.buffer.write(image)
        _, message = process.communicate()
        code = process.returncode
    if "No space left" in message or code == -getattr(signal, "SIGXFSZ", math.inf):
        raise OSError(errno.ENOSPC, message)
    if code:
        raise WireRopeError(f"ffmpeg cannot write the film: {' '.join(message.split())}")


def _file(path: Path) -> str:
    return f"file:{path.absolute()}"  # else ffmpeg would take what stands before a colon for a protocol


def _text(
    x: float, y: float, text: str, height: float, *, anchor: str = "start", colour: Color = LIGHT.text, bold: bool = False
) -> str:
    weight = ' font-weight="bold"' if bold else ""
    place = f'x="{x:.1f}" y="{y:.1f}" font-size="{height:g}" text-anchor="{anchor}" fill="{hexadecimal(colour)}"'
    return f"<text {place}{weight}>{safe_text(text)}</text>"
