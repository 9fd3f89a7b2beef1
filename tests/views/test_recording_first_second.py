"""What is seen when a recording opens: banner, numbers along axes, names in legends, marks of what fails."""

import io
import math
from dataclasses import replace

import matplotlib.image
import numpy as np
import pytest
from made_up_floor import floor_response
from recordings import column, entities
from rerun.chunk import RrdReader

from wirerope_mj.assessment.criteria import Criterion, Verdict, judge
from wirerope_mj.content.blocks import BASE, OTHERS, Curve, Panel
from wirerope_mj.content.histories import contact_panels, used_panel
from wirerope_mj.content.selection import select
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.views.colours import DARK
from wirerope_mj.views.recording import record_rerun
from wirerope_mj.views.recording.banner import log_tile
from wirerope_mj.views.recording.panels import emptiest_corner, log_panel
from wirerope_mj.views.recording.scene import carrier_of
from wirerope_mj.views.recording.views import seen_window, with_ticks

RED = int.from_bytes(bytes((*DARK.exceeded, 255)))  # as the viewer keeps it


def numbers_along(low, high, length, apart, steps):
    """Count the numbers that the viewer writes: multiples of a step that stand far enough apart."""
    return max(
        math.floor(high / step + 1e-9) - math.ceil(low / step - 1e-9) + 1
        for step in steps
        if length * step >= apart * (high - low)
    )


@pytest.mark.parametrize("length", [90.0, 150.0, 240.0, 700.0])
def test_every_upright_axis_carries_three_numbers(length):
    steps = [10.0**power for power in range(-9, 10)]
    rng = np.random.default_rng(3)
    for size in 10.0 ** rng.uniform(-4.0, 5.0, 200):
        low, high = np.sort(rng.uniform(-1.0, 1.0, 2)) * size
        start, end = with_ticks(low, high, length)
        assert start <= low < high <= end
        assert numbers_along(start, end, length, 22.0, steps) >= 3
        above = with_ticks(low, high, length, from_low=True)
        assert above[0] == low
        assert numbers_along(*above, length, 22.0, steps) >= 3


@pytest.mark.parametrize("window", [(0.0, 0.195), (0.04, 0.31), (0.0, 0.15), (0.0, 98.0), (12.0, 3000.0), (-0.01, 0.9)])
def test_an_axis_of_time_begins_where_the_event_does_and_carries_three_numbers(window):
    start, end = with_ticks(*window, 1040.0, time=True)
    assert start == window[0]
    assert end >= window[1]
    steps = [*(10.0**power for power in range(-9, 2)), 60.0, 600.0, 3600.0]
    assert numbers_along(start, end, 1040.0, 72.0, steps) >= 3


@pytest.mark.parametrize("width", [520.0, 1040.0])
def test_a_window_is_seen_a_little_longer_or_without_its_quiet_end(width):
    steps = [*(10.0**power for power in range(-9, 2)), 60.0, 600.0]
    for end in (0.15, 0.195, 0.31, 0.9, 1.25, 7.0, 98.0):
        start, last = seen_window((0.02, end), width)
        assert 0.0 <= start <= 0.02
        assert 0.6 <= (last - start) / (end - 0.02) <= 1.8
        if width > 1000.0:
            assert (last - start) / (end - 0.02) <= 1.3  # with room for the last number
        assert numbers_along(start, last, width, 69.0, steps) >= 3


def test_an_axis_that_carries_three_numbers_stays_as_it_is():
    assert with_ticks(-42.6, 17.9, 150.0) == (-42.6, 17.9)
    assert with_ticks(0.0, 0.7, 1040.0, time=True) == (0.0, 0.7)


class Named:
    """A stream that keeps the names of series."""

    def __init__(self):
        self.names = set()

    def log(self, path, look, *, static):
        for batch in look.as_component_batches():
            if "names" in str(batch.component_descriptor()):
                self.names |= set(batch.as_arrow_array().to_pylist())

    def send_columns(self, path, index, columns):
        pass


@pytest.mark.parametrize("limits", [["rack"], ["rack", "top"], ["rack", "top", "foot"]])
def test_a_legend_has_six_names_at_most_and_one_for_a_limit_of_both_signs(limits):
    time = np.linspace(0.0, 1.0, 50)
    kinds = [(name, number) for number, name in enumerate(("rack", "top", "foot"))]
    kinds += [("base", BASE), ("5 others", OTHERS), ("5 others", OTHERS)]
    curves = [Curve(x=time, y=np.sin(9.0 * time + n), name=name, kind=kind) for n, (name, kind) in enumerate(kinds)]
    levels = [(f"limit of {name}", sign * (n + 1.0)) for n, name in enumerate(limits) for sign in (1.0, -1.0)]
    stream = Named()
    log_panel(stream, "/p", Panel(curves=curves, ylabel="", unit="g", limits=levels), (0.0, 1.0), every=False)
    assert len(stream.names) <= 6
    if len(limits) == 1:
        assert "limit of rack ±1 g" in stream.names


def test_a_legend_stands_where_it_hides_least_of_what_is_seen():
    time = np.linspace(0.0, 1.0, 200)
    early = Curve(x=time, y=np.exp(-9.0 * time) * np.sin(60.0 * time), name="rack", kind=0)
    assert "Right" in emptiest_corner(Panel(curves=[early], ylabel=""), (0.0, 1.0), (-1.0, 1.0), (1000.0, 200.0))
    rising = Curve(x=time, y=time, name="rack", kind=0)
    assert emptiest_corner(Panel(curves=[rising], ylabel=""), (0.0, 1.0), (0.0, 1.0), (1000.0, 200.0)) == "RightBottom"
    # In a range that reaches twice as far there is room above it.
    assert emptiest_corner(Panel(curves=[early], ylabel=""), (0.0, 0.3), (-1.0, 9.0), (1000.0, 200.0)).endswith("Top")


@pytest.mark.parametrize("tone", ["exceeded", "within", "unjudged"])
def test_the_tile_has_the_colour_of_the_verdict_and_letters_on_it(tone):
    kept = []

    class Keeping:
        def log(self, path, look, *, static):
            kept.append((path, look))

    log_tile(Keeping(), "PASS of 20 of 24 mounts", tone)
    ((path, look),) = kept
    assert path == "/verdict/tile"
    blob = next(batch for batch in look.as_component_batches() if "blob" in str(batch.component_descriptor()))
    picture = matplotlib.image.imread(io.BytesIO(bytes(blob.as_arrow_array().to_pylist()[0])), format="png")
    colours = np.round(255.0 * picture[..., :3]).astype(int)
    assert tuple(colours[0, 0]) == getattr(DARK, tone)
    for rows in (colours[40:120], colours[140:190]):  # the answer, and of what part it is
        assert (rows == DARK.ground).all(axis=-1).any()


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    response = floor_response(travel={"compression": 0.01, "tension": 0.5})
    return response, record_rerun(response, tmp_path_factory.mktemp("run") / "run.rrd", title="Case 3")


def test_the_banner_says_the_name_and_the_verdict_in_its_colour(failing):
    _, path = failing
    found = entities(path)
    text = column(found["/verdict"], "TextDocument:text")[0][0].as_py()
    assert text.startswith("Case 3: **FAIL: ")
    reader, grounds = RrdReader(str(path)), set()
    for chunk in reader.stream(store=reader.blueprints()[0]):
        batch = chunk.to_record_batch()
        if "Background:color" in batch.schema.names:
            grounds |= set(batch["Background:color"].flatten().to_pylist())
    assert RED in grounds


def test_the_worst_mount_is_ringed_in_every_scene_and_in_the_plan_and_red_as_it_fails(failing):
    response, path = failing
    found = entities(path)
    for ring, part in (("/world/deck/ring", "3D"), ("/ghosts/world/deck/ring", "3D"), ("/plan/ring", "2D")):
        assert column(found[ring], f"LineStrips{part}:colors")[0].as_py() == [RED]
    worst = select(response).governing
    label = column(found["/ghosts/world/deck/worst"], "Points3D:labels")[0][0].as_py()
    assert label.startswith(f"{worst} ")


def test_a_body_beyond_its_limit_is_outlined_and_others_are_not(tmp_path):
    import wirerope_mj as wr

    system = wr.load_system("cabinet")
    motion = wr.HalfSine(peak=25.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z")
    response = wr.simulate(system, motion, duration=0.04, accuracy=1e-2)
    exceeded = {row.subject for row in judge(response) if row.verdict == "exceeded"}
    found = entities(record_rerun(response, tmp_path / "run.rrd"))
    outlined = {path.split("/")[-2] for path in found if path.endswith("/outline") and path.startswith("/world")}
    assert outlined == exceeded & set(response.bodies) == {"rack"}
    assert any(path.startswith("/ghosts") and path.endswith("/rack/outline") for path in found)
    assert carrier_of(response, "rack_top") == "rack"  # which is outlined if its point fails


def test_a_limit_of_a_stop_stands_in_the_panel_of_its_force_and_is_exceeded_there():
    import wirerope_mj as wr

    system = wr.load_system("cabinet")
    motion = wr.HalfSine(peak=40.0 * wr.STANDARD_GRAVITY, duration=0.011, direction=(1.0, 0.0, 1.0))
    response = wr.simulate(system, motion, duration=0.05, accuracy=1e-2)
    struck = [peak for peak in response.peaks.contacts.values() if peak.touches]
    largest = max(struck, key=lambda peak: peak.force)
    for part, shown in ((0.4, True), (1.2, True), (4.0, False)):
        limit = PayloadLimit(kind="force", name=largest.mount, values=(part * largest.force,))
        panel, *_ = contact_panels(replace(response, scene=replace(response.scene, limits=(limit,))), (0.0, 0.05))
        assert [name for name, _ in panel.limits] == [f"limit of {largest.mount}"] * shown
        assert bool(panel.exceeded) == (part < 1.0)


def test_the_most_used_over_time_have_names_and_colours_whatever_is_used_at_rest():
    selection = select(floor_response())
    least, at_rest = selection.used[-1].subject, Criterion("static load in compression", sense="relaxed")
    load = Verdict(criterion=at_rest, subject=least, value=2.6e3, limit=2e3, unit="N")
    selection = select(floor_response(), (load, *selection.verdicts))
    assert selection.used[0].subject == load.subject  # by its load at rest
    panel = used_panel(floor_response(), selection)
    tops = [float(curve.y.max()) for curve in panel.curves]
    assert min(tops[:3]) >= max(tops[3:])
    assert len({curve.kind for curve in panel.curves[:3]}) == 3
    assert panel.title.startswith(f"Used of the limits [%]: {panel.curves[0].name}, ")
