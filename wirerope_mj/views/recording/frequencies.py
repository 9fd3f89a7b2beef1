"""Recordings over frequency: a branch of periodic motions, and modes in motion."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.content.blocks import Chart, Content, Statement
from wirerope_mj.content.modes import amplitudes_table, mode_blocks, modes_table
from wirerope_mj.content.response_curve import motion_blocks
from wirerope_mj.content.selection import select
from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary, busiest_loops
from wirerope_mj.dynamics.modes.animation import ModeAnimation
from wirerope_mj.dynamics.modes.result import Modes
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.colours import CURSOR, DARK
from wirerope_mj.views.markdown import markdown_blocks, markdown_table
from wirerope_mj.views.recording.animation import Along, Animation, Strip, animation_of, at_points, strips_of, timelines
from wirerope_mj.views.recording.banner import PATH, banner_view, log_tile
from wirerope_mj.views.recording.camera import scene_extent
from wirerope_mj.views.recording.ghosts import enlarged, factor_of
from wirerope_mj.views.recording.loops import loop_points
from wirerope_mj.views.recording.panels import log_frequency_panel
from wirerope_mj.views.recording.paths import (
    AXES,
    POINT,
    PROPERTIES,
    TIMELINE,
    WORST_POINT,
    Stream,
    at,
    child,
    entity,
    known_letters,
    nanoseconds,
)
from wirerope_mj.views.recording.scene import log_scene
from wirerope_mj.views.recording.shapes import Frame, frames_of
from wirerope_mj.views.recording.viewer import atomic_recording, target_of
from wirerope_mj.views.recording.views import (
    GROUND,
    HEIGHT,
    LARGE,
    Color,
    Plot,
    fitting_width,
    log_frame,
    opening,
    whole_scene_view,
)

RESPONSE, MOTION, ABOUT = "response", "motion", "about"
PANE = (640.0, 500.0)  # Width and height [points] of the pane of loops on a full-HD screen
SQUARE = 92.0  # Width of the frames of shape and multipliers, whose panes are a little higher than wide
AWAY = 1.15  # distance of the camera over that for the modelled geometry: motions are drawn larger
PER_SECOND = 5.0  # Points that are played in a second
RESPONSE_WIDTH = 225.0  # Width of the frame of the response, so that it fills its pane
MOST_LOOPS = 4  # loops that are shown: those of the largest energy at the highest amplitude
SHAPE, PORTRAIT = "shape", "portrait"  # Entities of a loop and its phase portrait, whose own ranges fill the frame
_SHAPE_TICKS = np.array([-1.0, 0.0, 1.0])
MULTIPLIERS = "multipliers"
_LARGEST = 2.0  # modulus above which a multiplier is drawn at the edge of the frame, in its direction
_CIRCLE, _INSIDE, _OUTSIDE = DARK.base, DARK.within, DARK.unjudged
_TIMELINES = (
    "Timeline point: from motion to motion along the branches; frequency_mHz: the same by frequency, all levels at one "
    "frequency; sim_time: one repetition of each motion after the other."
)


def record_branches(result: FrequencyResponse, findings: list[LevelSummary], content: Content, path: str | Path) -> Path:
    """Write the branches of a frequency response as a recording, a file or `run.rrd` of a folder, and return its path.

    ValueError if no level has a branch; RecordError if the environment variable RERUN switches recordings off.
    """
    if not result.branches:
        raise ValueError("there is no branch to record; a sweep alone has no periodic motions.")
    target = target_of(path)
    strips = strips_of(findings)
    animation = animation_of(strips[-1])  # the highest level, which the scene shows
    factor = factor_of(animation.response, scene_extent(animation.response.scene)[1])
    scene = enlarged(animation.response, factor)
    selection, frames = select(animation.response), frames_of(scene)
    layout = _blueprint(scene, animation, frames, factor, content.verdict.tone)
    chart = next(block for block in content.blocks() if isinstance(block, Chart) and block.id == "amplitude")
    with atomic_recording(target) as rec:
        rec.send_blueprint(layout, make_active=True, make_default=True)  # before the data: right from the first moment
        rec.send_recording_name(content.title)
        highest = int(animation.strip.amplitude.argmax())
        rec.send_property(PROPERTIES, rr.AnyValues(**{WORST_POINT: highest}))
        ended = re.match("[A-Z]{3,}[A-Z ]*", content.verdict.text)  # early, or at the rated travel
        peak = "RESONANCE" if content.verdict.text.startswith("Resonance") else "NO PEAK"
        log_tile(rec, ended[0].strip() if ended else peak, content.verdict.tone)
        said = f"{markdown(content.title)}: **{markdown(content.verdict.text)}**"
        rec.log(PATH, rr.TextDocument(said, media_type=rr.MediaType.MARKDOWN), static=True)
        strip, kind = animation.strip, rr.MediaType.MARKDOWN
        loops = shown_loops(animation)
        texts = []
        ends = [*strip.points[1:].tolist(), strip.branch.frequency.size]
        for point, orbit, end in zip(strip.points.tolist(), strip.orbits, ends, strict=True):
            texts.append(markdown_blocks(motion_blocks((strip.branch, point, orbit), end, next(iter(loops), None))))
        columns = rr.TextDocument.columns(text=texts, media_type=[kind] * len(texts))
        rec.send_columns(entity(MOTION), at_points(animation, strip), columns)
        about = markdown_blocks([content.verdict, *content.blocks("headline", "summary"), Statement(text=_TIMELINES)])
        rec.log(entity(ABOUT), rr.TextDocument(about, media_type=kind), static=True)
        log_frequency_panel(rec, entity(RESPONSE), chart.rows[0][0], width=RESPONSE_WIDTH, lift=LARGE)
        log_here(rec, child(entity(RESPONSE), "data", "here"), animation, strips)
        log_multipliers(rec, animation, width=SQUARE)
        if loops:
            log_orbit_loops(rec, animation, strips, width=loop_grid(len(loops))[1], shape_width=SQUARE)
        log_scene(timelines(rec, animation), scene, selection, frames)
    return target


def loop_grid(loops: int) -> tuple[int, float]:
    """Find the columns of a grid of so many loops, and the width of their frames."""
    columns = 1 if loops == 1 else 2
    rows = -(-loops // columns)
    return columns, fitting_width(PANE, columns, rows)


def _blueprint(scene: Response, animation: Animation, frames: dict[str, Frame], factor: float, tone: str) -> rrb.Blueprint:
    """Lay out a recording of branches: banner, scene, texts, Floquet multipliers, response curve and loops."""
    texts = rrb.Tabs(
        rrb.TextDocumentView(origin=entity(MOTION), name="Motion"), rrb.TextDocumentView(origin=entity(ABOUT), name="Levels")
    )
    multipliers = _plot_view(entity(MULTIPLIERS), f"Floquet multipliers at {animation.strip.level:.4g} m/s²", SQUARE)
    larger = f", motion drawn {factor:g} times larger" if factor > 1.0 else ""
    name = f"{scene.scene.name} at {animation.strip.level:.4g} m/s², seen from the base{larger}"
    left = rrb.Vertical(
        whole_scene_view(scene, frames, name, away=AWAY),
        rrb.Horizontal(texts, multipliers, column_shares=[1, 1]),
        row_shares=[1, 1],
    )
    response = _plot_view(entity(RESPONSE), "Largest acceleration [m/s²] over frequency [Hz]", RESPONSE_WIDTH)
    right: rrb.Container = rrb.Vertical(response, row_shares=[1])
    if shown := shown_loops(animation):
        columns, width = loop_grid(len(shown))
        loops = [_plot_view(loop_path(mount, axis), f"{mount}, {AXES[axis]}: kN over mm", width) for mount, axis in shown]
        shape = _plot_view(entity(SHAPE), "Loop, own ranges", SQUARE)
        portrait = _plot_view(entity(PORTRAIT), "Phase portrait", SQUARE)
        grid = rrb.Grid(*loops, grid_columns=columns)
        below = rrb.Horizontal(grid, rrb.Tabs(shape, portrait), column_shares=[8, 5])
        right = rrb.Vertical(response, below, row_shares=[1, 1])
    # One period at the resonance takes a second.
    resonance = animation.strip.frequency[int(animation.strip.amplitude.argmax())]
    panel = rrb.TimePanel(
        state="collapsed", timeline=POINT, playback_speed=1.0 / float(resonance), fps=PER_SECOND * float(resonance),
        play_state="paused", loop_mode="all",
    )  # fmt: skip
    banner = banner_view(tone, [rrb.TextDocumentView(origin=PATH, name="Resonance")])
    content = rrb.Horizontal(left, right, column_shares=[5, 6])
    return opening(rrb.Vertical(banner, content, row_shares=[8, 92]), panel)


def _plot_view(origin: str, name: str, width: float) -> rrb.Spatial2DView:
    bounds = rrb.VisualBounds2D(x_range=[-16.0, width + 4.0], y_range=[-8.0, HEIGHT + 15.0])
    return rrb.Spatial2DView(origin=origin, name=known_letters(name), background=GROUND, visual_bounds=bounds)


def _level_color(level: int) -> Color:
    return DARK.of(level)


def log_here(rec: Stream, path: str, animation: Animation, strips: list[Strip]) -> None:
    """Log the current motion of every level as a point on its curve, with its values, and the names of the curves."""
    ends = np.array([[np.log10(strip.branch.frequency[0]), np.log10(strip.branch.amplitude[0])] for strip in strips])
    names, colors = [f"{strip.level:.4g} m/s²" for strip in strips], [_level_color(strip.number) for strip in strips]
    look = {"labels": names, "colors": colors, "radii": rr.Radius.ui_points(0.0), "show_labels": True}
    rec.log(child(path, "names"), rr.Points2D(ends + [0.06, 0.0], **look), static=True)
    for strip in strips:
        below, branch = child(path, f"level_{strip.number + 1}"), strip.branch
        size = rr.Radius.ui_points(7.0)
        look = rr.Points2D.from_fields(colors=_level_color(strip.number), radii=size, draw_order=60.0, show_labels=False)
        rec.log(below, look, static=True)
        labels = [
            f"{strip.level:.4g} m/s²: {branch.frequency[point]:.5g} Hz, {branch.amplitude[point]:.4g} m/s², "
            f"{'stable' if branch.stable[point] else 'unstable'}"
            for point in strip.points
        ]
        positions = np.column_stack([np.log10(strip.frequency), np.log10(strip.amplitude)])
        columns = rr.Points2D.columns(positions=positions, labels=labels)
        rec.send_columns(below, at_points(animation, strip), columns)


def shown_loops(animation: Animation) -> list[tuple[str, int]]:
    """Choose mount and axis of the loops that do most work at the highest amplitude, at most `MOST_LOOPS`."""
    highest = animation.strip.orbits[int(np.argmax(animation.strip.amplitude))]
    return busiest_loops(highest.response)[:MOST_LOOPS]


def loop_path(mount: str, axis: int) -> str:
    return entity("loops", AXES[axis], mount)


def log_orbit_loops(rec: Stream, animation: Animation, strips: list[Strip], *, width: float, shape_width: float) -> None:
    """Log loops of the mounts that do most work, at every level and with a cursor; of the first of them also two other plots.

    These are its shape, the loop scaled to its own ranges, and its phase portrait, deflection rate over deflection.
    """

    def loops_over(strip: Strip, mount: str, axis: int) -> list[Array]:
        return [loop_points(orbit.response.mounts[mount], axis) for orbit in strip.orbits]

    def portraits_over(strip: Strip, mount: str, axis: int) -> list[Array]:
        return [
            np.column_stack([orbit.response.mounts[mount].deflection[:, axis], orbit.deflection_rate(mount)[:, axis]])
            for orbit in strip.orbits
        ]

    shown = shown_loops(animation)
    lift, most = (LARGE, 6) if len(shown) <= 2 else (2.0 * LARGE, 4)  # in small frames more numbers would overlap
    for mount, axis in shown:
        loops = [loops_over(strip, mount, axis) for strip in strips]
        points = np.concatenate([loop for part in loops for loop in part])
        plot = Plot.around(points.min(axis=0), points.max(axis=0), width)
        across, upward = linear_ticks(*plot.across, most=most), linear_ticks(*plot.upward, most=most)
        path = loop_path(mount, axis)
        log_frame(rec, path, plot, across=across, upward=upward, lift=lift)
        _log_loops(rec, child(path, "data"), plot, animation, strips, loops)
        look = rr.Points2D.from_fields(colors=CURSOR, radii=rr.Radius.ui_points(4.5), draw_order=50.0)
        cursor, positions = child(path, "data", "cursor"), loop_points(animation.response.mounts[mount], axis)
        rec.log(cursor, look, static=True)
        columns = rr.Points2D.columns(positions=positions)
        timelines(rec, animation).send_columns(cursor, at(animation.response.time), columns)
    plot = Plot(across=(-1.12, 1.12), upward=(-1.12, 1.12), width=shape_width)
    for name, curves_over in ((SHAPE, loops_over), (PORTRAIT, portraits_over)):
        curves = []
        for strip in strips:
            over_own_ranges = []
            for curve in curves_over(strip, *shown[0]):
                low, high = curve.min(axis=0), curve.max(axis=0)
                over_own_ranges.append(np.asarray((2.0 * curve - low - high) / np.maximum(high - low, 1e-12)))
            curves.append(over_own_ranges)
        log_frame(rec, entity(name), plot, across=_SHAPE_TICKS, upward=_SHAPE_TICKS, lift=LARGE)
        _log_loops(rec, child(entity(name), "data"), plot, animation, strips, curves)


def _log_loops(rec: Stream, path: str, plot: Plot, animation: Animation, strips: list[Strip], loops: list[list[Array]]) -> None:
    """Log the loops of every level in a plot, those of unstable motions thinner."""
    rec.log(path, plot.transform(), static=True)
    for strip, rows in zip(strips, loops, strict=True):
        below = child(path, f"level_{strip.number + 1}")
        stable = strip.branch.stable[strip.points]
        radii = [rr.Radius.ui_points(1.5 if is_stable else 0.7) for is_stable in stable]
        rec.log(below, rr.LineStrips2D.from_fields(colors=_level_color(strip.number)), static=True)
        columns = rr.LineStrips2D.columns(strips=[loop.astype(np.float32) for loop in rows], radii=radii)
        rec.send_columns(below, at_points(animation, strip), columns)


def log_multipliers(rec: Stream, animation: Animation, *, width: float) -> None:
    """Log the unit circle, and the Floquet multipliers of every motion, unstable ones in amber."""
    side = _LARGEST * 1.06
    across = side * width / 100.0
    plot = Plot(across=(-across, across), upward=(-side, side), width=width)
    numbers = np.array([-1.0, 0.0, 1.0])
    log_frame(rec, entity(MULTIPLIERS), plot, across=numbers, upward=numbers, lift=LARGE)
    data = child(entity(MULTIPLIERS), "data")
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = rr.LineStrips2D([np.column_stack([np.cos(angle), np.sin(angle)])], colors=_CIRCLE, radii=0.006)
    rec.log(data, plot.transform(), static=True)
    rec.log(child(data, "circle"), circle, static=True)
    rec.log(child(data, "here"), rr.Points2D.from_fields(radii=rr.Radius.ui_points(5.0), draw_order=50.0), static=True)
    rows = [orbit.floquet_multipliers for orbit in animation.strip.orbits]
    values = np.concatenate(rows)
    modulus = np.abs(values)
    drawn = values * np.minimum(1.0, _LARGEST / np.maximum(modulus, 1e-12))
    colors: list[Color] = [_OUTSIDE if size > 1.0 + 1e-4 else _INSIDE for size in modulus]
    columns = rr.Points2D.columns(positions=np.column_stack([drawn.real, drawn.imag]), colors=colors)
    rec.send_columns(child(data, "here"), at_points(animation, animation.strip), columns.partition([row.size for row in rows]))


MODE = "mode"  # Timeline over the modes, numbered from 1; also the entity of the text about one
ALL = "modes"
_AWAY = 1.12  # distance of the camera over that for the modelled geometry: modes are drawn large


def record_modes(animation: ModeAnimation, path: str | Path, *, title: str = "", larger: Sequence[Modes] = ()) -> Path:
    """Write modes in motion as a recording, a file or `run.rrd` of a folder, and return its path.

    `larger` are modes of the same system at other amplitudes, for the table of all. RecordError if the environment
    variable RERUN switches recordings off.
    """
    response, modes, kind = animation.response, animation.modes, rr.MediaType.MARKDOWN
    target, title = target_of(path), title or response.scene.name
    # Shapes have no size: limits are not judged, and no mount is the worst.
    selection, frames = replace(select(response, ()), ranked=dict.fromkeys(AXES, ())), frames_of(response)
    name = f"{title}: modes, drawn with mounts that swing by {in_unit(animation.amplitude, 'mm'):.3g} mm"
    scene = whole_scene_view(response, frames, name, away=_AWAY)
    views = [
        rrb.TextDocumentView(origin=entity(MODE), name="Mode in view"),
        rrb.TextDocumentView(origin=entity(ALL), name="All modes"),
    ]
    panel = rrb.TimePanel(state="collapsed", timeline=TIMELINE, playback_speed=1.0, play_state="paused", loop_mode="all")
    layout = opening(rrb.Horizontal(scene, rrb.Vertical(*views, row_shares=[3, 2]), column_shares=[5, 3]), panel)
    with atomic_recording(target) as rec:
        rec.send_blueprint(layout, make_active=True, make_default=True)
        rec.send_recording_name(f"{title}: modes")
        texts = [mode_text(modes, mode) for mode in range(animation.starts.size)]
        along = Along(rec, animation.starts, {MODE: np.arange(1, animation.starts.size + 1)})
        columns = rr.TextDocument.columns(text=texts, media_type=[kind] * len(texts))
        along.send_columns(entity(MODE), [rr.TimeColumn(TIMELINE, duration=nanoseconds(animation.starts))], columns)
        table = amplitudes_table(modes, larger) if larger else modes_table(modes)
        rec.log(entity(ALL), rr.TextDocument(markdown_table(table), media_type=kind), static=True)
        log_scene(along, response, selection, frames)
    return target


def mode_text(modes: Modes, mode: int) -> str:
    return f"### Mode {mode + 1}: {markdown(modes.descriptions[mode])}\n\n{markdown_blocks(mode_blocks(modes, mode))}"
