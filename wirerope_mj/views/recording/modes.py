"""Mode shapes in motion as one `run.rrd`: the scene swings in one mode after the other, its values beside it.

Timelines: `sim_time` [s] plays two slow periods of each mode, `mode` goes from mode to mode. Entities: /world is the scene as
in the recording of a response, /mode the text about the mode in view, /modes the table of all.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from wirerope_mj.content.modes import amplitudes_table, mode_blocks, modes_table
from wirerope_mj.content.selection import select
from wirerope_mj.dynamics.modes.animation import ModeAnimation
from wirerope_mj.dynamics.modes.result import Modes
from wirerope_mj.foundation.plain_text import markdown
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.views.markdown import markdown_blocks, markdown_table
from wirerope_mj.views.recording.animation import Along
from wirerope_mj.views.recording.paths import AXES, TIMELINE, entity, nanoseconds
from wirerope_mj.views.recording.poses import frames_of
from wirerope_mj.views.recording.scene import log_scene
from wirerope_mj.views.recording.target import atomic_recording, target_of
from wirerope_mj.views.recording.views import opening, whole_scene_view

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
