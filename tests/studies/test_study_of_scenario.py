import re
import textwrap
from types import SimpleNamespace

import numpy as np
import pytest
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.cli import study as command
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.runs.study import what_can_vary, write_worst
from wirerope_mj.studies.results.measure import row_of
from wirerope_mj.studies.vary.vary_option import available_lines, read_vary
from wirerope_mj.views.recording import program, viewer

SCENARIO_FILE = textwrap.dedent('''
    """Does a mass on one mount stand a half-sine?"""

    import wirerope_mj as wr
    from wirerope_mj.mounts.isolator import Limits, Travel
    from house import sdof_text


    def scenario(*, peak: float = 60.0, seed: int = 3, callback: str = "native") -> wr.Scenario:
        """Return the shock.

        Args:
            peak: of the half-sine [m/s^2].
            seed: of nothing.
            callback: native or python.
        """
        law = wr.BoucWen(alpha=2e4, beta=30.0, gamma=10.0, n=1.0, k=5e3)
        limits = Limits(travel=Travel(compression=0.008, tension=0.008))
        return wr.Scenario(
            question=__doc__ or "",
            model=sdof_text(),
            isolators={"a": wr.Isolator(name="a", axial=law, limits=limits)},
            motion=wr.HalfSine(peak=peak, duration=0.011, direction="z"),
            simulate={"duration": 0.1, "timestep": 1e-3, "sample_rate": 500.0, "callback": callback},
        )
''').lstrip()


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "shock.py"
    path.write_text(SCENARIO_FILE, encoding="utf-8")
    return path


def scenario(motion=None, **changes):
    """Return a scenario whose system is itself a variant, at rest as modelled."""
    isolator = wr.Isolator(name="a", axial=wr.BoucWen(alpha=2e4, beta=30.0, gamma=10.0, n=1.0, k=5e3))
    arguments = {"duration": 0.1, "timestep": 5e-4, "sample_rate": 500.0, "initial": "unloaded", **changes}
    return wr.Scenario(
        question="Does it stand?",
        model=sdof_text(gravity=9.80665),
        motion=motion or wr.HalfSine(peak=60.0, duration=0.011, direction="z"),
        simulate={key: value for key, value in arguments.items() if value is not None},
        isolators={"a": isolator},
        name="shock",
        changes=[wr.Changes(masses={"mass": 1.5})],
    )


def test_a_variant_with_nothing_changed_is_the_scenario_bit_for_bit(tmp_path):
    asked = scenario()
    study = wr.study_of(asked, vary={"motion/level": wr.Choice(1.0, 1.2)}, sampling="grid")
    system = wr.varied(wr.load_system(asked.model, isolators=asked.isolators), masses={"mass": 1.5})
    alone = wr.simulate(system, asked.motion, **asked.simulate)
    row = row_of(study.run(tmp_path / "study", workers=1).table, 0)
    assert row["acceleration/mass"] == alone.peaks.bodies["mass"].acceleration.value
    assert row["force/m1"] == alone.peaks.mounts["m1"].force.value
    assert (study.name, study.question, study.initial) == ("shock", "Does it stand?", "unloaded")


def test_a_study_of_a_variant_stands_in_its_folder_with_its_changes(tmp_path):
    vary = {"body/mass/mass": wr.Uniform(0.9, 1.1, relative=True)}
    result = wr.study_of(scenario(), vary=vary, variants=3).run(tmp_path / "study", workers=1)
    again = wr.load_study(tmp_path / "study").study
    assert again.base.model.body("mass").mass[0] == 1.5 * 3.5
    assert again.response(2).peaks.mounts["m1"].force.value == row_of(result.table, 2)["force/m1"]


def test_the_step_of_the_scenario_may_be_replaced_and_variants_have_a_default():
    vary = {"motion/level": wr.Uniform(0.5, 1.5)}
    study = wr.study_of(scenario(), vary=vary, accuracy=1e-2)
    assert (study.size, study.timestep, study.accuracy) == (256, None, 1e-2)
    assert wr.study_of(scenario(), vary=vary, timestep=1e-3).work.timestep == 1e-3
    assert wr.study_of(scenario(), vary=vary).work.timestep == 5e-4


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"callback": "python"}, "'shock' asks for the 'python' callback"),
        ({"corners": [0.02]}, "cannot take over `corners`"),
        ({"duration": None}, "must say the duration"),
        ({"initial": "hot"}, "`initial` must be one of 'settled'"),
    ],
)
def test_what_a_study_cannot_take_over_is_refused(changes, message):
    with pytest.raises((ValueError, wr.ModelError), match=message):
        wr.study_of(scenario(**changes), vary={"motion/level": wr.Uniform(0.5, 1.5)})


def test_a_scenario_file_takes_its_options_and_a_scenario_has_none(file):
    study = wr.study_of(file, options={"peak": 90.0}, vary={"motion/level": wr.Uniform(0.5, 1.5)}, variants=2)
    assert study.motions[0].peak == 90.0
    with pytest.raises(ValueError, match="made already"):
        wr.study_of(scenario(), options={"peak": 1.0}, vary={"motion/level": wr.Uniform(0.5, 1.5)})


@pytest.mark.parametrize(
    ("words", "distribution"),
    [
        ("Normal(1, 0.1, relative, each)", wr.Normal(1.0, 0.1, relative=True, each=True)),
        ("Normal(0, 5e-3, low=-0.01, high = 0.01)", wr.Normal(0.0, 5e-3, low=-0.01, high=0.01)),
        ("Uniform(-1, 2, points=5)", wr.Uniform(-1.0, 2.0, points=5)),
        ("Uniform(0.5, 1.5, relative=True)", wr.Uniform(0.5, 1.5, relative=True)),
        ("Choice('', 'm1')", wr.Choice("", "m1")),
        ("Choice(True, False, each)", wr.Choice(True, False, each=True)),
        ("Choice([1, -2.5])", wr.Choice(1, -2.5)),
        ("Isotropic(low=0)", wr.Isotropic(low=0.0)),
        ("Specimens", wr.Specimens()),
        ("Specimens(each=False)", wr.Specimens(each=False)),
    ],
)
def test_a_distribution_is_read_as_it_is_written_in_python(words, distribution):
    assert read_vary([f" mount/m1/axial/k={words} "]) == {"mount/m1/axial/k": distribution}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a", 'must be written like "mount/m'),
        ("a = ", 'must be written like "mount/m'),
        ("= Normal(1, 2)", 'must be written like "mount/m'),
        (
            "a = Gauss(1, 2)",
            r"'a': 'Gauss\(1, 2\)' is no distribution; there are Normal\(mean, deviation, relative, each",
        ),
        ("a = wr.Normal(1, 2)", "is no distribution"),
        ("a = Uniform(nan, 1.5)", "'a': numbers must be finite, got nan"),
        ("a = Uniform(-inf, 1.5)", "'a': numbers must be finite, got -inf"),
        ("a = Isotropic(each)", "Isotropic has no flag 'each'; it has none"),
        ("a = 5", "'a': '5' is no distribution"),
        ("a = Normal(1", r"'Normal\(1' cannot be read"),
        ("a = Normal(1, 2); b", "cannot be read"),
        ("a = Normal(1)", "missing a required argument: 'deviation'; it is written Normal"),
        ("a = Normal(1, 2, sigma=3)", "unknown argument 'sigma'"),
        ("a = Normal(1, 2, cut)", "Normal has no flag 'cut'; it has relative and each"),
        ("a = Normal(1, 2, relative='yes')", "`relative` must be True or False, got 'yes'"),
        ("a = Uniform(2, 1)", "`low` must be less than `high`"),
        ("a = Normal(1, __import__('os').getpid())", r"\"__import__\('os'\).getpid\(\)\" must be a number"),
        ("a = Normal(1, *[2])", "must be a number"),
        ("a = Normal(1, 2, **{'each': True})", "unknown argument"),
    ],
)
def test_what_is_no_distribution_says_why_and_what_there_is(text, message):
    with pytest.raises(ValueError, match=message):
        read_vary([text])


def test_a_quantity_that_is_said_twice_is_refused():
    with pytest.raises(ValueError, match="'a' is said twice"):
        read_vary(["a = Normal(1, 2)", "a=Uniform(1, 2)"])


def test_what_can_vary_names_mounts_parameters_bodies_and_directions():
    text = what_can_vary(load_scenario("cabinet_shock").make())
    isolator = wr.load_system(models_folder() / "cabinet.xml").mounts["m01"].isolator
    for words in (
        "mounts m01, m02,",
        "mount/NAME/axial/PARAMETER",
        "mount/NAME/fitted",
        "mount/m01,m05,-m04/position_shift/x",
        f"alpha = {isolator.axial.laws[0].alpha:.4g}",
        "rack: 850 kg, centre (",
        "motion/azimuth",
    ):
        assert words in text
    law = wr.BoucWen(alpha=2e4, beta=30.0, gamma=0.0, n=1.0, k=5e3)
    system = wr.load_system(sdof_text(), isolators={"a": wr.Isolator(name="a", axial=law)})
    (line,) = [line for line in available_lines(system, scenario().motion) if "PARAMETER" in line]
    assert line.endswith("gamma = 0, n = 1, k = 5000 (what is 0 takes no factors)")
    three = what_can_vary(load_scenario("floating_floor_shock").make())  # along x, y and z at once: no line to turn
    assert "motion/level" in three
    assert "motion/azimuth" not in three
    assert "motion/azimuth" not in what_can_vary(scenario())  # its base can only be driven along z


@pytest.fixture
def shown(monkeypatch):
    """Return the recordings that are shown, as if there were a screen."""
    opened = []
    monkeypatch.setattr(program, "has_display", lambda: True)
    monkeypatch.setattr(viewer, "show", opened.append)
    terminal, none = SimpleNamespace(isatty=lambda: True), SimpleNamespace(isatty=lambda: False)
    monkeypatch.setattr(command, "sys", SimpleNamespace(stdout=terminal, stderr=none))
    return opened


@pytest.mark.slow
def test_the_command_makes_a_study_of_a_scenario_and_opens_its_worst(file, tmp_path, capsys, shown):
    folder = tmp_path / "out"
    vary = ["--vary", "mount/m1/axial/alpha = Normal(1, 0.2, relative)", "--vary", "motion/level = Uniform(0.5, 1.5)"]
    how = ["--peak", "90", "--variants", "16", "--study-seed", "2", "--workers", "1", "--open-worst", "2"]
    assert main(["study", str(file), *vary, *how, "--out", str(folder), "--all"]) == 0
    result = wr.load_study(folder)
    table = result.table
    assert table.num_rows == 16
    assert result.study.seed == 2
    levels = np.asarray(table["motion/level"])
    # Sobol points are balanced: one in each sixteenth.
    assert np.sort(np.floor(16.0 * (levels - 0.5))).tolist() == list(range(16))
    assert result.study.motions[0].peak == 90.0
    out = capsys.readouterr().out
    assert "motion/level" in out
    assert f"wirerope show {folder}/worst/worst.rrd" in out
    assert shown == [folder / "worst" / "worst.rrd"]


def test_a_worst_run_says_its_inputs_in_scenario_and_report(tmp_path):
    study = wr.study_of(scenario(), vary={"motion/level": wr.Choice(1.0, 1.25)}, sampling="grid")
    (folder,) = write_worst(study.run(tmp_path / "study", workers=1), "acceleration", 1)
    written = (folder / "scenario.toml").read_text(encoding="utf-8")
    assert "variant 1 of the study shock, which has 2" in written
    assert '"motion/level" = 1.25' in written
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "variant 1 of the study shock, which has 2" in page
    assert "motion/level" in page


@pytest.mark.slow
def test_a_worst_run_among_several_records_has_the_peaks_of_the_table(tmp_path):
    # Corners at 11 ms and at 7.3 ms: alone, either motion would take other steps.
    pulses = [
        wr.HalfSine(peak=60.0, duration=0.011, direction="z"),
        wr.HalfSine(peak=80.0, duration=0.0073, direction="z"),
    ]
    study = wr.Study(
        model=sdof_text(), isolators=scenario().isolators, motions=pulses, duration=0.1, timestep=1e-3, sampling="grid",
        vary={"motion/record": wr.Choice(0, 1)},
    )  # fmt: skip
    result = study.run(tmp_path / "study", workers=1)
    folders = write_worst(result, "acceleration", 2)[1:]
    for folder in folders:
        row = row_of(result.table, int(folder.name.split("-")[1]))
        peaks = wr.load_response(folder).peaks
        assert peaks.bodies["mass"].acceleration.value == row["acceleration/mass"]  # the same steps: bit for bit
        assert peaks.mounts["m1"].force.value == row["force/m1"]
    assert main(["replay", str(folders[0])]) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "nothing varies yet. In shock can vary:\n  mounts m1:\n    mount/NAME/axial/PARAMETER"),
        (["--vary", "motion/level"], "`--vary`: what varies must be written like"),
        (["--vary", "mount/x/axial/alpha = Uniform(1, 2)"], "there is no mount 'x'. There is: m1."),
        (["--vary", "motion/level = Uniform(1, 2)", "--sampling", "grid"], "give a Choice"),
        (["--vary", "motion/level = Uniform(1, 2)", "--callback", "python"], "asks for the 'python' callback"),
        (
            ["--vary", "mount/m1/axial/alpha = Normal(1, 0.1)", "--vary", "body/mass/mass = Uniform(-2, -1)"],
            "wirerope: warning: mount/m1/axial/alpha is from 0.",
        ),
        (["--vary", "motion/level = Uniform(1, 2)", "--variants", "0"], "`variants` must be an integer >= 1"),
    ],
)
def test_bad_input_is_one_message_and_writes_nothing(file, tmp_path, arguments, message, capsys):
    assert main(["study", str(file), *arguments, "--out", str(tmp_path / "no")]) == 2
    err = capsys.readouterr().err
    assert re.search(re.escape(message), err)
    assert "Traceback" not in err
    assert not (tmp_path / "no").exists()


def test_help_lists_the_scenario_s_options_and_says_how_something_varies(file, capsys):
    assert main(["study", str(file), "--help"]) == 0
    out = " ".join(capsys.readouterr().out.replace("│", "").split())
    for words in (
        "--peak",
        "--seed",
        "--study-seed",
        "--vary",
        "without it all that can vary is listed",
        "--open-worst",
    ):
        assert words in out
