"""Charts as SVG inside a page: texts can be selected, colours follow the page's theme, and curves can be read off.

No library draws them: matplotlib draws letters as outlines and takes half a second for each chart, and libraries for browsers
are scripts of megabytes, which a PDF does not run.
"""

from collections.abc import Sequence
from html import escape
from math import isfinite, log10

import numpy as np

from wirerope_mj.content.blocks import BASE, LEFT, LIMIT, OTHERS, RIGHT, WIDTH, Chart, Curve, Field, Panel
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import plain_lines
from wirerope_mj.foundation.ticks import linear_ticks, log_lines, log_ticks
from wirerope_mj.views.colours import LIGHT, class_of, field_colours, field_key, hexadecimal
from wirerope_mj.views.thin import envelope, is_dense, rows_of_line

_GAP = 66.0  # between two panels
_TITLE, _LEGEND, _BELOW, _BETWEEN = 18.0, 17.0, 34.0, 14.0  # heights of titles, lines of the legend, axis texts, gaps
_INK, _FRAME, _GRID = (hexadecimal(colour) for colour in (LIGHT.text, LIGHT.frame, LIGHT.line))
_FILLED = "filled: lowest to highest"  # said beside a title that leaves room for it
_LETTER = 6.1  # width of a letter of a legend, on the average
_SWATCH = 24.0
_MARK = 3.6  # diameter of a dot
_DOT = "h.01"  # a path without any length is not drawn in files
_MANY = 2000  # dots above which dots that cover each other are drawn once
_SWATCH_BAR = 9.0  # height of a bar or a colour in the legend
_FINE = 1 / 500  # tolerance of a line, as a fraction of a panel's height
_CLOSE = 0.1  # tolerance of a line on logarithmic axes, to which positions are rounded
_DECADE = 60.0  # length of a decade above which there are lines at 2, 3, .. 9
_ROOM = 0.05  # fraction of the range, left free above and below


def chart_svg(chart: Chart, whole: float = WIDTH) -> str:
    """Draw a chart as an <svg> element, `whole` units wide, each curve named once above it."""
    legend, top = _legend([panel for row in chart.rows for panel in row], whole)
    names = [text for row in chart.rows for _, text in row[0].yticks]  # of bars, on the left of the panels
    parts, y, room = [legend], top, max(LEFT, _LETTER * max(map(len, names), default=0) + 28.0)
    for number, row in enumerate(chart.rows):
        y += _TITLE if any(panel.title for panel in row) else 0.0
        width = (whole - room - RIGHT - _GAP * (len(row) - 1)) / len(row)
        labelled = any(panel.xlabel for panel in row)
        for column, panel in enumerate(row):
            left = room + column * (width + _GAP)
            away = 46.0 if column else room - 12.0  # of the label from the axis
            parts.append(_panel(panel, left, y, width, chart.height, away, labelled=labelled))
        y += chart.height + (_BELOW if labelled else 0.0) + (_BETWEEN if number + 1 < len(chart.rows) else 0.0)
    head = f'<svg class="chart" viewBox="0 0 {whole:g} {y:g}" xmlns="http://www.w3.org/2000/svg" role="img"'
    if chart.alt:
        head += f' aria-label="{safe_text(chart.alt)}"'
    return f'{head} font-family="Helvetica, Arial, sans-serif" font-size="11">{"".join(parts)}</svg>'


def _legend(panels: Sequence[Panel], whole: float) -> tuple[str, float]:
    """Draw the legend of all panels, each name once; return it and its height."""
    entries: dict[str, tuple[str, str]] = {}
    for panel in panels:
        for curve in panel.curves:
            width = _SWATCH_BAR if curve.bars else 0.0
            entries.setdefault(curve.name, (_look(curve, width), f"m9 0{_DOT}" if curve.marks else "h18"))
        for name, _ in (*panel.limits, *panel.xlimits):
            entries.setdefault(name, (_limit(panel, name), "h18"))
        for colour, name in field_key(panel.field) if panel.field else ():
            entries.setdefault(name, (f'stroke="{colour}" stroke-width="{_SWATCH_BAR:g}"', "h18"))
    entries.pop("", None)
    parts, x, y = [], LEFT, 12.0
    for name, (look, stroke) in entries.items():
        wide = _SWATCH + _LETTER * len(name) + 18.0
        if x + wide > whole and x > LEFT:
            x, y = LEFT, y + _LEGEND
        parts.append(f'<path {look} d="M{x:.1f} {y - 4:.1f}{stroke}"/>{_text(x + _SWATCH, y, name)}')
        x += wide
    return "".join(parts), (y + 8.0 if entries else 4.0)


def _panel(panel: Panel, left: float, top: float, width: float, height: float, away: float, *, labelled: bool) -> str:
    """Draw a panel with bands, grid, curves, limits and notes; `away` is the distance of the axis label."""
    (x0, x1), (y0, y1) = _ranges(panel)
    logs = "x" in panel.log, "y" in panel.log
    across = _Scale(x0, x1, left, left + width, logs[0])
    upward = _Scale(y0, y1, top + height, top, logs[1])
    parts = []
    for number, (name, low, high) in enumerate(panel.bands):  # names stand below those of the bands that they overlap
        start, end = across(max(low, x0)), across(min(high, x1))
        if start <= end:
            over = sum(before[1] <= high and low <= before[2] for before in panel.bands[:number])
            rect = f'x="{start:.1f}" y="{top:.1f}" width="{max(end - start, 1.0):.1f}" height="{height:.1f}"'
            parts.append(f'<rect fill="{_FRAME}" fill-opacity="0.18" {rect}/>')
            parts.append(_text(0.5 * (start + end), top + 12.0 * (1 + over), name, anchor="middle"))
    parts.append(_grid(across, upward, panel, labelled=labelled))
    drawn, filled = [], ""
    if panel.field:
        parts.insert(0, _cells(panel.field, across, upward))
    for curve in panel.curves:
        if curve.bars:
            drawn.append(_bars(curve, across, upward))
            continue
        paths = _paths(curve, across, upward)
        drawn += [f'<path {_look(curve)} data-name="{safe_text(curve.name)}" d="{d}"/>' for d in paths]
        if len(paths) > 1:
            numbers = paths[1][1:].split(" ")
            back = " ".join(f"{a} {b}" for a, b in zip(numbers[-2::-2], numbers[::-2], strict=True))
            drawn.append(f'<path fill="{hexadecimal(LIGHT.of(curve.kind))}" fill-opacity="0.3" d="{paths[0]}L{back}Z"/>')
            if _LETTER * (len(panel.title) + len(_FILLED)) < width:
                filled = _text(left + width, top - 3.0, _FILLED, anchor="end")
    parts += reversed(drawn)  # the first in front
    parts.append(filled)
    for name, level in panel.limits:
        if y0 <= level <= y1:
            at = f"M{left:.1f} {upward(level):.1f}h{width:.1f}"
            parts.append(f'<path {_limit(panel, name)} data-name="{safe_text(name)}" d="{at}"/>')
    for name, level in panel.xlimits:
        if x0 <= level <= x1:
            at = f"M{across(level):.1f} {top:.1f}v{height:.1f}"
            parts.append(f'<path {_limit(panel, name)} data-name="{safe_text(name)}" d="{at}"/>')
    parts += [f'<circle class="dot" fill="{_INK}" cx="{across(x):.1f}" cy="{upward(y):.1f}" r="3"/>' for x, y in panel.dots]
    for x, y, note, on_left in panel.notes:
        aside = -6.0 if on_left else 6.0
        parts.append(_text(across(x) + aside, upward(y) + 4.0, note, anchor="end" if on_left else "start", halo=True))
    if panel.title:
        parts.append(_text(left, top - 5.0, panel.title, weight="bold"))
    middle = top + 0.5 * height
    parts.append(_text(left - away, middle, panel.ylabel, anchor="middle", turned=True))
    if panel.xlabel:
        parts.append(_text(left + 0.5 * width, top + height + 29.0, panel.xlabel, anchor="middle"))
    ranges = " ".join(f"{value:.9g}" for value in (x0, x1, y0, y1))
    area = f"{left:.1f} {top:.1f} {width:.1f} {height:.1f}"
    data = f'data-ranges="{ranges}" data-area="{area}" data-log="{panel.log}"'
    data += f' data-unit="{panel.unit}" data-xunit="{panel.xunit}"'
    return f'<g class="panel" {data}>{"".join(parts)}</g>'


class _Scale:
    """Maps values to positions along a linear or logarithmic axis."""

    def __init__(self, low: float, high: float, first: float, last: float, log: bool) -> None:
        self.low, self.high, self.log = low, high, log
        self._from = log10(low) if log else low
        self._scale = (last - first) / ((log10(high) if log else high) - self._from)
        self._first = first

    def __call__(self, value: float) -> float:
        """Map a value to its position."""
        return self._first + ((log10(value) if self.log else value) - self._from) * self._scale

    def of(self, values: Array) -> Array:
        bounded = np.log10(np.maximum(values, self.low)) if self.log else values
        return np.asarray(self._first + (bounded - self._from) * self._scale)


def _ranges(panel: Panel) -> tuple[tuple[float, float], tuple[float, float]]:
    """Find the ranges of both axes, by the panel, or by its curves and the limits that they come near."""
    every = [*(curve.x for curve in panel.curves), *([panel.field.x] if panel.field else [])]
    xs = panel.xlim or (min(float(x.min()) for x in every), max(float(x.max()) for x in every))
    if xs[0] == xs[1]:
        xs = (xs[0], xs[0] + 1.0)
    if panel.ylim is not None:
        return xs, panel.ylim
    shown = [c.y[(c.x >= xs[0]) & (c.x <= xs[1])] for c in panel.curves]
    low = min((float(y.min()) for y in shown if y.size), default=0.0)
    high = max((float(y.max()) for y in shown if y.size), default=1.0)
    for _, level in panel.limits:
        # Others would only flatten the curves.
        if level < 0.0 and low < 0.5 * level or level > 0.0 and high > 0.5 * level:
            low, high = min(low, level), max(high, level)
    room = _ROOM * (high - low) or 1.0
    return xs, (low - room, high + room)


def _grid(across: _Scale, upward: _Scale, panel: Panel, *, labelled: bool) -> str:
    """Draw grid lines, frame and numbers of both axes, those of the horizontal one if `labelled`."""
    left, right = across(across.low), across(across.high)
    bottom, top = upward(upward.low), upward(upward.high)
    xs = panel.xticks or _ticks(across, most=max(3, int((right - left) / (42.0 if across.log else 62.0))))
    ys = panel.yticks or _ticks(upward, most=max(3, int((bottom - top) / (16.0 if upward.log else 26.0))))
    frame = left, right, bottom, top
    lines = _lines(frame, [across(x) for x, _ in xs], [upward(y) for y, _ in ys])
    fine = _lines(frame, _fine_lines(across), _fine_lines(upward))
    texts = [_text(left - 6.0, upward(y) + 4.0, text, anchor="end") for y, text in ys]
    if labelled:
        texts += [_text(across(x), bottom + 14.0, text, anchor="middle") for x, text in xs]
    edge = f'<path class="frame" fill="none" stroke="{_FRAME}" d="M{left:.1f} {top:.1f}H{right:.1f}V{bottom:.1f}H{left:.1f}Z"/>'
    grid = f'<path class="grid" fill="none" stroke="{_GRID}" d="{lines}"/>'
    grid += f'<path class="grid" fill="none" stroke="{_GRID}" stroke-opacity="0.5" d="{fine}"/>' if fine else ""
    return f"{grid}{edge}{''.join(texts)}"


def _lines(frame: tuple[float, float, float, float], xs: Sequence[float], ys: Sequence[float]) -> str:
    left, right, bottom, top = frame
    return "".join([*(f"M{x:.1f} {bottom:.1f}V{top:.1f}" for x in xs), *(f"M{left:.1f} {y:.1f}H{right:.1f}" for y in ys)])


def _fine_lines(scale: _Scale) -> list[float]:
    """Find the positions of lines at 2, 3, .. 9 of every decade; none on linear axes and short decades."""
    decade = abs(scale(scale.high) - scale(scale.low)) / log10(scale.high / scale.low) if scale.log else 0.0
    return scale.of(log_lines(scale.low, scale.high)).tolist() if decade > _DECADE else []


def _cells(field: Field, across: _Scale, upward: _Scale) -> str:
    xs, ys, parts = across.of(field.x), upward.of(field.y), []
    for row, colours in enumerate(field_colours(field)):
        for column, colour in enumerate(colours):
            if colour:
                size = f'width="{xs[column + 1] - xs[column] + 0.3:.1f}" height="{ys[row] - ys[row + 1] + 0.3:.1f}"'
                parts.append(f'<rect x="{xs[column]:.1f}" y="{ys[row + 1]:.1f}" {size} fill="{colour}"/>')
    return "".join(parts)


def _bars(curve: Curve, across: _Scale, upward: _Scale) -> str:
    """Draw a curve's bars from zero, with the intervals across their ends, if any."""
    zero, ys = across(max(across.low, 0.0)), upward.of(curve.y)
    d = "".join(f"M{zero:.1f} {y:.1f}H{x:.1f}" for x, y in zip(across.of(curve.x), ys, strict=True))
    bars = f'<path {_look(curve, abs(upward(curve.bars) - upward(0.0)))} d="{d}"/>'
    if curve.ends is None:
        return bars
    spans = zip(across.of(curve.ends), ys, strict=True)
    d = "".join(f"M{a:.1f} {y - 3:.1f}v6m0-3H{b:.1f}m0-3v6" for (a, b), y in spans)
    return f'{bars}<path class="frame" fill="none" stroke="{_FRAME}" d="{d}"/>'


def _ticks(scale: _Scale, *, most: int) -> list[tuple[float, str]]:
    ticks = log_ticks(scale.low, scale.high, most=most) if scale.log else linear_ticks(scale.low, scale.high, most=most)
    return [(float(tick), number_text(tick)) for tick in ticks if scale.low <= tick <= scale.high]


def _paths(curve: Curve, across: _Scale, upward: _Scale) -> list[str]:
    """Draw a curve as a path, or as both ends of the band that it fills where it oscillates too often."""
    keep = (curve.x >= across.low) & (curve.x <= across.high) if (np.diff(curve.x) >= 0.0).all() else slice(None)
    x, y = curve.x[keep], curve.y[keep]
    if curve.marks:
        inside = (y >= min(upward.low, upward.high)) & (y <= max(upward.low, upward.high))
        x, y = x[inside], y[inside]
        places = np.unique(np.round(_points(across.of(x), upward.of(y)), 0 if x.size > _MANY else 1), axis=0).tolist()
        return ["".join(f"M{a:g} {b:g}{_DOT}" for a, b in places)]
    tolerance = _FINE * abs(upward.high - upward.low)
    if upward.log or across.log:
        both = np.column_stack([across.of(x), upward.of(y)])
        rows = rows_of_line(np.arange(x.size, dtype=np.float64), both, _CLOSE)
    elif (np.diff(x) > 0.0).all():
        if is_dense(x, y[:, None], tolerance):
            at, low, high = envelope(x, y[:, None])
            return [_path(across.of(at), upward.of(values[:, 0])) for values in (high, low)]
        rows = rows_of_line(x, y[:, None], tolerance)
    else:  # a loop, whose corners would show at `_FINE`
        both = np.column_stack([x, y])
        rows = rows_of_line(np.arange(x.size, dtype=np.float64), both, 0.25 * _FINE * np.ptp(both, axis=0))
    return [_path(across.of(x[rows]), upward.of(y[rows]))]


def _path(x: Array, y: Array) -> str:
    return "M" + " ".join(f"{a:g} {b:g}" for a, b in _points(x, y))


def _points(x: Array, y: Array) -> list[list[float]]:
    return (np.round(np.column_stack([x, y]), 1) + 0.0).tolist()


_DASHES = {"dashed": "6 3", "dotted": "1.5 2.5"}


def _limit(panel: Panel, name: str) -> str:
    kind = panel.kind_of_limit(name)
    return f'class="{kind}" fill="none" stroke="{hexadecimal(LIGHT.of(kind))}" stroke-width="1.1" stroke-dasharray="5 4"'


def _look(curve: Curve, bar: float = 0.0) -> str:
    """Write class, colour, width and dashes of a curve as attributes."""
    kind, color = curve.kind, hexadecimal(LIGHT.of(curve.kind))
    width = round(bar, 1) or curve.weight * (_MARK if curve.marks else 1.0 if kind in (BASE, OTHERS, LIMIT) else 1.5)
    cap = ' stroke-linecap="round"' if curve.marks else ""  # a dot is a line of zero length with round ends
    faint = f' stroke-opacity="{curve.opacity:.2g}"' if curve.opacity < 1.0 else ""
    dash = f' stroke-dasharray="{_DASHES[curve.dash]}"' if curve.dash else ""
    return f'class="{class_of(kind)}" fill="none" stroke="{color}" stroke-width="{width:g}"{cap}{dash}{faint}'


def _text(
    x: float, y: float, text: str, *, anchor: str = "start", weight: str = "", turned: bool = False, halo: bool = False
) -> str:
    turn = f' transform="rotate(-90 {x:.1f} {y:.1f})"' if turned else ""
    bold = f' font-weight="{weight}"' if weight else ""
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"'
    kind = "text halo" if halo else "text"  # a page's style lets it stand on lines
    return f'<text class="{kind}" fill="{_INK}" {place}{bold}{turn}>{escape(plain_lines(text))}</text>'


def safe_text(text: str) -> str:
    return escape(plain_lines(text), quote=True)


def number_text(value: float) -> str:
    assert isfinite(value)
    return f"{value + 0.0:.6g}".replace("-", "\N{MINUS SIGN}")
