"""A study that runs: the same table whatever computes it and however often it is stopped."""

import os
import re
import shutil
import signal
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
from kills import interruptible, wait_until_ended
from table_study import PULSE, VARY, G, rows, table_study

import wirerope_mj as wr
from wirerope_mj.engine.response.peaks import MountPeaks, Peak, Peaks
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.studies import folder as study_folder
from wirerope_mj.studies import inputs_file
from wirerope_mj.studies.engines import local
from wirerope_mj.studies.engines.compute import Accident, compute, failure_message
from wirerope_mj.studies.measures import measures
from wirerope_mj.studies.study import chunk_size, chunks

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps


def peak_of(**extremes):
    nothing = np.zeros(3)
    given = {"value": 0.0, "time": 0.0, "vector": nothing, "minimum_time": nothing, "maximum_time": nothing}
    return Peak(**{**given, "minimum": nothing, "maximum": nothing, **extremes})


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """A study left alone, in this process."""
    return table_study().run(tmp_path_factory.mktemp("study") / "alone", workers=1)


def test_the_table_holds_inputs_measures_and_status(alone):
    table, study = alone.table, table_study()
    assert table.column_names[:4] == ["variant", *VARY]
    assert table.column_names[-2:] == ["status", "message"]
    assert table.select(study.table().column_names).equals(study.table())
    assert set(table["status"].to_pylist()) == {"done"}
    assert alone.failed == {}
    assert alone.message == "40 variants, none failed."
    mount = study.base.mounts["m1"].isolator.limits.travel
    share = np.asarray(table["deflection/m1/compression"]) / mount.compression
    assert (np.asarray(table["travel/m1"]) >= share).all()
    np.testing.assert_array_equal(np.asarray(table["travel"]), np.asarray(table["travel/m1"]))
    np.testing.assert_array_equal(np.asarray(table["acceleration"]), np.asarray(table["acceleration/block"]))
    assert "acceleration/table" not in table.column_names  # the base's own
    # the stronger the pulse the larger the peak: by far the largest influence here
    level, peak = np.asarray(table["motion/level"]), np.asarray(table["acceleration"])
    assert np.corrcoef(level, peak)[0, 1] > 0.9


def test_measures_are_those_of_the_peaks():
    system = wr.load_system(wr.Scenario("", "shock_table.xml", PULSE, {}).model_source())
    still = wr.simulate(system, PULSE, duration=0.001, timestep=1e-3).peaks
    deflection = peak_of(minimum=np.array([-0.01, -0.002, -0.03]), maximum=np.array([0.02, 0.001, 0.004]))
    force = peak_of(value=123.0)
    found = measures(
        system,
        Peaks(
            bodies=still.bodies,
            points=still.points,
            mounts=still.mounts | {"m1": MountPeaks(deflection=deflection, force=force)},
        ),
        None,
    )
    rated = system.mounts["m1"].isolator.limits.travel
    assert [found[f"deflection/m1/{way}"] for way in ("compression", "tension", "shear", "roll")] == [
        0.03,
        0.004,
        0.002,
        0.02,
    ]
    assert found["travel"] == max(0.03 / rated.compression, 0.002 / rated.shear, 0.02 / rated.roll)
    assert found["force/m1"] == 123.0


@pytest.mark.quick
def test_every_variant_is_what_it_is_alone_bit_for_bit(alone):
    study = table_study()
    for number in (0, 17, 39):
        response = study.response(number)
        row = alone.table.slice(number, 1).to_pylist()[0]
        found = measures(study.system(number), response.peaks, response.initial_state)
        assert {key: row[key] for key in found} == pytest.approx(found, rel=0.0, abs=0.0, nan_ok=True)


def test_a_floor_whose_everything_varies_is_what_each_variant_is_alone(tmp_path):
    vary = {
        "mount/m*/axial/alpha": wr.Normal(1.0, 0.1, relative=True, each=True),
        "mount/h*/failed": wr.Choice("", "h1"), "body/floor/centre_shift/x": wr.Normal(0.0, 0.02),
        "mount/m01/position_shift/z": wr.Normal(0.0, 0.001), "motion/record": wr.Choice(0, 1),
        "motion/azimuth": wr.Uniform(0.0, 360.0), "motion/elevation": wr.Uniform(-90.0, 90.0),
    }  # fmt: skip
    motions = [PULSE, wr.HalfSine(peak=5.0 * G, duration=0.02, direction="z", start=0.0033)]
    given = {"model": "floating_floor.xml", "vary": vary, "motion": None, "motions": motions, "variants": 6}
    study = table_study(**given, timestep=5e-4)
    result = study.run(tmp_path / "floor", workers=1)
    assert result.failed == {}
    for number in (1, 4):
        response = study.response(number)
        found = measures(study.system(number), response.peaks, response.initial_state)
        row = result.table.slice(number, 1).to_pylist()[0]
        assert {key: row[key] for key in found} == pytest.approx(found, rel=0.0, abs=0.0, nan_ok=True)


@pytest.mark.slow
def test_two_workers_find_the_same_table_as_one(alone, tmp_path):
    result = table_study().run(tmp_path / "two", workers=2)
    assert result.table.schema == alone.table.schema
    assert rows(result.table) == rows(alone.table)


@pytest.mark.quick
def test_the_table_does_not_depend_on_which_variants_share_a_chunk(alone):
    study = table_study()
    first, *_ = chunks(study, [4])
    single = [compute(study.work, type(first)(number=0, rows=[row])).table for row in first.rows]
    together = rows(compute(study.work, first).table)
    assert [row for table in single for row in rows(table)] == together
    assert together == rows(alone.table)[4 * chunk_size(study) :][: len(first.rows)]


def test_a_study_is_made_again_from_its_folder_alone(alone, tmp_path):
    shutil.copytree(alone.folder, tmp_path / "elsewhere")
    loaded = wr.load_study(tmp_path / "elsewhere")
    assert loaded.study.table().equals(table_study().table())
    again = loaded.study.run(tmp_path / "again", workers=1)
    assert rows(again.table) == rows(alone.table)
    assert again.inputs["id"] == alone.inputs["id"]


def test_an_interrupted_study_keeps_its_parts_and_goes_on_with_the_missing_ones(alone, tmp_path, monkeypatch):
    computed = []

    def interrupted(work, chunk):
        if len(computed) == 5:
            raise KeyboardInterrupt
        computed.append(chunk.number)
        return compute(work, chunk)

    monkeypatch.setattr(local, "compute", interrupted)
    with pytest.raises(KeyboardInterrupt):
        table_study().run(tmp_path / "study", workers=1)
    half = wr.load_study(tmp_path / "study")
    assert not half.complete
    assert half.table.num_rows == 5 * chunk_size(table_study())
    assert "go on with it with --resume" in half.message
    monkeypatch.setattr(local, "compute", lambda work, chunk: computed.append(chunk.number) or compute(work, chunk))
    result = table_study().run(tmp_path / "study", workers=1, resume=True)
    assert computed == list(range(14))
    assert rows(result.table) == rows(alone.table)


@pytest.mark.quick
def test_a_study_that_is_there_is_neither_overwritten_nor_mistaken_for_another(alone, tmp_path, monkeypatch):
    folder = tmp_path / "study"
    shutil.copytree(alone.folder, folder)
    with pytest.raises(wr.RecordError, match="there is a study already. Go on with it with --resume"):
        table_study().run(folder)
    with pytest.raises(wr.RecordError, match=r"of another study \(sampling.seed is 1 there and 2 here\); nothing in it"):
        table_study(seed=2).run(folder, resume=True)
    with pytest.raises(wr.RecordError, match="folder of another study .*simulate.duration is 0.05 there and 0.06 here"):
        table_study(duration=0.06).run(folder, resume=True)
    asked = table_study(question="Which mount?", name="tolerances")
    assert asked.run(folder, resume=True).message == alone.message  # nothing is missing
    here = inputs_file.versions()
    complete = (folder / study_folder.TABLE).read_bytes()
    for name, message in (
        ("code", "the code of wirerope-mj has changed since this study began, and one table would hold rows of both"),
        ("mujoco", f"this study began with mujoco {here['mujoco']} and would go on with 99.0: one table"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(inputs_file, "versions", lambda name=name: {**here, name: "99.0"})
            assert table_study().run(folder, resume=True).message == alone.message  # of one table, nothing is mixed
            (folder / study_folder.TABLE).unlink()
            with pytest.raises(wr.RecordError, match=f"{message}.* Nothing in it was touched.*--force"):
                table_study().run(folder, resume=True)
            (folder / study_folder.TABLE).write_bytes(complete)
    assert rows(table_study(seed=2).run(folder, force=True, workers=1).table) != rows(alone.table)


def test_a_folder_of_something_else_is_not_touched(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    for choice in ({"force": True}, {"resume": True}):
        with pytest.raises(wr.RecordError, match="exists and is not a study; nothing in it was touched"):
            table_study().run(tmp_path, **choice)
    with pytest.raises(wr.RecordError, match="this is not a study; there is no study.toml here"):
        wr.load_study(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_a_changed_study_file_is_noticed(alone, tmp_path):
    shutil.copytree(alone.folder, tmp_path / "study")
    path = tmp_path / "study" / study_folder.STUDY
    path.write_text(path.read_text().replace("seed = 1", "seed = 2"))
    assert tomllib.loads(path.read_text())["sampling"]["seed"] == 2
    with pytest.raises(wr.RecordError, match="was changed after it had been written"):
        wr.load_study(tmp_path / "study")


@pytest.mark.quick
def test_variants_that_fail_say_why_and_do_not_stop_the_rest(tmp_path):
    """The only mount of the table fails: nothing holds the block, and there is no equilibrium to start from."""
    vary = {**VARY, "mount/m1/failed": wr.Choice(False, True)}
    result = table_study(vary=vary, variants=12).run(tmp_path / "study", workers=1)
    gone = np.asarray(result.table["mount/m1/failed"])
    assert 0 < gone.sum() < 12
    assert sorted(result.failed) == np.flatnonzero(gone).tolist()
    assert all("no equilibrium was found" in message for message in result.failed.values())
    assert (np.isnan(np.asarray(result.table["acceleration"])) == gone).all()
    assert f"12 variants, {gone.sum()} failed; variant {np.argmax(gone)}: no equilibrium" in result.message


def test_workers_that_cannot_start_end_the_study_with_one_message(tmp_path, monkeypatch):
    monkeypatch.setattr(local.sys, "executable", shutil.which("false"))
    with pytest.raises(wr.SimulationError, match=r"a worker process could not start: it died \(exit status 1\)"):
        table_study().run(tmp_path / "study", workers=2)
    assert not (tmp_path / "study" / "variants.parquet").exists()


@pytest.mark.slow
def test_a_script_needs_no_guard_and_ctrl_c_ends_its_workers(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import wirerope_mj as wr\n"
        "pulse = wr.HalfSine(peak=98.0, duration=0.011, direction='z', start=0.01)\n"
        "study = wr.Study(model='shock_table.xml', motion=pulse, duration=5.0, timestep=1e-3, variants=2000,\n"
        "                 vary={'motion/level': wr.Uniform(0.5, 1.5)})\n"
        f"study.run({str(tmp_path / 'study')!r}, workers=2)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(wr.__file__).parent.parent)}
    with interruptible([sys.executable, str(script)], env=environment) as process:
        while process.poll() is None and not list(tmp_path.glob("study/parts/0*.parquet")):
            time.sleep(0.02)
        workers = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        children = [int(number) for task in workers.parent.parent.glob("*/children") for number in task.read_text().split()]
        process.send_signal(signal.SIGINT)
        error = process.communicate(timeout=120.0)[1]
    assert len(children) == 2
    assert error.rstrip().endswith("KeyboardInterrupt")
    for number in children:
        wait_until_ended(number)
    found = wr.load_study(tmp_path / "study")
    assert found.table.num_rows % chunk_size(found.study) == 0


@pytest.mark.quick
def test_a_study_of_a_record_and_of_a_text_holds_all_it_needs(tmp_path):
    time_, record = np.arange(101) * 5e-4, tmp_path / "deck.csv"
    values = 50.0 * np.sin(np.pi * time_ / time_[-1]) ** 2
    lines = ["time [s],z [m/s^2]", *(f"{t!r},{a!r}" for t, a in zip(time_.tolist(), values.tolist(), strict=True))]
    record.write_text("\n".join(lines))
    text = (models_folder() / "shock_table.xml").read_text()
    study = table_study(model=text, motion=wr.load_record(record), variants=4)
    table = rows(study.run(tmp_path / "study", workers=1).table)
    record.unlink()
    again = wr.load_study(tmp_path / "study").study
    assert rows(again.run(tmp_path / "again", workers=1).table) == table


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"engine": "cloud"}, "`engine` must be one of 'local', 'dask', got 'cloud'"),
        ({"workers": 0}, "`workers` must be an integer >= 1, got 0"),
        ({"address": "tcp://here:1"}, "`address` is for an engine with a cluster"),
    ],
)
def test_arguments_of_a_run_are_checked(tmp_path, arguments, message):
    with pytest.raises(ValueError, match=message):
        table_study().run(tmp_path / "study", **arguments)
    assert not (tmp_path / "study").exists()


@pytest.mark.parametrize(
    ("error", "said", "accident"),
    [
        (wr.SimulationError("body 'rack' left its travel."), "^body 'rack' left its travel.$", False),
        (np.linalg.LinAlgError("Singular matrix"), "numbers of this variant .*Singular matrix.* vary less far", False),
        (TypeError("unhashable"), "not this variant's numbers, .*TypeError: unhashable.* --resume", True),
    ],
)
def test_why_a_variant_has_no_result_is_said_with_what_to_do(error, said, accident):
    message = failure_message(error)
    assert re.search(said, message)
    assert isinstance(message, Accident) is accident
