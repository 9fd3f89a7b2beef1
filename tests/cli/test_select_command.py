"""`wirerope select`: the worksheet on the screen, candidates, reasons, simulation; one message for bad input."""

import re

import pytest

from wirerope_mj.assessment.selection import shock_from_text
from wirerope_mj.cli import main
from wirerope_mj.motions import HalfSine, Sawtooth, Trapezoid, VelocityStep

pytestmark = pytest.mark.quick

LOAD = ("select", "--mass", "200", "--mounts", "4")


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


def test_simulation_stands_beside_the_worksheet(capsys):
    code, out = shown(capsys, "--velocity", "1", "--travel", "60", "--fragility", "12", "--simulate", "--best", "1")
    assert code == 0
    assert "simul." in out
    assert "the isolator file of a part, else one fitted from its row" in out


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
    assert shock_from_text("20 g 11 ms sawtooth").velocity_change == pytest.approx(
        1.0791, abs=0.00005
    )  # printed digits


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--shock", "hard"), '`--shock` must be like "15 g 11 ms half-sine"'),
        (("--shock", "15 g 11 ms rectangle"), "`--shock` must be like"),
        (("--shock", "15 g -11 ms half-sine"), "'-11' must be a finite number > 0"),
        ((), "give one shock"),
        (("--velocity", "1", "--drop", "1"), "give one shock"),
        (("--velocity", "1", "--travel", "-5"), "`--travel` must be > 0, got -5.0."),
        (("--mass", "-200"), "`--mass` must be > 0, got -200.0."),
        (("--mounts", "4.5", "--velocity", "1"), "`--mounts` must be an integer, got '4.5'."),
        (("--mounts", "0"), "`--mounts` must be an integer >= 1, got 0."),
        (("--velocity", "1", "--loops", "4", "6.5"), "`--loops` must be an integer, got 6.5."),
        (("--velocity", "1", "--disturbance-rpm", "2400", "--disturbance-hz", "40"), "not both"),
        (("--velocity", "1", "--simulate", "--best", "0"), "`--best` must be an integer >= 1"),
        (("--velocity", "1", "--loading", "sideways"), "sideways"),
    ],
)
def test_bad_input_is_one_message(capsys, arguments, message):
    given = {"--mass": "200", "--mounts": "4"}
    load = [word for option, value in given.items() if option not in arguments for word in (option, value)]
    assert main(["select", *load, *arguments]) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err
