"""Selections in a room: layouts of mounts, heights, walls, every motion as an option, and what would do when no part does."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
import scipy.integrate

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.from_tables import mjcf_of
from wirerope_mj.engine.from_tables.layout import box_layout
from wirerope_mj.engine.statics.payloads import point_positions
from wirerope_mj.foundation.errors import Absent, ModelError
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.mounts.vendor_parts import load_isolator, vendor_parts
from wirerope_mj.runs.selection import equipment
from wirerope_mj.studies.catalogue import select_parts
from wirerope_mj.studies.needed_mount import DAMPING, needed_mount
from wirerope_mj.studies.room import limits_in_room

PART = next(part for part in vendor_parts() if part.name == "CB1500-20")
SIZE = (0.6, 0.5, 0.4)
HEIGHT = PART.height


def layout(mounts):
    return box_layout(PART, mass=100.0, mounts=mounts, size=SIZE)


@pytest.mark.quick
@pytest.mark.parametrize(("mounts", "names", "axial"), [
    ("4", ("below",), (0, 0, 1)), ("4 bottom", ("below",), (0, 0, 1)), ("4 ceiling", ("above",), (0, 0, -1)),
    ("4 wall", ("behind",), (0, -1, 0)), ("8 corners", ("diagonal",), None), ("4 top + 4 bottom", ("above", "below"), None),
    ("4+2", ("below", "behind"), None), ("4 corners 30 deg", ("diagonal",), None),
])  # fmt: skip
def test_mounts_stand_where_they_are_said_to(mounts, names, axial):
    made = layout(mounts)
    assert {mount.name.rsplit("_", 1)[0] for mount in made.mounts} == set(names)
    assert len(made.mounts) == sum(map(int, re.findall(r"\b\d+\b(?! deg)", mounts)))
    centre = made.payload.centre
    for mount in made.mounts:
        np.testing.assert_allclose(mount.axes @ mount.axes.T, np.eye(3), atol=1e-12)
        if axial is not None:
            np.testing.assert_allclose(mount.axes[2], axial, atol=1e-12)
        end = mount.position + 0.5 * HEIGHT * mount.axes[2] - centre  # on the box, and the mount outside of it
        assert np.abs(np.abs(end) / (0.5 * np.array(SIZE)) - 1.0).min() < 1e-9
        assert np.all(np.abs(end) <= 0.5 * np.array(SIZE) + 1e-9)
        assert mount.axes[2] @ end < 0.0  # from the base to the payload


@pytest.mark.quick
def test_mounts_at_corners_lean_as_far_as_they_are_said_to():
    for angle in (0.0, 30.0, 45.0):
        for mount in layout(f"8 corners {angle:g} deg").mounts:
            x, y, z = mount.axes[2]
            assert math.degrees(math.acos(abs(z))) == pytest.approx(angle, abs=1e-9)
            assert abs(x) == pytest.approx(abs(y), abs=1e-12)
    # stiffness of eight alike at 45 degrees, along axes of 1, 2 and 3: that of each direction adds up over them
    stiffness = sum(mount.axes.T @ np.diag([1.0, 2.0, 3.0]) @ mount.axes for mount in layout("8 corners 45 deg").mounts)
    np.testing.assert_allclose(stiffness, np.diag(np.diag(stiffness)), atol=1e-12)
    assert stiffness[0, 0] == pytest.approx(stiffness[1, 1])
    assert np.trace(stiffness) == pytest.approx(8 * 6.0)


@pytest.mark.quick
@pytest.mark.parametrize("mounts", ["0", "3", "5 top", "6 corners", "4 top 45 deg", "8 corners 95 deg", "4+4+4", "4 roof", ""])
def test_other_mounts_are_refused(mounts):
    with pytest.raises(ValueError, match="`mounts` must be how many stand where"):
        layout(mounts)
    with pytest.raises(ValueError, match="give its `size`"):
        box_layout(PART, mass=100.0, mounts="4 top", size=None)


def on(mounts):
    return wr.load_system(mjcf_of(layout(mounts)), isolators={PART.name: load_isolator(PART.name)})


ROOM = np.array([0.7, 0.8, 0.7])
OUT = 0.5 * PART.width - 0.125 * 0.5  # by which mounts an eighth of the box from its edge stand out of it


@pytest.mark.quick
@pytest.mark.parametrize(("mounts", "down", "up", "back"), [
    ("4", HEIGHT, 0.3 - HEIGHT, 0.15 - OUT),  # on the floor; in the middle between the walls
    ("4 ceiling", 0.3 - HEIGHT, HEIGHT, 0.15 - OUT),
    ("4 top + 4 bottom", 0.15, 0.15, 0.15 - OUT),
    ("4+2", HEIGHT, 0.3 - HEIGHT - (0.5 * PART.width - 0.125 * 0.4), HEIGHT - OUT),  # and at the wall behind, at +y
])  # fmt: skip
def test_points_keep_clear_of_the_walls_that_the_mounts_leave(mounts, down, up, back):
    limits = {one.name: one.ways for one in limits_in_room(on(mounts), ROOM)}
    low, high = limits["corner_1"], limits["corner_8"]  # at -x, -y, -z and at +x, +y, +z
    assert (low["-z"], high["+z"], high["+y"]) == pytest.approx((down, up, back))
    assert (low["-x"], high["+x"]) == pytest.approx((0.05, 0.05))
    assert low["+z"] == pytest.approx(0.4 + up)  # to the other wall


@pytest.mark.quick
def test_a_clearance_that_is_stated_holds_where_it_is_smaller_and_a_room_that_is_too_small_is_refused():
    system = on("4")
    stated = PayloadLimit(kind="clearance", name="corner_1", values=(0.02, 0.02, 0.5))
    limited = replace(system, limits=(stated,))
    (found,) = [one for one in limits_in_room(limited, ROOM) if one.name == "corner_1"]
    assert (found.ways["-x"], found.ways["-z"]) == pytest.approx((0.02, HEIGHT))
    with pytest.raises(ModelError, match="does not fit into the room along x and z, even at rest"):
        limits_in_room(system, np.array([0.5, 0.8, 0.4 + 0.5 * HEIGHT]))


@pytest.mark.quick
@pytest.mark.parametrize(("mounts", "behind"), [("8 corners 45 deg", 2), ("4 corners 30 deg", 1), ("4 wall", 1)])
def test_a_room_holds_the_bodies_of_mounts_as_they_stand(mounts, behind):
    """Half a box turned reaches along x, y and z as far as the sum of its half sizes times the cosines."""
    system, width = on(mounts), PART.width
    boxes = [(mount.position, mount.axes) for mount in system.mounts.values()]
    reach = [0.5 * (width * np.abs(axes[:, 0]) + HEIGHT * np.abs(axes[:, 2])) for _, axes in boxes]
    ends = np.array([place + way * half for (place, _), half in zip(boxes, reach, strict=True) for way in (-1.0, 1.0)])
    corners = np.array(list(point_positions(system).values()))
    sizes = np.ptp(np.concatenate([ends, corners]), axis=0)
    axis = 1 if mounts == "4 wall" else 2
    axial = max(abs(axes[axis, 2]) for _, axes in boxes)
    assert sizes[axis] > SIZE[axis] + behind * HEIGHT * axial - 1e-12
    if mounts != "4 wall":  # leaning, a mount reaches farther than its axis
        assert sizes[axis] == pytest.approx(
            SIZE[axis] + behind * (HEIGHT * axial + 0.5 * width * math.sqrt(1.0 - axial**2)), abs=1e-9
        )
    assert len(limits_in_room(system, sizes + 1e-9)) == 8
    for short in range(3):
        with pytest.raises(ModelError, match=f"along {'xyz'[short]}, even at rest"):
            limits_in_room(system, sizes + 1e-9 - 1e-3 * np.eye(3)[short])


@pytest.mark.quick
def test_a_mount_that_stands_out_of_the_equipment_sways_with_it():
    narrow = box_layout(PART, mass=100.0, mounts="4", size=(0.6, 0.2, 0.4))
    system = wr.load_system(mjcf_of(narrow), isolators={PART.name: load_isolator(PART.name)})
    out = 0.5 * PART.width - 0.125 * 0.2  # from an eighth of the box on, bars along x
    assert out > 0.01
    limits = {one.name: one.ways for one in limits_in_room(system, np.array([0.7, 0.2 + 2.0 * out + 0.06, 0.7]))}
    assert limits["corner_1"]["-y"] == pytest.approx(0.03)
    assert limits["corner_1"]["-x"] == pytest.approx(0.05)


CASES = {"pulse": wr.HalfSine(peak=150.0, duration=0.011, direction="z")}


def test_equipment_that_sways_beyond_the_room_does_not_keep_it():
    systems, cases = equipment(None, CASES, box={"mass": 120.0, "size": SIZE}, mounts=["4"], fragility=1e4)
    parts = {name: load_isolator(name) for name in ("CB1500-20", "CB1500-30")}
    free = {one.name: one for one in select_parts(systems, parts, cases).tried}
    needed = max(0.4 + one.isolator.geometry.height + one.displacement for one in free.values())
    wide = {one.name: one for one in select_parts(systems, parts, cases, room=np.array([2.0, 2.0, 2.0 * needed])).tried}
    assert all(one.used("clearance")[0] < 1.0 for one in wide.values())
    tight = 0.4 + max(one.isolator.geometry.height for one in free.values()) + 1e-4
    close = {one.name: one for one in select_parts(systems, parts, cases, room=np.array([2.0, 2.0, tight])).tried}
    name = max(free, key=lambda name: free[name].isolator.geometry.height)
    assert close[name].used("clearance")[0] > 1.0  # a tenth of a millimetre above it
    assert close[name].used("clearance")[0] == pytest.approx(free[name].largest("displacement/*/+z") / 1e-4, rel=1e-2)


def oscillator(frequency, motion, end):
    """Integrate a mass on a spring with 15 % damping: largest acceleration, and deflection from the unloaded geometry."""
    pulsation = 2.0 * math.pi * frequency

    def rates(time, state):
        base = float(motion.acceleration([time])[0, 2])
        return [state[1], -(pulsation**2) * state[0] - 2.0 * DAMPING * pulsation * state[1] - base]

    done = scipy.integrate.solve_ivp(rates, (0.0, end), [0.0, 0.0], max_step=2e-4, rtol=1e-8, atol=1e-10)
    force = pulsation**2 * done.y[0] + 2.0 * DAMPING * pulsation * done.y[1]
    return np.abs(force).max(), np.abs(done.y[0]).max() + 9.80665 / pulsation**2


@pytest.mark.slow
def test_what_would_do_keeps_the_limits_and_softer_or_stiffer_does_not():
    systems, cases = equipment(None, CASES, box={"mass": 120.0, "size": SIZE}, mounts=["4"], fragility=80.0, travel=0.03)
    (system,) = systems.values()
    found = needed_mount(system, 4, cases)
    assert found.load == pytest.approx(120.0 * 9.80665 / 4.0)
    for frequency, stiffness in zip(found.frequencies, found.stiffness, strict=True):
        assert stiffness == pytest.approx(30.0 * (2.0 * math.pi * frequency) ** 2)
    step = 100.0 ** (1.0 / 160.0)  # between two frequencies that are tried
    soft, stiff = found.frequencies
    peaks = {f: oscillator(f, CASES["pulse"], 1.0) for f in (soft / step**1.1, soft, stiff, stiff * step**1.1)}
    for f in (soft, stiff):
        assert peaks[f][0] <= 80.0 * 1.01  # straight lines between samples of the spectrum
        assert peaks[f][1] <= 0.03 * 1.01
    assert found.travel == pytest.approx((peaks[soft][1], peaks[stiff][1]), rel=0.01)
    assert peaks[soft / step**1.1][1] > 0.03 * 0.99
    assert peaks[stiff * step**1.1][0] > 80.0 * 0.99


@pytest.mark.quick
def test_where_no_linear_mount_would_do_the_best_is_said():
    systems, cases = equipment(None, CASES, box={"mass": 120.0, "size": SIZE}, mounts=["4"], fragility=10.0, travel=0.002)
    (system,) = systems.values()
    found = needed_mount(system, 4, cases)
    assert isinstance(found, Absent)
    assert "No linear mount would do either: at best, at" in found.reason
    jump = needed_mount(system, 4, {"step": wr.VelocityStep(velocity=1.0, direction="z")})
    assert isinstance(jump, Absent)


WORDS = ("select", "--mass", "120", "--size", "600", "500", "400", "--parts", "CB1500*")


def shown(capsys, *arguments):
    code = main([*WORDS, *arguments])
    return code, re.sub(r"\s+", " ", capsys.readouterr().out)


def test_the_command_takes_motions_heights_and_rooms_and_says_the_answer_first(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "psd.csv").write_text("frequency [Hz],psd [g^2/Hz]\n5,0.001\n50,0.001\n", encoding="utf-8")
    limits = ("--mounts", "4 top + 4 bottom", "--fragility", "15")
    cases = ("--half-sine", "10 g 11 ms z", "--psd", "psd.csv 2 s z seed 1")
    code, out = shown(capsys, *limits, *cases, "--height-max", "100", "--room", "1000", "900", "700")
    assert code == 0
    assert re.match(r" 1 of 2 parts simulated under 2 load cases keeps every limit; first by largest margin: 8 CB1500-15", out)
    assert "3-sigma acceleration under" not in out  # that it is not judged
    assert "it is higher than 100 mm" in out
    assert "--all lists them" in out
    assert "--out FOLDER writes the model on the first part, --all prints every table; both simulate again" in out
    assert " CB1500-20, CB1500-25" not in out
    _, every = shown(capsys, *limits, *cases[:2], "--height-max", "100", "--all")
    assert "3 sigma" not in every
    assert re.search(r"CB1500-[\d, CB-]*: it is higher than 100 mm", every)


def test_a_measured_record_is_a_load_case_with_the_options_that_shock_has(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    time = np.arange(0.0, 0.3, 5e-4)
    pulse = np.where(time < 0.011, 5.0 * np.sin(math.pi * time / 0.011), 0.0)
    rows = "\n".join(f"{t:.4f},{a:.6f}" for t, a in zip(time, pulse, strict=True))
    (tmp_path / "deck.csv").write_text(f"time [s],up [g]\n{rows}\n", encoding="utf-8")
    played = ("--record", "deck.csv", "--scale", "2", "--direction", "z", "--start", "0.05")
    code, out = shown(capsys, "--mounts", "4", "--fragility", "30", *played, "--all", "--out", "chosen")
    assert code == 0
    assert "Load cases 1: deck" in out
    system = wr.load_system(tmp_path / "chosen" / "chosen.xml")
    motion = wr.load_record("deck.csv", channels={"up": "z"}, scale=2.0, start=0.05)
    body = wr.simulate(system, motion, duration=1.5, accuracy=1e-4).peaks.bodies["equipment"]
    peak = float(re.search(r"peak ([\d.]+) g", out)[1])
    assert body.acceleration.value / 9.80665 == pytest.approx(peak, abs=0.006)  # as printed, and 1e-3 of the peak


def test_the_command_says_what_would_do_when_no_part_does(capsys):
    code, out = shown(capsys, "--mounts", "4", "--half-sine", "60 g 11 ms z", "--fragility", "4", "--travel", "500")
    assert code == 1
    assert "None of" in out
    assert "What would do: 4 mounts, rated for 294 N each, from " in out
    said = r"from ([\d.]+) N/mm \([\d.]+ Hz, ([\d.]+) mm of travel\) to ([\d.]+) N/mm"
    stiffness, travel, stiff = map(float, re.search(said, out).groups())
    assert stiffness < stiff
    assert travel > 30.0 * 9.80665 / stiffness  # beyond the sag, in mm


@pytest.mark.parametrize(("arguments", "message"), [
    (("--height-max", "-5"), "`--height-max` must be > 0, got -5"),
    (("--room", "1000", "0", "700"), "`--room` must be > 0, got 0"),
    (("--drop", "300 mm onto -x"), "'drop 300 mm onto -x' lands on another side than the one on which the model stands"),
    (("--mounts", "4 roof"), "`mounts` must be how many stand where"),
    (("--scale", "2"), "`--scale` belongs to `--record`, which is not given."),
])  # fmt: skip
def test_bad_rooms_are_one_message(capsys, arguments, message):
    words = [*WORDS, "--half-sine", "10 g 11 ms z", *(() if "--mounts" in arguments else ("--mounts", "4")), *arguments]
    assert main(words) == 2
    assert message in " ".join(capsys.readouterr().err.split())
