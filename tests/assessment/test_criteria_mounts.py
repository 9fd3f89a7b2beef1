"""Travels and loads of mounts: along the axes, combined, static and largest force."""

from dataclasses import replace

import numpy as np
import pytest
from house import calls, deck, mjcf
from made_up_floor import TRAVEL, floor_response

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import (
    bottoming_verdicts,
    judge,
    mount_peaks,
    starting_load_verdicts,
    travel_verdicts,
    verdict_lines,
)

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY


def by_name(verdicts):
    return {(v.subject, v.criterion): v for v in verdicts}


@pytest.fixture(scope="module")
def floor():
    return floor_response()


def test_travels_are_the_peaks_against_their_ratings(floor):
    found = by_name(travel_verdicts(floor))
    peak = floor.peaks.mounts["m03"].deflection
    reached = {
        "compression": -peak.minimum[2],
        "tension": peak.maximum[2],
        "shear": max(-peak.minimum[1], peak.maximum[1]),
        "roll": max(-peak.minimum[0], peak.maximum[0]),
    }
    for rating, value in reached.items():
        verdict = found["m03", f"travel in {rating}"]
        assert verdict.value == value
        assert verdict.limit == TRAVEL[rating]
        assert verdict.unit == "m"
        assert verdict.verdict == ("within" if value <= TRAVEL[rating] else "exceeded")
    assert found["m03", "travel in compression"].time == peak.minimum_time[2]
    assert found["m03", "travel in tension"].time == peak.maximum_time[2]


def test_the_combined_travel_is_that_of_one_instant(floor):
    d = floor.mounts["m05"].deflection
    axial = np.where(d[:, 2] < 0.0, d[:, 2] / TRAVEL["compression"], d[:, 2] / TRAVEL["tension"])
    total = np.sqrt((d[:, 0] / TRAVEL["roll"]) ** 2 + (d[:, 1] / TRAVEL["shear"]) ** 2 + axial**2)
    verdict = by_name(travel_verdicts(floor))["m05", "travel combined"]
    # between two samples of 1 ms a motion of 9 Hz may be (2 pi 9 0.001)^2 / 8 = 0.04 % higher
    assert total.max() <= verdict.value <= 1.0005 * total.max()
    assert verdict.time == pytest.approx(floor.time[total.argmax()], abs=1e-3)
    assert verdict.limit == 1.0
    each = [by_name(travel_verdicts(floor))["m05", f"travel in {rating}"].utilisation for rating in TRAVEL]
    assert max(each) < verdict.value < np.sqrt(3.0) * max(each)


def test_a_missing_rating_is_not_judged_but_may_be_exceeded_by_the_others():
    some = {"compression": 1.0, "tension": 1.0, "shear": 1.0}
    roomy = by_name(travel_verdicts(floor_response(travel=some)))
    assert roomy["m01", "travel in roll"].verdict == "not judged"
    assert "no travel in roll is rated" in roomy["m01", "travel in roll"].note
    assert roomy["m01", "travel combined"].verdict == "not judged"
    assert roomy["m01", "travel combined"].note.endswith("; no travel in roll is rated")
    tight = by_name(travel_verdicts(floor_response(travel=some | {"compression": 0.02})))
    assert tight["m01", "travel combined"].verdict == "exceeded"
    none = by_name(travel_verdicts(floor_response(travel={})))
    assert {v.verdict for v in none.values()} == {"not judged"}


def test_unrated_tension_counts_nothing_in_all_axes_together():
    """No vendor rates tension: a rebound into it is said, and counts nothing; shear and roll at that instant do."""
    rated = {"compression": 0.06, "shear": 0.05, "roll": 0.05}
    response = floor_response(travel=rated)
    found = by_name(travel_verdicts(response))
    d = response.mounts["m05"].deflection
    pressed = d[:, 2] <= 0.0
    total = np.sqrt((d[:, 0] / 0.05) ** 2 + (d[:, 1] / 0.05) ** 2 + (np.where(pressed, d[:, 2], 0.0) / 0.06) ** 2)
    verdict = found["m05", "travel combined"]
    assert total.max() <= verdict.value <= 1.0005 * total.max()
    for mount in response.mounts:  # an axis by itself never uses more than all together
        alone = [v.utilisation for (name, _), v in found.items() if name == mount and v.utilisation is not None]
        assert max(alone) <= found[mount, "travel combined"].value * (1.0 + 1e-12)
    assert (verdict.verdict, verdict.limit) == ("within", 1.0)
    length, reach = np.count_nonzero(~pressed), 1e3 * d[:, 2].max()  # samples of 1 ms
    assert f"up to {reach:.3g} mm of tension count nothing, {length:.3g} ms in all" in verdict.note
    assert verdict.note.endswith("; no travel in tension is rated")
    assert found["m05", "travel in tension"].verdict == "not judged"
    most = max(response.mounts, key=lambda name: found[name, "travel in tension"].value)
    reach = 1e3 * found[most, "travel in tension"].value
    said = next(
        line for line in verdict_lines(response, judge(response)) if line.startswith("Combined travel is within at all 8")
    )
    assert said.endswith(f"; tension, up to {reach:.3g} mm at {most}, has no limit and is left out.")
    # What is rated can exceed while the mount is in tension: a lower bound that is enough.
    slim = by_name(travel_verdicts(floor_response(travel=rated | {"compression": 1.0, "roll": 0.012})))[
        "m05", "travel combined"
    ]
    assert slim.verdict == "exceeded"
    assert "count nothing" not in slim.note


def test_a_mount_that_only_hangs_without_a_rating_is_not_judged_together():
    response = box_on_four(hang=True)
    mounts = tuple(replace(m, travel={"compression": 0.02, "shear": 0.02, "roll": 0.02}) for m in response.scene.mounts)
    hanging = replace(response, scene=replace(response.scene, mounts=mounts))
    verdict = by_name(travel_verdicts(hanging))["a", "travel combined"]
    assert response.mounts["a"].deflection[:, 2].min() > 0.0
    assert verdict.verdict == "not judged"
    assert "count nothing" not in verdict.note
    assert verdict.note.endswith("; in tension throughout, and no travel in tension is rated")


def test_a_mount_that_only_hangs_without_a_rating_uses_no_zero_of_its_travel():
    response = box_on_four(hang=True)
    mounts = tuple(replace(m, travel={"compression": 0.02, "shear": 0.02, "roll": 0.02}) for m in response.scene.mounts)
    numerics = replace(response.numerics, slowest_period=np.nan)  # the run counts as long enough
    hanging = replace(response, scene=replace(response.scene, mounts=mounts), numerics=numerics)
    rows, reason = judge(hanging), "in tension throughout, and no travel in tension is rated"
    of_travel = [row for row in rows if row.criterion.kind in ("travel", "bottoming") and row.subject == "a"]
    assert {(row.verdict, row.note) for row in of_travel} == {
        ("not judged", reason),
        ("not judged", "no travel in tension is rated"),
    }
    said = verdict_lines(hanging, rows)
    assert not [line for line in said if line.startswith("Travel along single axes")]
    assert [line for line in said if line.startswith("Not judged, because no travel is rated: tension of a, ")]
    peak = next(row for row in mount_peaks(hanging) if row.name == "a")
    assert (peak.utilisation, peak.governing, peak.one_way) == (None, "", "tension")


def test_the_line_on_combined_travel_says_which_mount_is_not_judged_and_why():
    floor = floor_response(travel={rating: 2.0 * size for rating, size in TRAVEL.items()})
    first, *others = floor.scene.mounts
    unrated = replace(first, travel={rating: size for rating, size in first.travel.items() if rating != "roll"})
    mixed = replace(floor, scene=replace(floor.scene, mounts=(unrated, *others)))
    (said,) = (line for line in verdict_lines(mixed, judge(mixed)) if line.startswith("Combined travel"))
    assert said.startswith("Combined travel is within at all 7 mounts that are judged; ")
    assert said.endswith("; not judged at m01: no travel in roll is rated.")


def test_judging_keeps_no_histories(tmp_path):
    """A day on a floor of 24 mounts would fill the memory: what is read for a verdict goes again."""
    box_on_four().save(tmp_path)
    response = wr.load_response(tmp_path)
    assert judge(response)
    for part in (*response.mounts.values(), *response.bodies.values(), *response.points.values()):
        assert not [name for name, value in vars(part).items() if isinstance(value, np.ndarray)]


def test_beyond_the_rating_it_says_for_how_long():
    floor = floor_response(travel=TRAVEL | {"compression": 0.01})
    verdict = by_name(travel_verdicts(floor))["m01", "travel in compression"]
    beyond = np.count_nonzero(floor.mounts["m01"].deflection[:, 2] < -0.01)  # samples of 1 ms
    assert verdict.verdict == "exceeded"
    assert verdict.note == f"beyond it for {beyond} ms in all"


def box_on_four(*, gravity=G, hang=False, static_load=25.0, initial="settled", offset=0.0):
    """Return the response at rest of 9 kg, its mass `offset` along x, on four springs of 4 kN/m at +-0.2 m, or below them."""
    spots = {"a": (0.2, 0.2), "b": (-0.2, 0.2), "c": (0.2, -0.2), "d": (-0.2, -0.2)}
    way = -1.0 if hang else 1.0
    euler = ' euler="180 0 0"' if hang else ""
    base = {f"d_{n}": f'pos="{x} {y} {0.2 * way}"{euler}' for n, (x, y) in spots.items()}
    sites = "".join(f'<site name="p_{n}" pos="{x} {y} {-0.1 * way}"/>' for n, (x, y) in spots.items())
    world = deck(base) + (
        f'<body name="box" pos="0 0 {0.3 * way}"><freejoint/><geom size=".1" mass="9" pos="{offset} 0 0"/>{sites}</body>'
    )
    spring = wr.KelvinVoigt(k=4000.0, c=60.0)
    isolator = wr.Isolator(name="S", roll=spring, shear=spring, axial=spring, limits=wr.Limits(static_load=static_load))
    system = wr.load_system(
        mjcf(world, [(n, f"p_{n}", f"d_{n}", "s") for n in spots], gravity=gravity), isolators={"s": isolator}
    )
    motion = wr.HalfSine(peak=2.0 * G, duration=0.011, direction="z", start=0.02)
    return wr.simulate(system, motion, duration=0.1, timestep=1e-3, initial=initial)


def test_static_loads_are_the_shares_of_the_weight():
    """Four equal mounts, the mass 50 mm off: W (1/4 + e x / sum x^2) on either side."""
    found = starting_load_verdicts(box_on_four(offset=0.05))
    weight = 9.0 * G
    near, far = weight * (0.25 + 0.05 * 0.2 / 0.16), weight * (0.25 - 0.05 * 0.2 / 0.16)
    # 2 %: the box tilts by 14 mrad, which the shares for a flat one do not know
    assert [v.value for v in found] == pytest.approx([near, far, near, far], rel=0.02)
    assert [v.verdict for v in found] == ["within" if v.value <= 25.0 else "exceeded" for v in found]
    assert {v.verdict for v in found} == {"within", "exceeded"}


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"hang": True}, "hangs"),
        ({"static_load": None}, "no static load is rated"),
        ({"initial": "unloaded"}, "does not begin at rest in equilibrium"),
    ],
)
def test_a_static_load_that_the_rating_does_not_speak_of_is_not_judged(changes, reason):
    for verdict in starting_load_verdicts(box_on_four(**changes)):
        assert verdict.verdict == "not judged"
        assert reason in verdict.note


def test_a_mount_pressed_until_its_bars_meet_is_said_to_lack_a_stop(floor):
    low = -floor.peaks.mounts["m04"].deflection.minimum[2]
    pressed = with_size(floor, height=0.99 * low + 0.04, bar=0.02)
    verdict = by_name(bottoming_verdicts(pressed))["m04", "bottoming"]
    assert verdict.value == low
    assert verdict.limit == pytest.approx(0.99 * low, rel=1e-12)  # height less two bars, not the height
    assert verdict.verdict == "exceeded"
    assert "height less two bars" in verdict.note
    assert "m04" in next(line for line in verdict_lines(pressed, judge(pressed)) if "A stop is missing" in line)
    kept = with_size(floor, height=1.01 * low + 0.04, bar=0.02)
    assert by_name(bottoming_verdicts(kept))["m04", "bottoming"].verdict == "within"


def test_bottoming_is_not_judged_where_nobody_states_the_bars(floor):
    """The height alone is an upper bound: it can be exceeded, but says of nothing that it is within."""
    low = -floor.peaks.mounts["m04"].deflection.minimum[2]
    for height, said in ((np.nan, "no height"), (1.01 * low, "no thickness of its bars")):
        verdict = by_name(bottoming_verdicts(with_size(floor, height=height, bar=np.nan)))["m04", "bottoming"]
        assert verdict.verdict == "not judged"
        assert said in verdict.note
    flat = with_size(floor, height=0.99 * low, bar=np.nan)
    assert by_name(bottoming_verdicts(flat))["m04", "bottoming"].verdict == "exceeded"


def with_size(response, **size):
    mounts = tuple(replace(mount, **size) for mount in response.scene.mounts)
    return replace(response, scene=replace(response.scene, mounts=mounts))


def test_a_floor_is_judged_in_as_many_steps_however_long_it_is():
    short, floor = (floor_response(mounts=24, equipment=10, rows=rows) for rows in (200, 2000))
    found = judge(floor)
    judge(short)  # what is imported or kept at the first call does not count
    counts = [calls(lambda response=response: judge(response))["call"] for response in (short, floor)]
    assert counts[0] == counts[1] < 10_000  # measured: 4,875, of 24 mounts and 10 bodies
    assert len({v.criterion for v in found}) == 9
    assert all(np.isfinite(v.value) for v in found)


def test_no_base_is_no_trouble():
    floor = floor_response(base="")
    scene = replace(floor.scene, mounts=())
    assert judge(replace(floor, scene=scene))
