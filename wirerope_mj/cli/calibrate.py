"""`wirerope calibrate`: measured tests and a model to the values that they tell, a page, and a calibrated model."""

from pathlib import Path
from typing import Literal

from wirerope_mj.cli.options import All, Force, Repeated, RepeatedPaths, Texts
from wirerope_mj.cli.tables import say_where
from wirerope_mj.content.calibration import calibration_content
from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.engine.simulation.simulate import duration_of
from wirerope_mj.engine.system import load_system
from wirerope_mj.foundation.arguments import integer
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import check_folder
from wirerope_mj.foundation.resources import model_source
from wirerope_mj.motions import BaseMotion
from wirerope_mj.motions.records.measured import load_measured, parse_channel
from wirerope_mj.motions.registry import motion_from_words
from wirerope_mj.mounts.isolator import AXES
from wirerope_mj.mounts.test_rig import read_cyclic_test
from wirerope_mj.runs.calibration import KIND, MARKS, write_calibration
from wirerope_mj.runs.measured import read_map, tests_of
from wirerope_mj.runs.scenario_file import is_run, scenario_content, system_and_motion
from wirerope_mj.studies.calibration import LoopTest, MeasuredTest
from wirerope_mj.studies.calibration import calibrate as calibrated
from wirerope_mj.studies.calibration.forward import Test
from wirerope_mj.studies.calibration.predict import predict as predicted
from wirerope_mj.studies.calibration.rig_tests import read_frequency_tests
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.results.varied import limit_of_text
from wirerope_mj.studies.vary.vary_option import EXAMPLE
from wirerope_mj.views.terminal import show_result

NOT_CONVERGED = 1  # Exit code of a fit that did not converge


def calibrate(
    model: str,
    *,
    test: RepeatedPaths = None,
    map: Texts = None,
    vary: Repeated = None,
    out: Path,
    frequency_response: Repeated = None,
    loops: Repeated = None,
    predict: Repeated = None,
    limit: Repeated = None,
    baseline: Literal["none", "rest", "mean"] = "none",
    initial: Literal["settled", "relaxed", "unloaded"] | None = None,
    start: float = 0.0,
    residuals: Literal["time", "srs", "spectrum"] = "time",
    draws: int = 1000,
    seed: int = 1,
    every: All = False,
    force: Force = False,
) -> int:
    """Bring a model to measured tests: the values that they tell and how well, what they do not tell, a page, a new model.

    wirerope calibrate cabinet --test drop1.csv --test drop2.csv --map "A0=base z g" "A1=body/rack z g"
    --vary "mount/*/stiffness = Uniform(0.7, 1.4)" --vary "body/rack/mass = Normal(1, 0.03, relative)" --out calibrated

    What varies is named as in a study, with what is known before as its distribution; faults of the measuring chain are
    channel/NAME/gain, channel/NAME/delay [s] and channel/NAME/offset [SI]. The folder holds the page, the draws, and the model
    with isolators whose [spread] is what the tests leave open: a study with "mount/*/spread = Specimens" draws from it.

    Args:
        model: path of a model, the name of one that ships with the package, or the folder of a run.
        test: file of a test: CSV, MATLAB, XLSX, Parquet or a universal file, one or several. By default the tests that the
            run was compared with, as they stand in its folder.
        map: what each column of the tests is, COLUMN=PHRASE, such as "A1=body/rack z g", or a TOML file. Tests whose base was
            not measured move as the run does.
        vary: what is to be found, with its prior: "mount/*/stiffness = Uniform(0.7, 1.4)".
        out: folder of the calibration.
        frequency_response: FILE=PHRASE, such as "sweeps.csv=body/rack z": a CSV file with the columns frequency [Hz], level [g]
            and transmissibility, of one level or several.
        loops: FILE=PHRASE, such as "rig.csv=mount/m1 axial": cyclic tests of a mount's isolator, as `wirerope identify` reads
            them.
        predict: another motion that is predicted with bands, its kind first: "half-sine 15 g 11 ms z".
        limit: on a measure of the predictions, "acceleration/rack = 15 g": with which probability is it exceeded?
        baseline: what is taken off the channels: none, their level at rest, or their mean.
        initial: state in which the tests began: settled, relaxed or unloaded; by default that of the run, or settled.
        start: instant of the run at which the tests' first samples were taken [s].
        residuals: what of the channels is compared: their histories, or logarithms of their shock response or amplitude
            spectra.
        draws: of the posterior.
        seed: of design and sampler.
    """
    kept = tests_of(Path(model)) if is_run(model) and not (test or frequency_response or loops) else ()
    if not (test or frequency_response or loops or kept):
        usage = "wirerope calibrate MODEL --test TEST.csv --map COLUMN=PHRASE .. --vary .. --out FOLDER"
        raise ValueError(f"name the tests: {usage}")
    if not vary:
        raise ValueError(f"`--vary` must say what is to be found, with its prior, such as {EXAMPLE!r}, got none.")
    check_folder(out, force=force, kind=KIND, marks=MARKS)
    if is_run(model):
        motion: BaseMotion | None
        stored = scenario_content(Path(model))
        system, motion = system_and_motion(Path(model), stored)
        began = initial or stored["simulate"].get("initial", "settled")
    else:
        system, motion = load_system(model_source(model, folder=None, asker="a calibration")), None
        began = initial or "settled"
    motions = [motion_from_words(phrase) for phrase in predict or ()]
    limits = [limit_of_text(text, measure_names(system)) for text in limit or ()]
    if limits and not motions:
        example = "--predict 'half-sine 15 g 11 ms z'"
        raise ValueError(f"`--limit` is on a prediction; say of which motion, for instance {example}.")
    if test and not map:
        raise ValueError('`--map` must say what the columns of the tests are, such as "A1=body/rack z g", got none.')
    settings: Entries = {"baseline": baseline, "start": start} | (read_map(map) if map else {})
    measured = [load_measured(file, **settings) for file in test] if test else list(kept)
    moved = any(channel.subject == "base" for one in measured for channel in one.channels)
    if measured and not moved and motion is None:
        message = "`--map` names no column of the base, and a model alone has no motion; map one, such as A0=base z g."
        raise ValueError(message)
    tests: list[Test] = [MeasuredTest.of(one, None if moved else motion, initial=began) for one in measured]
    for text in frequency_response or ():
        file, sign, phrase = text.rpartition("=")
        if not sign:
            example = "'sweeps.csv=body/rack z'"
            raise ValueError(f"`--frequency-response` must be FILE=PHRASE, such as {example}, got {text!r}.")
        tests += read_frequency_tests(Path(file), phrase)
    tests += [_loop_test(text) for text in loops or ()]
    draws = integer("--draws", draws, least=100)
    with share_bar("calibrating", "% of the runs", enabled=True) as update:
        result = calibrated(
            system, tests, vary=vary, residuals=residuals, draws=draws, seed=seed,
            progress=lambda fraction: update(fraction, 100.0 * fraction),
        )  # fmt: skip
    content = calibration_content(
        result,
        title=f"{Path(model).stem}, calibrated from {', '.join(one.name for one in tests)}",
        sources=[
            *(f"{one.path.name}: {', '.join(channel.key for channel in one.channels)}" for one in measured),
            *(f"frequency response {text}" for text in frequency_response or ()),
            *(f"loops {text}" for text in loops or ()),
        ],
        warnings=[text for one in measured for text in one.warnings],
        predictions=[
            (predicted(result, one, duration=duration_of(one, None, system), initial=began), limits) for one in motions
        ],
    )  # fmt: skip
    write_calibration(result, content, out, force=force)
    others = [name for name in content.sections_of("summary") if name not in ("values", "prediction")]
    show_result(content, "values", "prediction", "answer", others=others, every=every)
    say_where(out, every=every)
    return 0 if result.fit.converged else NOT_CONVERGED


def _loop_test(text: str) -> Test:
    """Read FILE=PHRASE, cyclic tests of a mount's isolator along an axis, as a test to calibrate by."""
    file, sign, phrase = text.rpartition("=")
    said = parse_channel(file, phrase) if sign else None
    if said is None or not said.subject.startswith("mount/"):
        raise ValueError(f"`--loops` must be FILE=PHRASE, such as 'rig.csv=mount/m1 axial', got {text!r}.")
    axis = AXES["xyz".index(said.axis)]
    return LoopTest(name=Path(file).stem, mount=said.subject[6:], axis=axis, loops=read_cyclic_test(Path(file)))
