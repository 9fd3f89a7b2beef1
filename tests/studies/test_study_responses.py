"""Whole responses that a study keeps: those of its variants alone, bit for bit, whatever happens to it."""

from dataclasses import replace

import numpy as np
import pytest
from house import calls
from kills import killed_at_call

import wirerope_mj as wr
from wirerope_mj.studies import study as study_module
from wirerope_mj.studies.engines import local
from wirerope_mj.studies.engines.compute import compute
from wirerope_mj.studies.study import chunk_size, chunks

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.0103)  # no sample at its corners
STEP = wr.VelocityStep(velocity=0.3, direction="z", start=0.02)
FILES = [f"{number:06d}.parquet" for number in range(10)]


def table_study(**others):
    given = {
        "model": "shock_table.xml", "variants": 10, "duration": 0.05, "timestep": 1e-3, "motions": [PULSE, STEP],
        "vary": {"mount/m1/axial/alpha": wr.Normal(1.0, 0.1, relative=True), "motion/record": wr.Choice(0, 1)},
    }  # fmt: skip
    return wr.Study(**{**given, **others})


def bits(response):
    """All that a response holds, with every bit of its samples."""
    names = response.samples.names
    states = [(state.time, state.values.tobytes()) for state in (response.initial_state, response.final_state)]
    return {
        "names": list(names),
        "samples": response.samples.columns(0, len(names)).tobytes(),
        "peaks": repr(response.peaks.to_dict()),
        "numerics": repr(replace(response.numerics, error_estimate=np.nan)),  # a run alone tries half of a given step, too
        "motion": response.motion,
        "events": response.events,
        "states": states,
        "scene": repr(response.scene),
    }


def kept_files(folder):
    return sorted(path.name for path in (folder / "responses").iterdir())


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The study left alone, in this process."""
    return table_study().run(tmp_path_factory.mktemp("study") / "alone", keep="responses", workers=1)


@pytest.fixture(scope="module")
def peaks(tmp_path_factory):
    """The same study without responses."""
    return table_study().run(tmp_path_factory.mktemp("study") / "peaks", workers=1)


def test_kept_responses_are_those_of_the_variants_alone_bit_for_bit(alone):
    study = table_study()
    assert set(alone.table["motion/record"].to_pylist()) == {0, 1}
    assert kept_files(alone.folder) == FILES
    for number in range(10):
        assert bits(alone.response(number)) == bits(study.response(number))
    assert alone.response(3).path == alone.folder / "responses" / "000003.parquet"
    assert wr.load_response(alone.folder / "responses" / "000003.parquet").time.size == 51
    with pytest.raises(ValueError, match="`variant` must be from 0 to 9, got 10"):
        alone.response(10)


def test_the_table_is_the_same_with_and_without_them(alone, peaks):
    files = [result.folder / "variants.parquet" for result in (alone, peaks)]
    assert files[0].read_bytes() == files[1].read_bytes()


def test_what_was_not_kept_is_simulated(peaks):
    assert not (peaks.folder / "responses").exists()
    response = peaks.response(4)
    assert response.path is None
    assert bits(response) == bits(table_study().response(4))


@pytest.mark.slow
def test_workers_hand_them_over_and_small_memory_makes_small_chunks(alone, tmp_path, monkeypatch):
    study = table_study(variants=40)
    assert chunk_size(study, "responses") == chunk_size(study) == 3  # of 51 samples there is room for more
    one = 8 * 51 * len(alone.response(0).samples.names)
    monkeypatch.setattr(study_module, "MEMORY", 2.5 * one)
    assert chunk_size(study, "responses") == 2
    monkeypatch.setattr(study_module, "MEMORY", one / 2.0)
    assert chunk_size(study, "responses") == 1
    result = table_study().run(tmp_path / "two", keep="responses", workers=2)
    assert (result.folder / "variants.parquet").read_bytes() == (alone.folder / "variants.parquet").read_bytes()
    assert kept_files(result.folder) == FILES
    for number in (0, 9):
        assert bits(result.response(number)) == bits(alone.response(number))


def test_variants_that_fail_have_none(tmp_path):
    vary = {"mount/m1/failed": wr.Choice(False, True)}
    study = table_study(motions=(), motion=PULSE, vary=vary, variants=None, sampling="grid")
    result = study.run(tmp_path / "study", keep="responses", workers=1)
    (failed,) = result.failed
    assert kept_files(result.folder) == [FILES[1 - failed]]
    with pytest.raises(wr.ConvergenceError, match="no equilibrium"):
        result.response(failed)


def test_where_forces_are_python_each_variant_is_recorded_alone(monkeypatch):
    monkeypatch.setattr("wirerope_mj.engine.control.install.disagreement", lambda model, data: "qvel")
    study = table_study(duration=0.01)
    (chunk,) = chunks(study, [2], "responses")
    with pytest.warns(RuntimeWarning, match="slower Python callback"):
        part = compute(study.work, chunk)
    assert list(part.responses) == [2]


@pytest.mark.slow
def test_a_study_killed_anywhere_keeps_whole_files_and_ends_with_all_of_them(alone, tmp_path):
    folder, study = tmp_path / "killed", table_study()
    whole = calls(lambda: study.run(tmp_path / "counted", keep="responses", workers=1))["call"]
    for share in (3, 4, 5, 6, 7):
        assert killed_at_call(whole * share // 20, lambda: study.run(folder, keep="responses", workers=1, resume=True))
        parts = {path.name for path in folder.glob("parts/0*.parquet")}
        assert parts <= {path.name for path in folder.glob("responses/0*.parquet")}  # chunks of one variant
        for path in folder.glob("responses/0*.parquet"):
            assert bits(wr.load_response(path)) == bits(alone.response(int(path.stem)))
    assert parts
    (folder / "responses" / ".000001.abcdefgh.wirerope.part.parquet").write_bytes(b"half")
    result = table_study().run(folder, keep="responses", workers=1, resume=True)
    assert (result.folder / "variants.parquet").read_bytes() == (alone.folder / "variants.parquet").read_bytes()
    assert kept_files(folder) == FILES
    assert np.array_equal(result.response(9).mounts["m1"].force, alone.response(9).mounts["m1"].force)


def test_what_is_kept_does_not_change_in_the_middle(alone, peaks, monkeypatch):
    monkeypatch.setattr(local, "compute", None)  # nothing is computed
    with pytest.raises(wr.RecordError, match="this study keeps responses; go on with it with --keep responses"):
        table_study().run(alone.folder, resume=True)
    with pytest.raises(wr.RecordError, match="this study keeps peaks; go on with it with --keep peaks"):
        table_study().run(peaks.folder, resume=True, keep="responses")
    with pytest.raises(ValueError, match="`keep` must be one of 'peaks', 'responses', got 'all'"):
        table_study().run(peaks.folder, resume=True, keep="all")
    assert table_study().run(alone.folder, resume=True, keep="responses").message == "10 variants, none failed."
