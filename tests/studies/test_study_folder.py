"""The folder of a study in the hands of people: two processes at once, changed models, damaged and deleted files."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from small_search import beam_search
from table_study import rows, table_study

import wirerope_mj as wr
from wirerope_mj.foundation.atomic_files import worked_on_alone
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.studies.engines import local
from wirerope_mj.studies.engines.compute import compute, failed_part

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

LOCKS = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such locks")

WORKER = """
import sys
from table_study import table_study
from wirerope_mj.studies import study as computing

def wait(folder, part):
    write(folder, part)
    print("here", flush=True)
    sys.stdin.read()

write, computing.write_part = computing.write_part, wait
table_study().run(sys.argv[1], workers=1)
"""


def content(folder):
    """All files below a folder with their bytes."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def cut_short(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


@pytest.fixture
def done(tmp_path):
    """A small study that is complete, with its responses."""
    return table_study(variants=3).run(tmp_path / "done", workers=1, keep="responses")


@pytest.mark.slow
@LOCKS
def test_a_second_process_is_told_that_another_one_works_on_the_study(tmp_path):
    folder = tmp_path / "study"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path])}
    with subprocess.Popen(
        [sys.executable, "-c", WORKER, folder],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as first:
        assert first.stdout.readline() == "here\n"
        before = content(folder)
        for how in ({"resume": True}, {"force": True}):
            with pytest.raises(wr.RecordError, match=r"study: another process works on this study\. Nothing in it was"):
                table_study().run(folder, workers=1, **how)
        assert content(folder) == before
        first.kill()
    assert table_study().run(folder, workers=1, resume=True).complete  # the lock went with its process


@LOCKS
def test_searches_are_held_too(tmp_path):
    folder = tmp_path / "search"
    beam_search(generations=1).run(folder, workers=1)
    with (
        worked_on_alone(folder, kind="study"),
        pytest.raises(wr.RecordError, match="another process works on this study"),
    ):
        beam_search(generations=1).run(folder, workers=1, resume=True)
    assert beam_search(generations=1).run(folder, workers=1, resume=True).complete


def test_a_changed_model_is_named_and_not_its_digest(tmp_path):
    path = tmp_path / "table.xml"
    text = (models_folder() / "shock_table.xml").read_text()
    folder, isolators = tmp_path / "study", models_folder() / "isolators"
    (tmp_path / "isolators").symlink_to(isolators)
    path.write_text(text)
    table_study(model=path, variants=2).run(folder, workers=1)
    path.write_text(text.replace("<worldbody>", "<worldbody><site name='mark'/>"))
    with pytest.raises(wr.RecordError, match=r"of another study: model/\S+\.xml has changed\. Nothing in it was") as told:
        table_study(model=path, variants=2).run(folder, resume=True)
    assert max(map(len, str(told.value).split())) < 64 + len(str(folder))
    assert not any(len(word) == 64 for word in str(told.value).replace("'", " ").split())


def test_a_damaged_table_is_called_so_with_its_remedy(done):
    cut_short(done.folder / "variants.parquet")
    words = r"variants\.parquet: this table is damaged\. The parts that made it are gone: .* again with --force"
    with pytest.raises(wr.RecordError, match=words):
        wr.load_study(done.folder).table.num_rows  # noqa: B018
    again = table_study(variants=3).run(done.folder, workers=1, keep="responses", force=True)
    assert again.table.num_rows == 3


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda table: table.drop_columns(["status"]), "column 'status' must hold string in every row"),
        (lambda table: table.take([1, 0, 2]), "column 'variant' must number the rows from 0 on"),
        (lambda table: table.slice(0, 2), "the study has 3 variants, and this table 2 rows"),
        (lambda table: table.set_column(0, "variant", table["variant"].cast("float64")), "'variant' must hold int64"),
    ],
)
def test_a_table_that_was_changed_is_refused_by_file_and_column(done, change, message):
    path = done.folder / "variants.parquet"
    pq.write_table(change(pq.read_table(path)), path)
    with pytest.raises(wr.RecordError, match=rf"variants\.parquet: .*{message}.*Put a copy in its place"):
        wr.load_study(done.folder).table.num_rows  # noqa: B018


def test_a_damaged_part_is_called_so_and_computed_again_when_it_is_gone(tmp_path, monkeypatch):
    folder, finished = tmp_path / "study", table_study(variants=3).run(tmp_path / "finished", workers=1)

    def stopped(work, chunk):
        if chunk.number == 2:
            raise KeyboardInterrupt
        return compute(work, chunk)

    with monkeypatch.context() as patch:
        patch.setattr(local, "compute", stopped)
        with pytest.raises(KeyboardInterrupt):
            table_study(variants=3).run(folder, workers=1)
    cut_short(folder / "parts" / "000001.parquet")
    with pytest.raises(wr.RecordError, match=r"000001\.parquet: this part of the study is damaged\. Remove it, and go on"):
        table_study(variants=3).run(folder, workers=1, resume=True)
    (folder / "parts" / "000001.parquet").unlink()
    assert rows(table_study(variants=3).run(folder, workers=1, resume=True).table) == rows(finished.table)


def test_a_damaged_response_is_named_and_simulated_when_it_is_removed(done):
    path = done.folder / "responses" / "000001.parquet"
    expected = done.response(1).peaks.to_dict()
    cut_short(path)
    with pytest.raises(wr.RecordError, match=r"responses/000001\.parquet: .*: remove it, and it is simulated when"):
        done.response(1)
    path.unlink()
    assert repr(done.response(1).peaks.to_dict()) == repr(expected)


def test_responses_that_are_gone_are_told(done):
    assert done.message == "3 variants, none failed."
    (done.folder / "responses" / "000001.parquet").unlink()
    resumed = table_study(variants=3).run(done.folder, workers=1, keep="responses", resume=True)
    assert resumed.message == (
        "3 variants, none failed. Of the responses that were kept 1 are gone; they are simulated when they are asked for."
    )


def test_chunks_whose_process_died_are_told_with_the_way_on(tmp_path, monkeypatch):
    def deadly(work, chunk):
        return failed_part(work, chunk, "its process died") if chunk.number == 1 else compute(work, chunk)

    with monkeypatch.context() as patch:
        patch.setattr(local, "compute", deadly)
        result = table_study(variants=3).run(tmp_path / "study", workers=1)
    assert result.message.endswith(
        "Some were not computed, since their processes died or found no memory, threads or files: go on with --resume "
        "(`resume=True`)."
    )
    result = table_study(variants=3).run(tmp_path / "study", workers=1, resume=True)
    assert result.message == "3 variants, none failed."


@pytest.mark.parametrize("number", [1.5, 1.0, True, "1", None])
def test_a_variant_has_a_whole_number(done, number):
    for ask in (done.response, done.study.row):
        with pytest.raises(ValueError, match=f"`variant` must be an integer >= 0, got {number!r}"):
            ask(number)


def test_numbers_of_numpy_are_whole_numbers_too(done):
    assert done.response(np.int64(2)).path == Path(done.folder) / "responses" / "000002.parquet"
