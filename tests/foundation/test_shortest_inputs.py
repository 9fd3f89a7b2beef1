"""The shortest inputs that ended in a traceback, in a hang or in an answer to another question: one message, exit code 2."""

import json

import numpy as np
import pytest
import tomli_w

import wirerope_mj as wr
from wirerope_mj.assessment.durability import rainflow_cycles
from wirerope_mj.cli import main
from wirerope_mj.dynamics.frequency_response.summary import order_bands
from wirerope_mj.engine.from_tables.sheet import read_sheet
from wirerope_mj.foundation.errors import (
    AccuracyWarning,
    BudgetError,
    ConvergenceError,
    ModelError,
    RecordError,
    RecordWarning,
)
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.motions import DecayingSine, Sine
from wirerope_mj.motions.registry import motion_from_phrase
from wirerope_mj.mounts.estimate import estimate_loop
from wirerope_mj.runs import run_scenario
from wirerope_mj.runs.board.what_if import sliders_of, with_slider
from wirerope_mj.runs.scenario import Scenario, load_scenario
from wirerope_mj.runs.scenario_file import read_judge_table
from wirerope_mj.runs.write import checked_arguments
from wirerope_mj.studies.inputs_file import STUDY, identity, write_inputs
from wirerope_mj.studies.vary.vary_option import read_vary

PSD = "frequency [Hz],psd [g^2/Hz]\n5,0.01\n100,0.01\n"


@pytest.mark.parametrize(
    ("kind", "phrase", "message"),
    [
        ("psd", "p.csv 1 s z seed 1e400", '"1e400" is too large for a number'),
        (
            "psd",
            "p.csv 1 s z seed 9007199254740993",
            "a seed is an integer from 0 to 9007199254740991, got 9007199254740992",
        ),
        ("psd", "p.csv 1e9 s z", "takes 8e.11 points"),
        ("sine", "0.5 g 1e-300 Hz 10 s z", "`frequency` must be 1e-06 to 1e.06 Hz, got 1e-300"),
        ("sine", "1e-400 g 5 Hz 10 s z", '"1e-400" is too small for a number'),
        ("force", "engine 1e308 kN 12 Hz 10 s z", '"1e308 kN" is too large for a number'),
        ("struck-deck", "14 Hz 1.5 m/s damping 5 % blow 1e9 ms z", "1e.06 s is no blow on this deck"),
        ("struck-deck", "14 Hz 1.5 m/s damping 5 % blow 1e-300 ms z", "`impact_duration` must be 1e-09 to 1e.09 s"),
        ("half-sine", "15 g 11 ms z at 1e20 s", "`start` must be -1e.06 to 1e.06 s"),
        ("velocity-step", "1e300 m/s z", "`velocity` must be 1e-12 to 1e.12 in magnitude"),
    ],
)
def test_phrases_with_numbers_beyond_every_motion(kind, phrase, message, tmp_path):
    (tmp_path / "p.csv").write_text(PSD)
    with pytest.raises(ValueError, match=message):
        motion_from_phrase(kind, phrase, folder=tmp_path).corners  # noqa: B018  # knots are made when they are looked at


def test_a_seed_as_large_as_a_float_tells_apart_is_taken(tmp_path):
    (tmp_path / "p.csv").write_text(PSD)
    assert motion_from_phrase("psd", "p.csv 1 s z seed 9007199254740991", folder=tmp_path).seed == 2**53 - 1


def test_motions_at_the_ends_of_their_ranges_are_finite():
    times = np.linspace(0.0, 10.0, 11)
    slow = Sine(frequency=1e-6, acceleration=1e12, direction="z", duration=1.0)
    limp = DecayingSine(frequency=14.0, damping=0.05, velocity=1.5, impact_duration=22.7, direction="z")
    for motion in (slow, limp):
        for part in (motion.acceleration, motion.velocity, motion.displacement):
            assert np.isfinite(part(times)).all()
    after = limp.displacement(np.array([22.7, 24.271]))[:, 2]
    # A deck that swings with zeta w0 loses all but a thousandth in 1.571 s; what swings is what the blow's end left.
    assert 0.0 < abs(after[1]) < 2e-3 * abs(limp.displacement(22.7 + np.linspace(0.0, 0.1, 50))[:, 2]).max()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["fmu", "sdof_shaker", "o.fmu", "--timestep", "0"], "`timestep` must be > 0"),
        (["fmu", "sdof_shaker", "o.fmu", "--timestep", "nan"], "`timestep` must be a finite number"),
        (["select", "worksheet", "--mass", "100", "--mounts", "4", "--drop", "1e-308"], "`drop` must be 1e-12 to 1e+12"),
        (["shock", "sdof_shaker", "--half-sine", "1 g 11 ms z", "--duration", "1e9"], "may take up to"),
        (["shock", "sdof_shaker", "--half-sine", "1 g 11 ms z", "--sample-rate", "9e9", "--duration", "99"], "may take up to"),
        (["study", "shock_table", "--vary", "motion/level = Uniform(0.5, 1)", "--variants", "100000000000"], "would take"),
    ],
)  # fmt: skip
def test_commands_say_one_thing_and_exit_2(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert message in printed.err
    assert [path for path in tmp_path.iterdir() if path.name != "runs"] == []


@pytest.mark.parametrize("method", ["sweep", "both"])
def test_a_response_along_which_nothing_moves_is_said(method, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    asked = ["frf", "sdof_shaker", "--response-direction", "x", "--method", method, "--start", "2", "--stop", "4"]
    assert main([*asked, "--rate", "60"]) == 2
    assert "mass does not move along x in this motion" in capsys.readouterr().err


@pytest.mark.parametrize("value", [10**400, -(10**400), float("nan"), "1 g", None, [1.0]])
def test_a_slider_takes_finite_numbers_alone(value):
    sliders = sliders_of(wr.load_system("sdof_shaker"), wr.HalfSine(peak=1.0, duration=0.01, direction="z"))
    with pytest.raises(ValueError, match="the value of 'level' must be a finite number, got "):
        with_slider(sliders, {}, "level", json.loads(json.dumps(value)))


def test_a_cell_at_the_far_end_of_a_sheet_costs_no_memory(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["name", "x [mm]"])
    book.active.append(["m1", 5])
    book.active["XFD1048576"] = 1
    book.save(tmp_path / "far.xlsx")
    with pytest.raises(RecordError, match="row 1048576: .*cells where the header has 2 columns"):
        read_sheet(tmp_path / "far.xlsx", kind="table", needed={"name": "text", "x": "length"}, further={})


WRONG = (
    "None", "3", "2.5", "float('nan')", "True", "'text'", "b'x'", "[]", "[1]", "{}", "{1: 2}", "()", "set()", "object()", "wr",
    "len", "Exception('x')", "10**400", "Silent()", "wr.HalfSine", "motion", "wr.load_system('sdof_shaker')", "1j",
)  # fmt: skip
"""Values of every kind, as a slip of the hand puts one in place of another; the text of `Silent` cannot be had."""

RIGHT = {
    "question": {"'text'"},
    "model": {"'text'"},  # a name that nothing has, found out when the model is read
    "motion": {"motion"},
    "simulate": {"{}"},  # without a duration, found out where it is simulated
    "isolators": {"None", "{}"},
    "combined_travel": {"True"},
    "limits": {"[]", "()"},
    "changes": {"[]", "()"},
    "name": {"'text'"},
    "folder": {"None"},
    "options": {"{}"},
}
"""What of it each attribute of a scenario takes."""

FILE = '''"""Does it hold?"""
import wirerope_mj as wr
class Silent:
    def __repr__(self):
        raise RuntimeError
motion = wr.HalfSine(peak=10.0, duration=0.01, direction="z")
good = {{"question": "?", "model": "sdof_shaker", "motion": motion, "simulate": {{"duration": 0.01}}}}
def scenario(*, level: float = 1.0) -> wr.Scenario:
    return {returned}
'''


@pytest.mark.parametrize("attribute", RIGHT)
def test_a_scenario_of_the_wrong_parts_is_refused_by_name(attribute, tmp_path):
    for number, value in enumerate(WRONG):
        path = tmp_path / f"s{number}.py"
        path.write_text(FILE.format(returned=f"wr.Scenario(**(good | {{{attribute!r}: {value}}}))"))
        made = load_scenario(path)
        if value in RIGHT[attribute]:
            assert isinstance(made.make(), Scenario)
            continue
        with pytest.raises(ModelError, match=rf"s{number}.py, line 9: .*`{attribute}` of a Scenario must"):
            made.make()


@pytest.mark.parametrize("value", WRONG)
def test_what_is_no_scenario_is_refused(value, tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(FILE.format(returned=value))
    with pytest.raises(ModelError, match=r"mine.py: `scenario` must return a wirerope_mj.Scenario, got"):
        load_scenario(path).make()


@pytest.mark.parametrize(
    "name", ["duration", "sample_rate", "timestep", "accuracy", "initial", "callback", "engine", "corners"]
)
def test_arguments_of_the_wrong_kind_are_refused_by_name(name, tmp_path):
    right = {"timestep": {"2.5", "3", "None"}, "accuracy": {"2.5", "3", "None"}, "corners": {"[]", "()", "[1]"}}
    right |= {"duration": {"2.5", "3"}, "sample_rate": {"2.5", "3"}, "initial": {"'text'", "None"}}  # found out when it begins
    for number, value in enumerate(WRONG):
        path = tmp_path / f"a{number}.py"
        path.write_text(FILE.format(returned=f"wr.Scenario(**(good | {{'simulate': {{'duration': 1.0, {name!r}: {value}}}}}))"))
        made = load_scenario(path).make()
        if value in right.get(name, ()):
            continue
        with pytest.raises(ModelError, match=f"`{name}` must be"):
            checked_arguments(made)


@pytest.mark.parametrize(
    ("kind", "phrase", "message"),
    [
        ("trapezoid", "10 g 18 ms rise 1e-308 ms z", "`rise` must be 1e-09 to 1e.09 s"),
        ("struck-deck", "14 Hz 1.5 m/s damping 1e-308 % blow 4 ms z", "it must come to rest within 1e.09 s"),
        ("sweep", "0.5 g 50 to 5 Hz 1e308 oct/min x", "`rate` must be 1e-12 to 1e.06 octaves/min, got 1e.308"),
        ("sweep", "0.5 g 50 to 5 Hz 1e-308 oct/min x", "`rate` must be 1e-12 to 1e.06 octaves/min, got 1e-308"),
        ("unbalance", "engine 20 kg.mm 25 Hz y order 1e308", "`order` must be 1e-12 to 1e.12"),
        (
            "unbalance",
            "engine 20 kg.mm 25 Hz y order 1e6",
            "`order` times `frequency` must be 0 to 1e.06 Hz, got 25000000.0",
        ),
        ("psd", "p.csv " + "a" * 300 + " 1 s z", 'a{200}\\.\\.\\." is neither a number'),
        ("psd", "a" * 300 + ".csv 1 s z", 'there is no file "a{200}'),
    ],
)
def test_phrases_that_the_campaign_found(kind, phrase, message, tmp_path):
    (tmp_path / "p.csv").write_text(PSD)
    with pytest.raises(ValueError, match=message):
        motion_from_phrase(kind, phrase, folder=tmp_path)


def test_a_spectrum_that_is_not_met_is_said_with_its_phrase(tmp_path):
    (tmp_path / "s.csv").write_text("frequency [Hz],acceleration [g]\n2,0.3\n2.5,1e4\n6,0.3\n")
    refused = pytest.raises(ConvergenceError, match='spectrum "s.csv 1 s x damping 5 % seed 1": no motion')
    with pytest.warns(RecordWarning, match="moves an oscillator by 397 m"), refused:
        motion_from_phrase("spectrum", "s.csv 1 s x damping 5 % seed 1", folder=tmp_path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("acceleration/block = --5 g", "limit 'acceleration/block = --5 g': '--5' is no number"),
        ("acceleration/block = 1e400 g", "is too large for a number"),
    ],
)
def test_limits_that_are_no_numbers(text, message):
    with pytest.raises(ValueError, match=message):
        limit_from_text(text)


def test_a_limit_beyond_every_float_in_a_stored_scenario():
    with pytest.raises(
        ValueError, match=r"judge: \[limits\] `acceleration/block` must be a list of finite numbers, got \[1000"
    ):
        read_judge_table({"limits": {"acceleration/block": [10**400]}})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("motion/level = Uniform(0.5, 1, 5)", "too many values; it is written Uniform"),
        ("motion/level = Uniform(0.5, 1, high_=5)", "got an unknown argument 'high_'; it is written Uniform"),
        ("motion/level = Choice(1.5, 9007199254740993)", "9007199254740993 is no number that a computer holds exactly"),
    ],
)
def test_distributions_that_the_campaign_found(text, message):
    with pytest.raises(ValueError, match=message):
        read_vary([text])


def test_a_grid_of_more_values_than_memory_holds():
    with pytest.raises(BudgetError, match="a grid of 9007199254740993 values would take 360 PB of memory"):
        wr.Uniform(0.3, 1.5, points=9007199254740993).listed  # noqa: B018


def test_more_variants_than_a_float_can_count():
    pulse = wr.HalfSine(peak=1.0, duration=0.01, direction="z")
    with pytest.raises(BudgetError, match=r"the inputs of 1e\+300 variants"):
        wr.Study(
            model="sdof_shaker",
            motion=pulse,
            duration=0.1,
            vary={"motion/level": wr.Uniform(0.5, 1.0)},
            variants=10**400,
        )


def test_what_is_no_isolator_is_refused_by_name():
    with pytest.raises(ModelError, match=r"`isolators\['sdof_36hz'\]` must be an Isolator, got \[1\]"):
        wr.load_system("sdof_shaker", isolators={"sdof_36hz": [1]})


@pytest.mark.parametrize("psd", [3, None, "text", {1: 2}])
def test_a_density_that_is_no_list_of_points(psd):
    with pytest.raises(ValueError, match="`psd` must be pairs of frequency"):
        wr.RandomVibration(psd=psd, duration=1.0, seed=1, direction="z")


def test_a_fatigue_curve_steeper_or_flatter_than_any():
    cycles = rainflow_cycles([0.0, 1e-6, 0.0, 2e-6, 0.0])
    assert 0.0 < cycles.damage(50.0) < 1e-280
    for exponent in (1000.0, 0.1):
        with pytest.raises(ValueError, match=f"`exponent` of a fatigue curve must be from 1 to 50, got {exponent:g}"):
            cycles.damage(exponent)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["select", "worksheet", "--mass", "100", "--mounts", "4", "--velocity", "2", "--disturbance-rpm", "1e308"],
            "`disturbance` must be",
        ),
        (
            ["isolators", "estimate", "--height", "1e308", "--width", "105", "--rope", "12.7", "--loops", "8"],
            "`height` must be",
        ),
        (["loops", "x" * 300], "x..."),
    ],
)
def test_commands_that_the_campaign_found(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (("sampling", "method"), None, r"\[sampling\] `method` is missing; needed: method, variants, seed"),
        (("vary", 0, "low"), None, "`vary.0`: missing a required argument: 'low'"),
        (("vary", 0, "kind"), 3, "`vary.0.kind` must be one of"),
        (("vary", 0, "name"), 2.5, "`vary.0` must be a table with the `name`"),
        (("vary", 0, "relative"), "yes", "`vary.0.relative` must be true or false"),
        (("model",), True, "`model` must be a table, got True"),
        (("model", "file"), None, r"\[model\] `file` is missing"),
        (("model", "file"), "a" * 400, "the model file 'a{199}\\.\\.\\. is not in this folder"),
        (("simulate", "duration"), None, r"\[simulate\] `duration` is missing"),
        (("simulate", "duration"), [], "no study can be made of it: `duration` must be a finite number"),
        (("motions", 0, "kind"), "song", "no study can be made of it: Unknown kind of motion 'song'"),
    ],
)
def test_a_study_whose_digest_fits_is_checked_all_the_same(place, value, message, tmp_path):
    pulse = wr.HalfSine(peak=10.0, duration=0.01, direction="z")
    study = wr.Study(
        model="sdof_shaker",
        motion=pulse,
        duration=0.02,
        timestep=1e-3,
        vary={"motion/level": wr.Uniform(0.5, 1.5)},
        variants=2,
    )
    content = write_inputs(study, tmp_path, "peaks", None)
    holder = content
    for key in place[:-1]:
        holder = holder[key]
    if value is None:
        del holder[place[-1]]
    else:
        holder[place[-1]] = value
    content["id"] = identity(content)
    (tmp_path / STUDY).write_text(tomli_w.dumps(content), encoding="utf-8")
    with pytest.raises(RecordError, match=message):
        wr.load_study(tmp_path).study  # noqa: B018  # it is made when it is looked at


def test_loops_and_orders_beyond_every_machine():
    with pytest.raises(ValueError, match="`loops` must be at most 1000"):
        estimate_loop(height=0.089, width=0.105, rope=0.0127, loops=10**15)
    with pytest.raises(ValueError, match="`--orders` must be at most 1e.06, got 1e.308"):
        order_bands([1e308], [1e9 / 1e6, 2.0])


@pytest.mark.parametrize("again", ["stop_4 pad_4", "pad_4 stop_4"])
def test_a_pair_of_geoms_that_stands_there_twice(again):
    text = (models_folder() / "shock_table_contacts.xml").read_text(encoding="utf-8")
    one, other = again.split()
    text = text.replace("</contact>", f'<pair class="stop" geom1="{one}" geom2="{other}"/></contact>')
    with pytest.raises(ModelError, match="the <pair> of geoms 'stop_4' and 'pad_4' stands there twice"):
        wr.load_system(text)


def test_a_run_of_no_time_is_refused_and_one_of_a_single_sample_is_written(tmp_path):
    motion = Sine(frequency=5.0, acceleration=1.0, direction="z")
    with pytest.raises(ValueError, match="`duration` must be at least 1e-12 s, got 1e-300"):
        wr.simulate(wr.load_system("sdof_shaker"), motion, duration=1e-300)
    short = Scenario("?", "sdof_shaker", motion, {"duration": 0.01, "sample_rate": 1e-9}, name="short")
    with pytest.warns(AccuracyWarning, match="samples a second"):
        run_scenario(short, tmp_path / "run")
    assert (tmp_path / "run" / "report.html").exists()


@pytest.mark.parametrize(
    ("edited", "message"),
    [(('damping="0"', 'damping="1e200"'), "its `damping` is 1e.200; every number"), (("-9.80665", "-1e6"), "beyond 100000")],
)
def test_a_model_with_numbers_beyond_computing_is_refused(edited, message, tmp_path):
    text = (models_folder() / "sdof_shaker.xml").read_text(encoding="utf-8")
    text = text.replace('<joint name="mass_z"', '<joint damping="0" name="mass_z"')
    with pytest.raises(ModelError, match=message):
        wr.load_system(text.replace(*edited), isolators=wr.load_system("sdof_shaker").isolators)
