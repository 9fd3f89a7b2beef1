"""Base motions said in a few words: the same motions as their constructors make, and messages for what is not understood."""

import re
import warnings

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.motions.registry import (
    SPOKEN_MOTIONS,
    level_templates,
    motion_from_phrase,
    motion_from_words,
    motion_of_levels,
)

G = wr.STANDARD_GRAVITY

SAID = {
    ("half-sine", "15 g 11 ms z"): wr.HalfSine(peak=15 * G, duration=0.011, direction="z"),
    ("half-sine", "z 0.011s 147.09975m/s^2 at 50 ms"): wr.HalfSine(peak=15 * G, duration=0.011, direction="z", start=0.05),
    ("half-sine", "15 g 11 ms -y"): wr.HalfSine(peak=15 * G, duration=0.011, direction=(0, -1, 0)),
    ("half-sine", "15 g 11 ms 1,1,0"): wr.HalfSine(peak=15 * G, duration=0.011, direction=(1, 1, 0)),
    ("half-sine", "-3e1 g 6 ms x"): wr.HalfSine(peak=-30 * G, duration=0.006, direction="x"),
    ("sawtooth", "20 g 11 ms y"): wr.Sawtooth(peak=20 * G, duration=0.011, direction="y"),
    ("trapezoid", "10 g 18 ms rise 2 ms z"): wr.Trapezoid(peak=10 * G, duration=0.018, rise=0.002, direction="z"),
    ("trapezoid", "10 g 18 ms z"): wr.Trapezoid(peak=10 * G, duration=0.018, rise=0.0018, direction="z"),
    ("velocity-step", "2 m/s z at 10 ms"): wr.VelocityStep(velocity=2.0, direction="z", start=0.01),
    ("double-pulse", "50 mm 3 m/s 100 g z"): wr.DesignSpectrum(
        displacement=0.05, velocity=3.0, acceleration=100 * G
    ).double_half_sine(direction="z"),
    ("struck-deck", "14 Hz 1.5 m/s damping 5 % blow 4 ms z"): wr.DecayingSine(
        frequency=14.0, damping=0.05, velocity=1.5, direction="z", impact_duration=0.004
    ),
    ("struck-plate", "14 MPa 0.9 ms 320 kg/m2 z at 5 ms"): wr.StruckPlate(
        pressure=14e6, decay=0.9e-3, areal_mass=320.0, direction="z", start=0.005
    ),
    ("sine", "0.5 g 12 Hz 10 s z"): wr.Sine(frequency=12.0, acceleration=0.5 * G, duration=10.0, direction="z"),
    ("sweep", "0.5 g 5 to 50 Hz 2 oct/min z"): wr.Sweep(start=5, stop=50, rate=2, acceleration=0.5 * G, direction="z"),
    ("sweep", "0.5 g 50 Hz 5 Hz 2 oct/min z"): wr.Sweep(start=50, stop=5, rate=2, acceleration=0.5 * G, direction="z"),
}


FORCES = {
    ("unbalance", "engine 20 kg.mm 25 Hz x"): wr.Unbalance(site="engine", unbalance=0.02, frequency=25.0, axis="x"),
    ("unbalance", "fan 20 kg.mm 5 to 30 Hz 20 s -y for 25 s at 1 s"): wr.Unbalance(
        site="fan",
        unbalance=0.02,
        frequency=5.0,
        final_frequency=30.0,
        run_up=20.0,
        axis=(0, -1, 0),
        duration=25.0,
        start=1.0,
    ),
    ("reciprocating", "engine 8 kg.mm 25 Hz order 2 z"): wr.Unbalance(
        site="engine", unbalance=0.008, frequency=25.0, order=2.0, line="z"
    ),
    ("force", "engine 500 N 12 Hz 10 s z"): wr.HarmonicForce(site="engine", force=(0, 0, 500), frequency=12.0, duration=10.0),
    ("hammer", "anvil 3.3 kN.s 1 ms z"): wr.Blow(site="anvil", impulse=3300.0, duration=1e-3, direction="z"),
    ("moment", "engine 80 N.m 12 Hz 10 s y"): wr.HarmonicForce(site="engine", moment=(0, 80, 0), frequency=12.0, duration=10.0),
}


@pytest.mark.quick
@pytest.mark.parametrize("said", FORCES, ids=" ".join)
def test_a_phrase_is_the_force_that_its_constructor_makes(said):
    assert motion_from_phrase(*said) == FORCES[said]


@pytest.mark.quick
def test_a_table_of_forces_is_straight_between_its_rows(tmp_path):
    (tmp_path / "start.csv").write_text("time [ms], fz [kN], mx [N.m]\n0, 0, 0\n10, 2, 30\n20, 0, 0\n")
    force = motion_from_phrase("force-table", "engine start.csv at 1 s", folder=tmp_path)
    assert force.load("engine", [0.999, 1.005, 1.01, 1.015, 1.021]) == pytest.approx(
        np.array([[0, 0, 0, 0, 0, 0], [0, 0, 1e3, 15, 0, 0], [0, 0, 2e3, 30, 0, 0], [0, 0, 1e3, 15, 0, 0], [0] * 6])
    )
    assert not force.load("fan", [1.005]).any()


@pytest.mark.quick
def test_a_direction_beside_a_table_that_has_its_own_is_refused(tmp_path):
    (tmp_path / "start.csv").write_text("time [s], fz [N]\n0, 0\n1, 2\n")
    with pytest.raises(ValueError, match="a direction stands there, and none is expected"):
        motion_from_phrase("force-table", "engine start.csv x at 1 s", folder=tmp_path)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time [s], fw [N]\n0, 1\n", 'column "fw" is unknown'),
        ("time [s], fx [N], fx [N]\n0, 1, 1\n", "there twice"),
        ("fx [N], fy [N]\n0, 1\n", 'no column "time [s]"'),
        ("time [s], mx [N]\n0, 1\n", 'unknown unit "N"'),
        ("time [s], fx [N]\n0, 1\n0, 2\n", "must increase"),
        ("time [s], fx [N]\n0, 1\n", "n >= 2"),
    ],
)
def test_a_bad_table_of_forces_is_one_message(tmp_path, text, said):
    (tmp_path / "start.csv").write_text(text)
    with pytest.raises((ValueError, RecordError), match=re.escape(said)):
        motion_from_phrase("force-table", "engine start.csv", folder=tmp_path)


@pytest.mark.quick
@pytest.mark.parametrize(("said", "motion"), SAID.items(), ids=lambda item: " ".join(item) if isinstance(item, tuple) else "")
def test_a_phrase_is_the_motion_that_its_constructor_makes(said, motion):
    times = np.linspace(0.0, 0.2, 401)
    spoken = motion_from_phrase(*said)
    assert spoken.description == motion.description
    np.testing.assert_allclose(spoken.acceleration(times), motion.acceleration(times), rtol=1e-11, atol=1e-9)


@pytest.mark.quick
def test_axes_named_together_are_one_motion_along_each():
    times = np.linspace(0.0, 0.02, 41)
    along_z = motion_from_phrase("half-sine", "15 g 11 ms z").acceleration(times)[:, 2]
    np.testing.assert_allclose(
        motion_from_phrase("half-sine", "15 g 11 ms xz").acceleration(times)[:, [0, 2]].T, [along_z, along_z]
    )


@pytest.mark.quick
@pytest.mark.parametrize("text", ["2 g rms 10 to 90 Hz 5 s z", "rms 2 g 10 to 90 Hz 5 s z", "2 grms 0.01 to 0.09 kHz 5 s z"])
def test_a_random_vibration_is_said_by_its_level(tmp_path, text):
    level = (2.0 * G) ** 2 / 80.0
    motion = motion_from_phrase("random", text)
    np.testing.assert_allclose(motion.psd, [(10.0, level), (90.0, level)], rtol=1e-12)
    assert motion.rms == pytest.approx(2.0 * G, rel=1e-12)
    (tmp_path / "flat.csv").write_text("frequency [Hz], psd [g^2/Hz]\n10, 0.05\n90, 0.05\n")
    filed = motion_from_phrase("psd", "flat.csv 5 s z", folder=tmp_path)
    times = np.linspace(0.0, 5.0, 101)
    np.testing.assert_allclose(motion.acceleration(times), filed.acceleration(times), atol=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("2 g rms 90 to 10 Hz 5 s z", "lower to a higher frequency"), ("0 g rms 10 to 90 Hz 5 s z", "`rms` must be > 0"),
        ("2 g rms 10-90 Hz 5 s z", '"10-90" has no unit'), ("2 g rms 10 to 90 Hz z", "a time must stand there"),
        ("2 g rms 90 Hz 5 s z", "2 values of frequency"),
    ],
)  # fmt: skip
def test_a_level_that_is_none_is_refused(text, says):
    with pytest.raises(ValueError, match=says):
        motion_from_phrase("random", text)


@pytest.mark.quick
def test_every_example_is_understood(tmp_path):
    (tmp_path / "transport.csv").write_text("frequency [Hz], psd [g^2/Hz]\n5, 0.01\n200, 0.01\n")
    (tmp_path / "floor.csv").write_text("frequency [Hz], acceleration [g]\n1, 0.5\n5, 1\n33, 0.4\n")
    (tmp_path / "rrs.csv").write_text("frequency [Hz], acceleration [g]\n1, 0.5\n5, 1\n33, 0.4\n")
    (tmp_path / "levels.csv").write_text("from [Hz], to [Hz], displacement [mm]\n4, 15, 0.76\n16, 25, 0.51\n")
    (tmp_path / "start.csv").write_text("time [ms], fz [kN], mx [N.m]\n0, 0, 0\n10, 2, 30\n20, 0, 0\n")
    for kind, spoken in SPOKEN_MOTIONS.items():
        assert motion_from_phrase(kind, spoken.example, folder=tmp_path).description


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "lines", "quantity"),
    [
        ("from [Hz], to [Hz], displacement [in]\n4, 6, 0.03\n7, 7, 0.02\n", [(4, 3), (5, 3), (6, 3), (7, 2)], "displacement"),
        ("frequency [Hz]; velocity [mm/s]\n5; 254\n5.5; 508\n", [(5, 1), (5.5, 2)], "velocity"),
    ],
)  # fmt: skip
def test_an_amplitude_table_is_passed_frequency_by_frequency(tmp_path, text, lines, quantity):
    """Each is a steady sine in the middle of its dwell; MIL-STD-167-1A states inches over hertz."""
    (tmp_path / "table.csv").write_text(text)
    motion = motion_from_phrase("amplitude-table", "table.csv 4 s z at 1 s", folder=tmp_path)
    size = 0.254 if quantity == "velocity" else 0.000254
    for number, (frequency, factor) in enumerate(lines):
        times = 1.0 + 4.0 * number + np.linspace(1.5, 2.5, 1001)
        of = motion.velocity if quantity == "velocity" else motion.displacement
        assert np.abs(of(times)[:, 2]).max() == pytest.approx(factor * size, rel=2e-3)
        crossings = np.count_nonzero(np.diff(np.sign(of(times)[:, 2])))
        assert abs(crossings - 2.0 * frequency) <= 1
    assert not motion.acceleration([1.0 + 4.0 * len(lines) + 0.01]).any()


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("frequency [Hz], level [mm]\n5, 1\n", "at the end; here are frequency [Hz], level [mm]."),
        ("to [Hz], from [Hz], displacement [mm]\n5, 6, 1\n", "an amplitude table has the columns"),
        ("frequency [Hz], displacement [g]\n5, 1\n", 'unknown unit "g"'),
        ("from [Hz], to [Hz], displacement [mm]\n9, 6, 1\n", "must end above its start"),
        ("from [Hz], to [Hz], displacement [mm]\n4, 15, 1\n15, 25, 1\n", "begin it at 16 Hz"),
        ("frequency [Hz], displacement [mm]\n5, 0\n", "> 0"),
    ],
)
def test_a_bad_amplitude_table_is_one_message(tmp_path, text, said):
    (tmp_path / "table.csv").write_text(text)
    with pytest.raises((ValueError, RecordError), match=re.escape(said)):
        motion_from_phrase("amplitude-table", "table.csv 4 s z", folder=tmp_path)


@pytest.mark.quick
def test_an_amplitude_table_dwells_at_frequencies_of_its_own(tmp_path):
    (tmp_path / "table.csv").write_text("from [Hz], to [Hz], displacement [mm]\n4, 6, 0.5\n7, 9, 0.2\n")
    motion = motion_from_phrase("amplitude-table", "table.csv 4 s z dwell 9 s 5 Hz 8 Hz", folder=tmp_path)
    assert [(term.frequencies[0], term.start, term.duration) for term in motion.terms[6:]] == [(5, 24, 9), (8, 33, 9)]
    assert [term.amplitudes[0] for term in motion.terms[6:]] == pytest.approx([0.5e-3, 0.2e-3])
    for said, wrong in (("dwell 9 s", "belong together"), ("5 Hz", "belong together"), ("dwell 9 s 5.5 Hz", "got 5.5 Hz")):
        with pytest.raises(ValueError, match=wrong):
            motion_from_phrase("amplitude-table", f"table.csv 4 s z {said}", folder=tmp_path)


@pytest.mark.quick
def test_random_vibration_has_the_density_of_its_file(tmp_path):
    (tmp_path / "road test.csv").write_text("frequency [Hz]; psd [g^2/Hz]\n5; 0.01\n50; 0.01\n200; 0.000625\n")
    motion = motion_from_phrase("psd", "road test.csv 4 s xz seed 7", folder=tmp_path)
    psd = wr.motions.psd_from_g([(5, 0.01), (50, 0.01), (200, 0.000625)])
    times = np.linspace(0.0, 4.0, 300)
    expected = sum(
        wr.RandomVibration(psd=psd, duration=4.0, seed=seed, direction=axis).acceleration(times)
        for seed, axis in ((7, "x"), (8, "z"))
    )
    np.testing.assert_allclose(motion.acceleration(times), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("kind", "phrase", "said"),
    [
        ("half-sine", "15 g z", "a time must stand there (s, ms, us, min, h), and there is none"),
        ("half-sine", "11 ms z", "an acceleration must stand there"),
        ("half-sine", "15 g 11 ms", "a direction must stand there"),
        ("half-sine", "15 11 ms z", '"15" has no unit'),
        ("half-sine", "11 ms 15 z", '"15" has no unit'),
        ("half-sine", "15 g 11 ms z 20 g", "there are 2 of acceleration, and 1 is expected"),
        ("half-sine", "15 g 11 ms z 3 Hz", "there is one of frequency, and none is expected"),
        ("half-sine", "1,5 g 11 ms z", "decimals are written with a point"),
        ("half-sine", "15 G 11 ms z", '"G" is no unit known here; known are m/s^2, m/s2, '),
        ("half-sine", "15 G 11 ms z", "us, min, h. It is written like"),  # no units of other quantities
        ("half-sine", "15 g 11 ms up", '"up" is neither a number with a unit nor a direction'),
        ("half-sine", "15 g 11 ms x z", '"z" is a second direction'),
        ("half-sine", "15 g 11 ms z at", 'nothing follows "at"'),
        ("half-sine", "15 g 11 ms z at 3 g", '"g" is no unit known here; known are s, ms'),
        ("half-sine", "15 g 11 ms z at 1 s at 2 s", '"at" stands there twice'),
        ("half-sine", "? g 11 ms z", '"? g" is still open'),
        ("half-sine", "15 g -11 ms z", "`duration` must be"),
        ("half-sine", "15 g 11 ms z at 5 to 50 ms", '"at" takes one value, and "5 to 50" is a range'),
        ("half-sine", "15 g 11 ms z at 5 to", 'no number follows "5 to"'),
        ("half-sine", "15 g 11 ms 5 to z", 'no number follows "5 to"'),
        ("half-sine", "15 g 11 ms z 5 to at 50 ms", 'no number follows "5 to"'),
        ("half-sine", "15 g 5 to 11 ms z", "there are 2 of time, and 1 is expected"),
        ("sweep", "0.5 g 5 to 20 to 50 Hz 2 oct/min z", "there are 3 of frequency"),
        ("reciprocating", "engine 8 kg.mm 25 Hz order 2Hz z", '"order" takes a number without a unit'),
        ("reciprocating", "engine 8 kg.mm 25 Hz order 1 to 2 z", '"to" is neither a number'),
        ("psd", "missing.csv 30 s z", 'there is no file "missing.csv"'),
        ("sweep", "0.5 g 5 Hz 2 oct/min z", "2 values of frequency must stand there"),
        ("unbalance", "engine 20 kg.mm 5 to 30 Hz x", "two and the time of the run-up"),
        ("unbalance", "engine 20 kg.mm 5 Hz 3 s x", "two and the time of the run-up"),
        ("unbalance", "engine 20 N 5 Hz x", "an unbalance must stand there"),
        ("force", "engine 20 N 5 Hz z", "a time must stand there"),
    ],
)
def test_what_is_not_understood_is_named_with_an_example(kind, phrase, said):
    with pytest.raises(ValueError, match=re.escape(said)) as caught:
        motion_from_phrase(kind, phrase)
    assert str(caught.value).startswith(f'{kind} "{phrase}"')
    assert str(caught.value).endswith(f'It is written like "{SPOKEN_MOTIONS[kind].example}".')


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("frequency [Hz], psd\n5, 1\n", 'column "psd" has no unit'),
        ("frequency [Hz], psd [g]\n5, 1\n", 'unknown unit "g"'),
        ("frequency [Hz], psd [g^2/Hz]\n5, 0,01\n", "3 cells where the header has 2"),
        ("frequency [Hz], psd [g^2/Hz]\n5, 1\n4, 1\n", "must increase"),
        ("frequency [Hz], psd [g^2/Hz]\n5, 0\n6, 1\n", "> 0"),
        ("frequency [Hz], psd [g^2/Hz]\n", "at least 2 points"),
        ("frequency [Hz], x [g^2/Hz], y [g^2/Hz]\n5, 1, 1\n", "has two columns"),
        ("", "is empty"),
    ],
)
def test_a_bad_file_of_levels_is_one_message_that_names_it(tmp_path, text, said):
    (tmp_path / "road.csv").write_text(text)
    with pytest.raises(RecordError, match=re.escape(said)) as caught:
        motion_from_phrase("psd", "road.csv 30 s z", folder=tmp_path)
    assert str(tmp_path / "road.csv") in str(caught.value)


@pytest.mark.quick
@pytest.mark.parametrize("name", level_templates())
def test_levels_that_nobody_filled_in_are_refused(name):
    with pytest.raises(ModelError, match="still open"):
        motion_of_levels(level_templates()[name])


@pytest.mark.quick
@pytest.mark.parametrize("name", level_templates())
def test_filled_in_levels_are_a_motion(tmp_path, name):
    values = {"mm": "50", "m/s": "3", "g": "100", "Hz": "14", "%": "5", "ms": "8"}
    text = re.sub(r"\? (\S+)", lambda match: f"{values[match[1]]} {match[1]}", level_templates()[name].read_text())
    (tmp_path / "levels.toml").write_text(text)
    assert np.abs(motion_of_levels(tmp_path / "levels.toml").acceleration(np.linspace(0, 0.1, 500))).max() > 10.0


@pytest.mark.quick
def test_motions_of_a_file_are_added_each_with_its_factor(tmp_path):
    (tmp_path / "levels.toml").write_text(
        'standard = "mine"\n[[motion]]\nhalf-sine = "15 g 11 ms z"\n[[motion]]\nhalf-sine = "15 g 11 ms y"\nfactor = 0.4\n'
    )
    made = motion_of_levels(tmp_path / "levels.toml").acceleration([0.0055])[0] / G
    assert made == pytest.approx([0.0, 6.0, 15.0], rel=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "there is no table [[motion]]"),
        ("motion = 3", "line 1: `motion` must be a list of tables, got 3"),
        ("[[motion]]", "got nothing"),
        ('[[motion]]\nhalfsine = "15 g 11 ms z"', "line 2: [[motion]] 1 `halfsine` is unknown; known: half-sine"),
        ('[[motion]]\nhalf-sine = "15 g 11 ms z"\nsine = "1 g 5 Hz 1 s z"', "got half-sine, sine"),
        ("[[motion]]\nhalf-sine = 15", "must be a text"),
        ('[[motion]]\nhalf-sine = "15 g z"', "[[motion]] 1 half-sine"),
        ('[[motion]]\nhalf-sine = "15 g 11 ms z"\nfactor = 0', "`factor`"),
        ("level = 3", "`level` is unknown"),
        ("standard = 3\n[[motion]]", "must be a text"),
        ("standard = [", "not valid TOML"),
    ],
)
def test_a_bad_file_of_motions_is_one_message(tmp_path, text, said):
    (tmp_path / "levels.toml").write_text(text)
    with pytest.raises(ModelError, match=re.escape(said)) as caught:
        motion_of_levels(tmp_path / "levels.toml")
    assert str(caught.value).startswith(str(tmp_path / "levels.toml"))


@pytest.mark.quick
def test_a_limit_is_said_in_its_unit():
    assert limit_from_text("acceleration/rack = 15 g").values == pytest.approx((15 * G,))
    assert limit_from_text("acceleration/a b=0 0 15 g").name == "a b"
    assert limit_from_text("clearance/rack_top = 30 30 20 mm").values == (0.03, 0.03, 0.02)
    assert limit_from_text("acceleration/rack=1.5e1g").values == limit_from_text(" acceleration/rack  =  15  g ").values


@pytest.mark.quick
@pytest.mark.parametrize(
    "text", ["acceleration/rack 15 g", "acceleration/rack = 15", "acceleration/rack = 15 mm", "force/rack = 15 g",
             "acceleration/rack = 1 2 g", "acceleration/rack = -1 g", "acceleration/rack = 0 g", "= 3 g", ""],
)  # fmt: skip
def test_what_is_no_limit_is_refused_with_examples(text):
    with pytest.raises(ValueError, match="is written like"):
        limit_from_text(text)


@pytest.mark.parametrize(
    ("words", "kind", "phrase"),
    [
        ("double half-sine 90 g 3 m/s 42 mm", "double-pulse", "90 g 3 m/s 42 mm z"),
        ("15g, 11ms, half sine", "half-sine", "15 g 11 ms z"),
        ("Halfsine 15 g 11 ms -y at 50 ms", "half-sine", "15 g 11 ms -y at 50 ms"),
        ("20 g 11 ms terminal-peak saw tooth", "sawtooth", "20 g 11 ms z"),
        ("xy 20 g 11 ms sawtooth", "sawtooth", "20 g 11 ms xy"),
        ("2.5 m/s", "velocity-step", "2.5 m/s z"),
        ("2 m/s -x", "velocity-step", "2 m/s -x"),
        ("force engine 500 N 12 Hz 10 s z", "force", "engine 500 N 12 Hz 10 s z"),
    ],
)
def test_words_name_the_kind_anywhere_and_a_direction_or_none(words, kind, phrase):
    assert motion_from_words(words) == motion_from_phrase(kind, phrase)


@pytest.mark.parametrize(("words", "near"), [("half sign 15 g 11 ms", "half-sine"), ("swep 1 g 5 to 50 Hz", "sweep")])
def test_words_that_name_no_kind_are_answered_with_the_nearest(words, near):
    with pytest.raises(ValueError, match=f"names no kind of motion: .* Did you mean {near}\\?"):
        motion_from_words(words)


def test_many_motions_are_said_by_the_first_and_the_last():
    dwells = [wr.Sine(frequency=f, acceleration=1.0, direction="z", duration=1.0) for f in (4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0)]
    few, many = sum(dwells[1:6], start=dwells[0]), sum(dwells[1:], start=dwells[0])
    assert few.description.count(" Hz") == 6
    assert ".. 5 more .." in many.description
    assert many.description.startswith(dwells[0].description)
    assert many.description.endswith(dwells[-1].description)
    assert len(many.events) == 2 < len(few.events)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("kind", "phrase", "said"),
    [
        ("half-sine", "15 g 11 s z", "it lasts 11 s, and shocks are over sooner: was 11 ms meant?"),
        ("sawtooth", "15 g 1.001 s xyz", "it lasts 1.001 s, and shocks are over sooner: was 1.001 ms meant?"),
        ("trapezoid", "15 g 18 s rise 2 s z", "it lasts 18 s, and shocks are over sooner: was 18 ms meant?"),
        ("double-pulse", "50 m 3 m/s 100 g z", "s, and shocks are over sooner: is one of its units another?"),
    ],
)
def test_a_shock_of_more_than_a_second_is_questioned_once(kind, phrase, said):
    with pytest.warns(wr.ModelWarning) as caught:
        motion_from_phrase(kind, phrase)
    (warning,) = caught
    assert str(warning.message).startswith(f'{kind} "{phrase}": it lasts ')
    assert str(warning.message).endswith(said)


@pytest.mark.quick
def test_a_random_vibration_beyond_50_g_rms_is_questioned(tmp_path):
    for level, said in ((100.0, "its rms is 60 g, more than shakers reach: is it in (m/s^2)^2/Hz"), (50.0, "")):
        (tmp_path / "level.csv").write_text(f"frequency [Hz],psd [g^2/Hz]\n10,{level}\n46,{level}\n")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            motion_from_phrase("psd", "level.csv 10 s z", folder=tmp_path)
        assert [said in str(warning.message) for warning in caught] == [True] * bool(said)
        assert [said in finding.text for finding in wr.check(tmp_path / "level.csv")] == [True] * bool(said)


@pytest.mark.quick
def test_pulses_say_seconds_from_one_second_on():
    said = [motion_from_phrase("half-sine", f"15 g {time} z").description for time in ("11 ms", "999.9 ms", "1 s")]
    assert said == [f"half-sine 15 g {time} along z" for time in ("11 ms", "999.9 ms", "1 s")]  # warnings are errors here
