"""Layout of a recording of branches: scene and texts beside curves and loops, paused at the first point."""

from typing import Any

from wirerope_mj.engine.response import Response
from wirerope_mj.views.recording.along import POINT
from wirerope_mj.views.recording.animation import Animation
from wirerope_mj.views.recording.frame import GROUND, HEIGHT, fitting_width
from wirerope_mj.views.recording.letters import known_letters
from wirerope_mj.views.recording.multipliers import PATH as MULTIPLIERS
from wirerope_mj.views.recording.orbit_loops import SHAPE, loop_path, shown_loops
from wirerope_mj.views.recording.orbit_text import ABOUT, MOTION
from wirerope_mj.views.recording.paths import AXES, entity
from wirerope_mj.views.recording.poses import Frame
from wirerope_mj.views.recording.response_curve import PATH as RESPONSE
from wirerope_mj.views.recording.response_curve import WIDTH
from wirerope_mj.views.recording.views import opening, whole_scene_view

PANE = (640.0, 500.0)
"""Width and height [points] of the pane of loops on a full-HD screen."""

SQUARE = 92.0
"""Width of the frames of shape and multipliers, whose panes are a little higher than wide."""

AWAY = 1.15
"""Factor by which the camera stands farther away than for the modelled geometry: motions are drawn larger."""

PER_SECOND = 5.0
"""Points that are played in a second."""


def loop_grid(loops: int) -> tuple[int, float]:
    """Return columns of the grid of loops, and the width of a frame that fills its cell."""
    columns = 1 if loops == 1 else 2
    rows = -(-loops // columns)
    return columns, fitting_width(PANE, columns, rows)


def branch_blueprint(scene: Response, animation: Animation, frames: dict[str, Frame], factor: float) -> Any:
    """Return the layout of the viewer; `scene` is the response that is drawn, with motions `factor` times as large."""
    import rerun.blueprint as rrb

    texts = rrb.Tabs(
        rrb.TextDocumentView(origin=entity(MOTION), name="Motion"),
        rrb.TextDocumentView(origin=entity(ABOUT), name="Levels"),
    )
    multipliers = _plane(entity(MULTIPLIERS), f"Floquet multipliers at {animation.strip.level:.4g} m/s²", SQUARE)
    larger = f", motion drawn {factor:g} times larger" if factor > 1.0 else ""
    name = f"{scene.scene.name} at {animation.strip.level:.4g} m/s², seen from the base{larger}"
    left = rrb.Vertical(
        whole_scene_view(scene, frames, name, away=AWAY),
        rrb.Horizontal(texts, multipliers, column_shares=[1, 1]),
        row_shares=[1, 1],
    )
    response = _plane(entity(RESPONSE), "Largest acceleration [m/s²] over frequency [Hz]", WIDTH)
    below = _loops(animation)
    right = rrb.Vertical(response, *below, row_shares=[1] * (1 + len(below)))
    slow = animation.strip.frequency[
        int(animation.strip.amplitude.argmax())
    ]  # one period at the resonance takes a second
    panel = rrb.TimePanel(
        state="collapsed", timeline=POINT, playback_speed=1.0 / float(slow), fps=PER_SECOND * float(slow),
        play_state="paused", loop_mode="all",
    )  # fmt: skip
    return opening(rrb.Horizontal(left, right, column_shares=[5, 6]), panel)


def _loops(animation: Animation) -> list[Any]:
    """Return the loops and the shape of one, if there are mounts."""
    import rerun.blueprint as rrb

    shown = shown_loops(animation)
    if not shown:
        return []
    columns, width = loop_grid(len(shown))
    loops = [_plane(loop_path(mount, axis), f"{mount}, {AXES[axis]}: kN over mm", width) for mount, axis in shown]
    mount, axis = shown[0]
    shape = _plane(entity(SHAPE), f"{mount}, {AXES[axis]}: over its own ranges", SQUARE)
    return [rrb.Horizontal(rrb.Grid(*loops, grid_columns=columns), shape, column_shares=[8, 5])]


def _plane(origin: str, name: str, width: float) -> Any:
    import rerun.blueprint as rrb

    bounds = rrb.VisualBounds2D(x_range=[-16.0, width + 4.0], y_range=[-8.0, HEIGHT + 15.0])
    return rrb.Spatial2DView(origin=origin, name=known_letters(name), background=GROUND, visual_bounds=bounds)
