"""`wirerope comfort`: what people feel at points of a run."""

from pathlib import Path
from typing import Literal


def comfort(folder: Path, /, *points: str, space: Literal["A", "B", "C"] | None = None, discard: float | None = None) -> int:
    """Print what people feel at bodies and points of a run: weighted acceleration, doses, and limits for ships.

    Weighted rms, running rms, crest factor, vibration dose and motion sickness dose are those of ISO 2631-1 (Wd horizontally,
    Wk vertically, Wf for motion sickness), habitability that of ISO 6954 of 1984 and of 2000.

    Args:
        folder: folder of a run.
        points: names of bodies and points; by default all points, or without any the payloads.
        space: passenger cabins A, crew accommodation B, working spaces C of ISO 6954:2000; all three by default.
        discard: length at the beginning that does not count [s]; by default until random vibration is stationary, else nothing.
    """
    from wirerope_mj.assessment.comfort import RMS_2000
    from wirerope_mj.assessment.criteria.sampled import steady_interval
    from wirerope_mj.assessment.criteria.verdict import payload_bodies
    from wirerope_mj.content.comfort import comfort_content
    from wirerope_mj.engine.response import load_response
    from wirerope_mj.views.terminal import show

    response = load_response(folder)
    if discard is None:
        discard = max(steady_interval(response.motion)[1], 0.0)
    subjects = points or tuple(response.points) or payload_bodies(response)
    spaces = (space,) if space else tuple(RMS_2000)
    show(comfort_content(folder.resolve().name, response, subjects, spaces=spaces, discard=discard))
    return 0
