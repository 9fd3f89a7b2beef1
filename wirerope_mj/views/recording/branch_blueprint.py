"""How a recording of branches opens: scene and words beside curves and loops, paused at the first point."""

from typing import Any

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.views.recording.along import POINT
from wirerope_mj.views.recording.animation import Film
from wirerope_mj.views.recording.camera import whole_scene
from wirerope_mj.views.recording.frame import HEIGHT
from wirerope_mj.views.recording.multipliers import PATH as MULTIPLIERS
from wirerope_mj.views.recording.orbit_loops import SHAPE, loop_path, shown_loops
from wirerope_mj.views.recording.orbit_text import ABOUT, MOTION
from wirerope_mj.views.recording.paths import AXES, entity
from wirerope_mj.views.recording.poses import Frame
from wirerope_mj.views.recording.response_curve import PATH as RESPONSE
from wirerope_mj.views.recording.response_curve import WIDTH

PANE = (640.0, 500.0)
"""Width and height [points] of the pane of loops on a full-HD screen."""

SQUARE = 92.0
"""Width of the frames of shape and multipliers, whose panes are a little higher than wide."""

AWAY = 1.15
"""How much farther away the camera stands than for the modelled geometry: motions are drawn larger."""

PER_SECOND = 5.0
"""Points that are played in a second."""

_ON_A_DARK = [24, 27, 31]


def loop_grid(loops: int) -> tuple[int, float]:
    """Return columns of the grid of loops, and the width of a frame that fills its place in it."""
    columns = 1 if loops == 1 else 2
    rows = -(-loops // columns)
    wide, high = PANE[0] / columns - 60.0, PANE[1] / rows - 62.0
    return columns, HEIGHT * min(max(wide / high, 0.8), 3.0)


def branch_blueprint(scene: Response, film: Film, frames: dict[str, Frame], factor: float) -> Any:
    """Return the layout of the viewer.

    Args:
        scene: what the scene is drawn from, its motions `factor` times as large.
        film: the motions that are played.
        frames: frames of the bodies.
        factor: how much larger motions are drawn.
    """
    import rerun.blueprint as rrb

    words = rrb.Tabs(
        rrb.TextDocumentView(origin=entity(MOTION), name="Motion"),
        rrb.TextDocumentView(origin=entity(ABOUT), name="Levels"),
    )
    multipliers = _plane(entity(MULTIPLIERS), f"Floquet multipliers at {film.strip.level:.4g} m/s²", SQUARE)
    left = rrb.Vertical(
        _scene(scene, film, frames, factor), rrb.Horizontal(words, multipliers, column_shares=[1, 1]), row_shares=[1, 1]
    )
    response = _plane(entity(RESPONSE), "Largest acceleration [m/s²] over frequency [Hz]", WIDTH)
    below = _loops(film)
    right = rrb.Vertical(response, *below, row_shares=[1] * (1 + len(below)))
    slow = film.strip.frequency[int(film.strip.amplitude.argmax())]  # one period at the resonance takes a second
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[5, 6]),
        rrb.TimePanel(
            state="collapsed", timeline=POINT, playback_speed=1.0 / float(slow), fps=PER_SECOND * float(slow),
            play_state="paused", loop_mode="all",
        ),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TopPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )  # fmt: skip


def _loops(film: Film) -> list[Any]:
    """Return the loops and the shape of one, if there are mounts."""
    import rerun.blueprint as rrb

    shown = shown_loops(film)
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
    return rrb.Spatial2DView(origin=origin, name=name, visual_bounds=bounds)


def _scene(scene: Response, film: Film, frames: dict[str, Frame], factor: float) -> Any:
    import rerun.blueprint as rrb

    base = scene.scene.base
    camera = whole_scene(scene)
    eye: Array = camera.target + AWAY * (camera.eye - camera.target)
    larger = f", motion drawn {factor:g} times larger" if factor > 1.0 else ""
    return rrb.Spatial3DView(
        origin=frames[base].path if base in scene.bodies else entity("world"),
        contents=["+ " + entity("world") + "/**"],
        name=f"{scene.scene.name} at {film.strip.level:.4g} m/s², seen from the base{larger}",
        background=_ON_A_DARK,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital, position=eye, look_target=camera.target, eye_up=[0.0, 0.0, 1.0]
        ),
    )
