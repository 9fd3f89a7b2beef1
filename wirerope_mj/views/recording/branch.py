"""Branches of periodic motions as one `run.rrd`: one scrubs along the resonance and sees the loops change.

Timelines: `point` goes from motion to motion along the branches of all levels, `frequency_mHz` does by frequency, and
`sim_time` [s] plays one repetition of each motion of the highest level after the other. Entities:

```text
/world                           the scene, as in the recording of a response, small motions drawn larger
/response                        frame of the frequency response, logarithmic;  .../data/level_1/stable|unstable|sweep_up|..
/response/data/here/level_1      the motion of each level on its curve;  .../data/events  folds and changes of stability
/loops/AXIS/MOUNT                frame of a mount's loops;  .../data/level_1  the loop;  .../data/cursor
/shape                           the loop that takes most energy, over its own ranges
/multipliers                     unit circle, and the Floquet multipliers of the motion
/motion  /about                  texts: the motion in view, and all levels
```
"""

from pathlib import Path
from typing import Any

from wirerope_mj.content.selection import select
from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary
from wirerope_mj.views.recording.along import along_branch
from wirerope_mj.views.recording.animation import animation_of, strips_of
from wirerope_mj.views.recording.branch_blueprint import SQUARE, branch_blueprint, loop_grid
from wirerope_mj.views.recording.camera import scene_extent
from wirerope_mj.views.recording.enlarge import enlarged, factor_of
from wirerope_mj.views.recording.multipliers import log_multipliers
from wirerope_mj.views.recording.orbit_loops import log_orbit_loops, shown_loops
from wirerope_mj.views.recording.orbit_text import log_texts
from wirerope_mj.views.recording.poses import frames_of
from wirerope_mj.views.recording.response_curve import log_response
from wirerope_mj.views.recording.scene import log_scene
from wirerope_mj.views.recording.target import atomic_recording, target_of


def record_branches(result: FrequencyResponse, findings: list[LevelSummary], path: str | Path) -> Path:
    """Write the branches of a frequency response as a recording, and return its path.

    Args:
        result: the response; at least one level has a branch.
        findings: what is read off it, level by level.
        path: file to write, or a folder, which gets a `run.rrd`; written whole or not at all.

    Raises:
        ValueError: no level has a branch.
        RecordError: the environment variable RERUN switches recordings off.
    """
    if not result.branches:
        raise ValueError("there is no branch to record; a sweep alone has no periodic motions.")
    target = target_of(path)
    with atomic_recording(target) as rec:
        _write(result, findings, rec)
    return target


def _write(result: FrequencyResponse, findings: list[LevelSummary], rec: Any) -> None:
    strips = strips_of(findings)
    animation = animation_of(strips[-1])  # the highest level, which the scene shows
    _, extent = scene_extent(animation.response.scene)
    factor = factor_of(animation.response, extent)
    scene = enlarged(animation.response, factor)
    selection, frames = select(animation.response), frames_of(scene)
    layout = branch_blueprint(scene, animation, frames, factor)
    rec.send_blueprint(layout, make_active=True, make_default=True)  # before the data: right from the first moment
    rec.send_recording_name(f"{result.name}: frequency response")
    log_texts(rec, result, findings, animation)
    log_response(rec, findings, animation, strips)
    log_multipliers(rec, animation, width=SQUARE)
    if shown_loops(animation):
        _, width = loop_grid(len(shown_loops(animation)))
        log_orbit_loops(rec, animation, strips, width=width, shape_width=SQUARE)
    log_scene(along_branch(rec, animation), scene, selection, frames)
