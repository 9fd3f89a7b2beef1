"""`wirerope select`: parts simulated and ranked, and the vendors' worksheet; one message for bad input."""

import re

import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.selection import shock_from_text
from wirerope_mj.cli import main
from wirerope_mj.motions import HalfSine, Sawtooth, Trapezoid, VelocityStep

pytestmark = pytest.mark.quick

LOAD = ("select", "worksheet", "--mass", "200", "--mounts", "4")


def shown(capsys, *arguments):
    """Return exit code and text on the screen, blanks drawn together."""
    code = main([*LOAD, *arguments])
    return code, re.sub(r"[ \n]+", " ", capsys.readouterr().out)


def test_the_options_of_the_vendors_example_show_its_digits(capsys):
    code, out = shown(capsys, "--drop", "0.15", "--disturbance-rpm", "2400", "--fragility", "15", "--all")
    assert code == 0
    assert "490.5 N on each of 4 mounts" in out
    assert "velocity change 1.716 m/s" in out
    assert "at most 13.33 Hz (40 Hz / 3): vibration stiffness at most 351 N/mm" in out
    assert "15 g need at least 20.0 mm of travel: shock stiffness at most 368 N/mm" in out
    assert "WR12-606-06 69 8.33 49.5 99 6.06 99 rated travel" in out
    assert "g = 9.81 m/s^2" in out


def test_mass_mounts_shock_and_travel_are_enough(capsys):
    code, out = shown(capsys, "--shock", "15 g 11 ms half-sine", "--travel", "60")
    assert code == 0
    assert "velocity change 1.030 m/s" in out
    assert "room for 60 mm" in out
    assert "--fragility is not given: not judged" in out
    assert "is not rated by the vendor: not judged" in out
    assert "--all shows every part and says why" in out


def test_rejected_parts_are_listed_with_their_reasons(capsys):
    code, out = shown(capsys, "--velocity", "1", "--travel", "60", "--all")
    assert code == 0
    assert "WR2-100" in out
    assert "static load 490.5 N, limit 47 N" in out


def test_no_part_is_an_exit_code_of_its_own(capsys):
    code, out = shown(capsys, "--velocity", "9", "--travel", "10")
    assert code == 1
    assert "No part of the tables meets it." in out
    assert "room" in out


def test_without_a_fragility_the_softest_that_fits_comes_first_and_what_amplifies_is_marked(capsys):
    """WR40-200: 2 pi f V of 17.18 g out of a pulse of 15 g; its load, 2 % of the rating, must not put it in front."""
    _, out = shown(capsys, "--shock", "15 g 11 ms half-sine", "--all")
    assert out.index("WR12-700 92 6.60") < out.index("WR12-606-06 69") < out.index("WR40-200 2")
    assert "17.18*" in out
    assert "14.99 " in out  # CB1700-17: below the pulse's peak
    assert "14.99*" not in out
    assert "pass on more than the pulse's own peak of 15 g" in out


def test_a_pulse_that_is_far_too_long_for_the_rule_is_not_judged_by_it(capsys):
    code, out = shown(capsys, "--shock", "15 g 500 ms half-sine")
    assert code == 1
    assert "are not judged" in out
    assert "the rule of the velocity change does not hold" in out
    assert "rated travel" not in out
    assert "No part of the tables meets it" not in out


def test_parts_with_fewer_loops_are_offered(capsys):
    _, out = shown(capsys, "--velocity", "1", "--travel", "60", "--loops", "4", "6", "--all")
    assert "(6 of 8 loops)" in out
    assert "(4 of 8 loops)" in out


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("15 g 11 ms half-sine", HalfSine),
        ("15g, 11ms, half sine", HalfSine),
        ("20 g 11 ms Sawtooth", Sawtooth),
        ("20 g 11 ms terminal-peak saw tooth", Sawtooth),
        ("10 g 18 ms trapezoid", Trapezoid),
        ("2.5 m/s", VelocityStep),
    ],
)
def test_shocks_are_read_as_people_write_them(text, kind):
    assert isinstance(shock_from_text(text), kind)


def test_the_sawtooth_of_the_rack_has_the_vendors_velocity_change():
    assert shock_from_text("20 g 11 ms sawtooth").velocity_change == pytest.approx(1.0791, abs=0.00005)  # printed digits


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--shock", "hard"), "names no kind of motion: half-sine, sawtooth"),
        (("--shock", "15 g 11 ms half-sign"), "Did you mean half-sine?"),
        (("--shock", "15 g -11 ms half-sine"), "`duration` must be > 0, got -0.011"),
        (("--shock", "sine 0.5 g 12 Hz 10 s"), "a worksheet's shock is one pulse or a velocity"),
        ((), "give one shock"),
        (("--velocity", "1", "--drop", "1"), "give one shock"),
        (("--velocity", "1", "--travel", "-5"), "`--travel` must be > 0, got -5.0."),
        (("--mass", "-200"), "`--mass` must be > 0, got -200.0."),
        (("--mounts", "4.5", "--velocity", "1"), "`--mounts` must be an integer, got '4.5'."),
        (("--mounts", "0"), "`--mounts` must be an integer >= 1, got 0."),
        (("--velocity", "1", "--loops", "4", "6.5"), "`--loops` must be an integer, got 6.5."),
        (("--velocity", "1", "--disturbance-rpm", "2400", "--disturbance-hz", "40"), "not both"),
        (("--velocity", "1", "--loading", "sideways"), "sideways"),
    ],
)
def test_bad_input_is_one_message(capsys, arguments, message):
    given = {"--mass": "200", "--mounts": "4"}
    load = [word for option, value in given.items() if option not in arguments for word in (option, value)]
    assert main(["select", "worksheet", *load, *arguments]) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err


BOX = ("--mass", "300", "--size", "600", "500", "1200")
SHOCK = ("--shock", "half-sine 15 g 11 ms", "--shock", "2 m/s x")


def test_parts_are_simulated_and_the_chosen_one_becomes_a_model_with_the_limits(tmp_path, capsys):
    out, prices = tmp_path / "chosen", tmp_path / "prices.csv"
    prices.write_text("name, price, mass [kg]\nWR16-600, 100, 1.5\nWR20-600, 70, 2.5\n", encoding="utf-8")
    code = main([
        "select", *BOX, *SHOCK, "--mounts", "4", "--mounts", "4+2", "--parts", "WR??-600", "--fragility", "40", "--travel",
        "150", "--prices", str(prices), "--by", "price", "--all", "--out", str(out),
    ])  # fmt: skip
    shown = re.sub(r"[ \n]+", " ", capsys.readouterr().out)
    assert code == 0
    assert "1: half-sine 15 g 11 ms 2: 2 m/s x" in shown
    assert " choices simulated under 2 load cases keep every limit; first by price: 4 WR20-600" in shown
    assert " 280.00 10.00 " in shown  # four of them; six cost 420
    system = wr.load_system(out / "chosen.xml")
    assert {limit.kind for limit in system.limits} == {"acceleration", "clearance"}
    names = [mount.isolator.name for mount in system.mounts.values()]
    assert sorted(names) == ["Bottom of Enidine WR20-600"] * 4 + ["Enidine WR20-600"] * 4


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((*BOX, *SHOCK), "`--mounts` must say how many there are"),
        ((*BOX, *SHOCK, "--mounts", "3"), "1 or an even number"),
        ((*BOX, "--mounts", "4"), "there must be at least one load case: say its motion"),
        ((*BOX, "--mounts", "4", "--shock", "unbalance engine 1 kg.mm 5 Hz x"), "has no end"),
        ((*BOX, "--mounts", "4", *SHOCK, "--by", "price"), "`--by price` needs `--prices`"),
        ((*BOX, "--mounts", "4", *SHOCK, "--parts", "XX*"), "no part of the vendors' tables is called 'XX*'"),
        (("--mass", "300", "--mounts", "4+2", *SHOCK), "stand behind the equipment: give its `size`"),
        (("--mass", "300", "--mounts", "4", *SHOCK, "--room", "900", "900", "900"), "needs the box's own `--size`"),
        (("cabinet", *BOX, *SHOCK), "give the equipment as a model or a job, or as a box"),
        (("cabinet", *SHOCK, "--mounts", "4"), "a model has its mounts"),
        (SHOCK, "give the equipment as a model or a job"),
        (("cabinet", *SHOCK, "--limit", "acceleration/rock = 5 g"), "no body of the payload and no point 'rock'"),
        (("cabinet", *SHOCK, "--fragility", "-5"), "`--fragility` must be > 0"),
        (("cabinet", "--shock", "half sign 15 g 11 ms"), "Did you mean half-sine?"),
    ],
)
def test_a_request_that_cannot_be_simulated_is_one_message(capsys, arguments, message):
    assert main(["select", *arguments]) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
