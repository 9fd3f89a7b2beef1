"""Mode shapes in motion as one `run.rrd`: the scene swings in one mode after the other, its figures beside it.

Timelines: `sim_time` [s] plays two slow periods of each mode, `mode` goes from mode to mode. Entities: /world is the scene as
in the recording of a response, /mode the text about the mode in view, /modes the table of all.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.dynamics.modes.animation import ModeAnimation
from wirerope_mj.dynamics.modes.result import Modes
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.recording.camera import Camera, whole_scene
from wirerope_mj.views.recording.paths import TIMELINE, entity, nanoseconds
from wirerope_mj.views.recording.poses import Frame, frames_of
from wirerope_mj.views.recording.scene import log_scene
from wirerope_mj.views.recording.selection import select
from wirerope_mj.views.recording.target import atomic_recording, target_of
from wirerope_mj.views.recording.views import scene_view

MODE = "mode"
"""Timeline over the modes, numbered from 1; also the entity of the text about one."""

ALL = "modes"

_AWAY = 1.12
"""How much farther away the camera stands than for the modelled geometry: modes are drawn large."""


class _AlongModes:
    """A recording stream whose rows in time stand at their mode too."""

    def __init__(self, rec: Any, film: ModeAnimation) -> None:
        self._rec, self._starts = rec, nanoseconds(film.starts).astype(np.int64)

    def log(self, *args: Any, **options: Any) -> None:
        """Log as the stream does."""
        self._rec.log(*args, **options)

    def send_columns(self, path: str, index: list[Any], columns: Any) -> None:
        """Send rows whose index is the timeline in time alone."""
        import rerun as rr

        time = index[0].as_arrow_array().cast("int64").to_numpy()
        mode = np.clip(np.searchsorted(self._starts, time, side="right"), 1, None)
        self._rec.send_columns(path, [*index, rr.TimeColumn(MODE, sequence=mode)], columns)


def record_modes(film: ModeAnimation, path: str | Path, *, title: str = "", larger: Sequence[Modes] = ()) -> Path:
    """Write modes in motion as a recording, and return its path.

    Args:
        film: the modes in motion.
        path: file to write, or a folder, which gets a `run.rrd`; written whole or not at all.
        title: name of the recording; that of the model by default.
        larger: modes of the same system at other amplitudes, for the table of all.

    Raises:
        RecordError: the environment variable RERUN switches recordings off.
    """
    target = target_of(path)
    with atomic_recording(target) as rec:
        _write(film, rec, title or film.response.scene.name, larger)
    return target


def _write(film: ModeAnimation, rec: Any, title: str, larger: Sequence[Modes]) -> None:
    import rerun as rr

    response = film.response
    selection, frames = select(response), frames_of(response)
    rec.send_blueprint(_blueprint(film, frames, title), make_active=True, make_default=True)
    rec.send_recording_name(f"{title}: modes")
    kind = rr.MediaType.MARKDOWN
    texts = [mode_text(film.modes, mode) for mode in range(film.starts.size)]
    index = [rr.TimeColumn(TIMELINE, duration=nanoseconds(film.starts))]
    columns = rr.TextDocument.columns(text=texts, media_type=[kind] * len(texts))
    along = _AlongModes(rec, film)
    along.send_columns(entity(MODE), index, columns)
    rec.log(entity(ALL), rr.TextDocument(modes_table(film.modes, larger), media_type=kind), static=True)
    log_scene(along, response, selection, frames)


def mode_text(modes: Modes, mode: int) -> str:
    """Return Markdown about one mode."""
    share = modes.participation[mode]
    parts = [f"### Mode {mode + 1}: {markdown(modes.descriptions[mode])}", f"**{_hertz(modes.frequencies[mode])}**"]
    parts.append(
        f"{_hertz(modes.loading[mode])} with the tangents on further loading, {_hertz(modes.unloading[mode])} on unloading; "
        f"damping ratio {modes.damping_ratio[mode]:.3f}"
    )
    parts.append("Share of the mass along x, y, z: " + ", ".join(f"{in_unit(part, '%'):.1f} %" for part in share))
    rows = ["| mount | roll | shear | axial |", "|:--|--:|--:|--:|"]
    for name, shape in modes.mounts.items():
        rows.append(f"| {markdown(name)} | " + " | ".join(f"{value:+.3f}" for value in shape[mode]) + " |")
    parts.append("Deflections of the mounts, the largest 1:\n\n" + "\n".join(rows))
    return "\n\n".join(parts)


def modes_table(modes: Modes, larger: Sequence[Modes] = ()) -> str:
    """Return Markdown with a row for every mode, and a column for every amplitude."""
    results = [modes, *larger]
    sizes = ["small cycles" if r.amplitude is None else f"{in_unit(r.amplitude, 'mm'):.4g} mm" for r in results]
    rows = [
        f"### About the {modes.history} position",
        "",
        f"| | {' | '.join(sizes)} | |",
        f"|--:|{'--:|' * len(sizes)}:--|",
    ]
    places = [modes.indices_in(result) for result in results]
    for mode, word in enumerate(modes.descriptions):
        cells = [
            _hertz(result.frequencies[place[mode]], result.damping_ratio[place[mode]])
            for result, place in zip(results, places, strict=True)
        ]
        rows.append(f"| {mode + 1} | {' | '.join(cells)} | {markdown(word)} |")
    rows += ["", "Damping ratios in brackets; mm: amplitude of the mount that moves most."]
    return "\n".join(rows)


def _hertz(frequency: float, damping: float = 0.0) -> str:
    if not np.isfinite(frequency):
        return "runs away"
    return f"{frequency:.3f} Hz ({damping:.3f})" if damping else f"{frequency:.3f} Hz"


def _blueprint(film: ModeAnimation, frames: dict[str, Frame], title: str) -> Any:
    import rerun.blueprint as rrb

    response = film.response
    base = response.scene.base
    camera = whole_scene(response)
    camera = Camera(eye=camera.target + _AWAY * (camera.eye - camera.target), target=camera.target)
    origin = frames[base].path if base in response.bodies else entity("world")
    name = f"{title}: modes, drawn with mounts that swing by {in_unit(film.amplitude, 'mm'):.3g} mm"
    scene = scene_view(origin, ["+ " + entity("world") + "/**"], name, camera)
    words = rrb.Vertical(
        rrb.TextDocumentView(origin=entity(MODE), name="Mode in view"),
        rrb.TextDocumentView(origin=entity(ALL), name="All modes"),
        row_shares=[3, 2],
    )
    return rrb.Blueprint(
        rrb.Horizontal(scene, words, column_shares=[5, 3]),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, playback_speed=1.0, play_state="paused", loop_mode="all"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TopPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )
