"""Studies that are killed: anywhere, at any operation on their files, and worker by worker."""

import functools
import itertools
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import time
import warnings
from dataclasses import replace

import psutil
import pytest
from house import calls
from kills import killed_at_call, wait_until_ended
from table_study import FILES, VARY, rows, table_study
from writing_commands import files

import wirerope_mj as wr
from wirerope_mj.cli.study import compute_and_print
from wirerope_mj.studies import folder as study_folder
from wirerope_mj.studies.engines import local
from wirerope_mj.studies.engines.compute import compute, failed_part
from wirerope_mj.studies.results.varied import summary
from wirerope_mj.studies.study import chunks, load_study

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """A study left alone, in this process."""
    return table_study().run(tmp_path_factory.mktemp("study") / "alone", workers=1)


def forked(work):
    """Run something in a process of its own and return its number."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # threads of libraries do not matter to this child
        child = os.fork()
    if child == 0:
        try:
            work()
        finally:
            os._exit(0)
    return child


@pytest.mark.slow
def test_a_study_killed_ten_times_anywhere_ends_with_the_same_table(alone, tmp_path):
    whole, folder = calls(lambda: table_study().run(tmp_path / "counted", workers=1))["call"], tmp_path / "killed"
    go_on = functools.partial(table_study().run, folder, workers=1, resume=True)
    killed = [killed_at_call(whole * share // 20, go_on) for share in range(1, 11)]
    assert killed.count(True) >= 5  # until there is less left than half of it all
    go_on()
    assert_same_files(folder, alone.folder)


def assert_same_files(folder, expected):
    """Two studies hold the same bytes, and nothing of what was killed is left in the folder or beside it."""
    assert sorted(path.name for path in folder.iterdir()) == FILES
    assert [path.name for path in folder.parent.iterdir() if path.name.startswith(".")] == []
    for name in ("variants.parquet", "summary.json", "study.toml"):
        assert (folder / name).read_bytes() == (expected / name).read_bytes()


OPERATIONS = {f"os.{name}" for name in ("rename", "remove", "rmdir", "mkdir", "chmod")} | {
    "shutil.rmtree", "tempfile.mkstemp", "tempfile.mkdtemp",
}  # fmt: skip
"""What Python reports before it changes a folder."""


def killed_before(operation, work):
    """Run something in a process that is killed just before its operation of that number; say whether it was."""
    count = itertools.count(1)

    def watched():
        sys.addaudithook(
            lambda event, _: os.kill(os.getpid(), signal.SIGKILL) if event in OPERATIONS and next(count) == operation else None
        )
        work()

    return os.WIFSIGNALED(os.waitpid(forked(watched), 0)[1])


def test_a_study_killed_at_any_operation_of_its_beginning_starts_as_if_nothing_had_been(alone, tmp_path):
    study = table_study()
    assert study.table().num_rows == 40  # checked once for all
    for operation in itertools.count(1):
        folder = tmp_path / str(operation) / "study"
        folder.parent.mkdir()
        start = functools.partial(study_folder.prepare, study, folder, keep="peaks", resume=True)
        killed = killed_before(operation, start)
        assert folder.exists() <= (folder / "study.toml").exists()
        start()
        assert sorted(path.name for path in folder.iterdir()) == ["model", "parts", "study.toml"]
        assert [path.name for path in folder.parent.iterdir()] == ["study"]
        assert (folder / "study.toml").read_bytes() == (alone.folder / "study.toml").read_bytes()
        if not killed:
            break
    assert operation > 5  # the folder beside, its mode, model, parts, and the renaming at least


@pytest.mark.slow
def test_a_study_killed_at_any_operation_of_its_writing_ends_with_the_same_bytes(alone, tmp_path, monkeypatch):
    study, before = table_study(), tmp_path / "before"
    study_folder.prepare(study, before, keep="peaks", resume=False)
    *most, rest = (compute(study.work, chunk) for chunk in chunks(study, range(14)))
    for part in most:
        study_folder.write_part(before, part)
    for operation in itertools.count(1):
        folder = tmp_path / str(operation) / "study"
        shutil.copytree(before, folder)

        def end(folder=folder):
            study_folder.write_part(folder, rest)
            study_folder.finish(folder, 14, lambda: summary(wr.load_study(folder)))

        killed = killed_before(operation, end)
        monkeypatch.setattr(local, "compute", lambda work, chunk: rest)  # the only one that may be missing
        study.run(folder, workers=1, resume=True)
        assert_same_files(folder, alone.folder)
        if not killed:
            break
    assert operation > 20  # three files of three operations each, and fourteen parts that are removed


@pytest.mark.slow
@pytest.mark.parametrize("deaths", [1, 2])
def test_a_chunk_whose_worker_dies_is_tried_once_more_and_then_fails(alone, tmp_path, monkeypatch, deaths):
    lives, ordinary = [], local._Process.compute

    def deadly(process, chunk):
        if chunk.number == 3 and len(lives) < deaths:  # in the middle of its life: it has said that it is ready
            lives.append(process)
            process.end()
        return ordinary(process, chunk)

    monkeypatch.setattr(local._Process, "compute", deadly)
    result = table_study().run(tmp_path / "study", workers=2)
    assert len(lives) == deaths
    if deaths == 1:
        assert rows(result.table) == rows(alone.table)
        return
    assert sorted(result.failed) == [9, 10, 11]
    assert "died (signal 9), 2 times in a row" in result.failed[9]
    expected = [row for number, row in enumerate(rows(alone.table)) if number not in (9, 10, 11)]
    assert [row for row in rows(result.table) if row["status"] == "'done'"] == expected
    # computed again on resume, and nothing else is
    computed = []
    monkeypatch.setattr(local, "compute", lambda work, chunk: computed.append(chunk.number) or compute(work, chunk))
    again = table_study().run(tmp_path / "study", workers=1, resume=True)
    assert computed == [3]
    assert again.failed == {}
    assert (again.folder / "variants.parquet").read_bytes() == (alone.folder / "variants.parquet").read_bytes()
    assert (again.folder / "summary.json").read_bytes() == (alone.folder / "summary.json").read_bytes()
    assert sorted(path.name for path in again.folder.iterdir()) == FILES


@pytest.mark.parametrize("last", ["taken away", "computed", "joined"])
def test_a_study_killed_while_it_computes_again_what_had_died_loses_nothing(alone, tmp_path, monkeypatch, last):
    folder = tmp_path / "study"

    def dead(work, chunk):
        return failed_part(work, chunk, "died") if chunk.number in (3, 5) else compute(work, chunk)

    def killed(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(local, "compute", dead)
    assert len(table_study().run(folder, workers=1).failed) == 6
    assert len(table_study().run(folder, workers=1, resume=True).failed) == 6  # and again
    with monkeypatch.context() as patch:
        patch.setattr(local, "compute", compute)
        if last == "taken away":
            patch.setattr(local, "compute", killed)
        if last == "computed":
            patch.setattr("wirerope_mj.studies.study.finish", killed)
        if last == "joined":
            patch.setattr("wirerope_mj.studies.study.summary", killed)
        with pytest.raises(KeyboardInterrupt):
            table_study().run(folder, workers=1, resume=True)
    monkeypatch.setattr(local, "compute", compute)
    result = table_study().run(folder, workers=1, resume=True)
    assert result.failed == {}
    assert (folder / "variants.parquet").read_bytes() == (alone.folder / "variants.parquet").read_bytes()
    assert sorted(path.name for path in folder.iterdir()) == FILES


@pytest.mark.parametrize("moment", ["computing", "written", "done"])
def test_a_study_stays_whole_until_the_one_that_replaces_it_is(alone, tmp_path, monkeypatch, moment):
    folder = tmp_path / "study"
    shutil.copytree(alone.folder, folder)
    (folder / "travel.png").write_bytes(b"a picture of it")
    before = files(folder)

    def interrupted(*_):
        raise KeyboardInterrupt

    place = {"computing": "wirerope_mj.studies.study.write_part", "written": "wirerope_mj.studies.study.finish"}
    with monkeypatch.context() as patch:
        if moment in place:
            patch.setattr(place[moment], interrupted)
        with pytest.raises(KeyboardInterrupt):
            table_study(seed=2).run(folder, workers=1, force=True, when_done=interrupted)
    assert files(folder) == before
    assert [path.name for path in tmp_path.iterdir()] == ["study"]
    replaced = table_study(seed=2).run(folder, workers=1, force=True, when_done=lambda result: (result.folder / "new").touch())
    assert rows(replaced.table) != rows(alone.table)
    assert sorted(path.name for path in folder.iterdir()) == sorted([*FILES, "new"])


def test_a_study_that_is_computed_stays_whatever_is_written_of_it(alone, tmp_path):
    def refuse(result):
        raise ValueError("no such measure")

    folder = tmp_path / "study"
    shutil.copytree(alone.folder, folder)
    with pytest.raises(ValueError, match="no such measure"):
        table_study(seed=2).run(folder, workers=1, force=True, when_done=refuse)
    assert [path.name for path in tmp_path.iterdir()] == ["study"]
    assert load_study(folder).study.seed == 2


@pytest.mark.parametrize(("broken", "why"), [("died", "processes that computed variants died"), ("failed", "every variant")])
def test_a_study_that_is_not_whole_replaces_none(alone, tmp_path, monkeypatch, broken, why):
    def compute_none(work, chunk):
        if broken == "died" and chunk.number:
            return compute(work, chunk)
        return replace(failed_part(work, chunk, "Nothing rests."), died=broken == "died")

    folder = tmp_path / "study"
    shutil.copytree(alone.folder, folder)
    before = files(folder)
    monkeypatch.setattr(local, "compute", compute_none)
    with pytest.raises(wr.SimulationError, match=f"{why}.*study that was there is as it was"):
        table_study(seed=2).run(folder, workers=1, force=True)
    assert files(folder) == before


def test_variants_that_failed_by_physics_are_not_computed_again(tmp_path, monkeypatch):
    asked = {"vary": {**VARY, "mount/m1/failed": wr.Choice(False, True)}, "variants": 4}
    first = table_study(**asked).run(tmp_path / "study", workers=1)
    assert first.failed
    monkeypatch.setattr(local, "compute", None)  # nobody asks for it
    assert table_study(**asked).run(tmp_path / "study", workers=1, resume=True).failed == first.failed


@pytest.mark.parametrize("accident", [MemoryError(), OSError(24, "Too many open files"), RuntimeError("no new thread")])
def test_what_no_memory_threads_or_files_were_there_for_is_no_result_and_computed_again(alone, tmp_path, monkeypatch, accident):
    folder = tmp_path / "study"

    def fails(*_, **__):
        raise accident

    def short(work, chunk):
        with monkeypatch.context() as patch:
            if chunk.number == 3:
                patch.setattr("wirerope_mj.studies.engines.compute.together", fails)
                patch.setattr("wirerope_mj.studies.engines.together.simulate_batch", fails)
            return compute(work, chunk)

    with monkeypatch.context() as patch:
        patch.setattr(local, "compute", short)
        first = table_study().run(folder, workers=1)
        assert sorted(first.failed) == [9, 10, 11]
        assert re.search(rf"{type(accident).__name__}.* go on with --resume", first.failed[9])
        assert "Some were not computed" in first.message
        with pytest.raises(wr.WireRopeError, match=r"study: Some were not computed, .* go on with --resume"):
            compute_and_print(table_study, "study", resume=True, out=folder, by=None, open_worst=0, workers=1)
    again = table_study().run(folder, workers=1, resume=True)
    assert again.failed == {}
    for name in ("variants.parquet", "summary.json"):
        assert (folder / name).read_bytes() == (alone.folder / name).read_bytes()


@pytest.mark.slow
def test_a_worker_ends_in_the_middle_of_a_chunk_when_nobody_waits_for_it_any_more():
    study = table_study(variants=1, duration=1e5)  # a hundred million steps
    worker = local._Process(pickle.dumps(functools.partial(compute, study.work)))
    process = worker._process
    process.stdin.write(pickle.dumps(next(chunks(study, [0]))))
    process.stdin.flush()
    begun = psutil.Process(process.pid).cpu_times().user
    while psutil.Process(process.pid).cpu_times().user < begun + 0.5:
        time.sleep(0.01)
    assert process.poll() is None
    process.stdin.close()  # as when the process that asks is killed
    try:
        assert process.wait(timeout=120.0) == 0
    finally:
        worker.kill()


def test_workers_that_are_still_starting_end_with_the_process_that_asks(tmp_path):
    asleep = "import pathlib, sys, time\nif sys.orig_argv[-1].endswith('engines.worker'):\n    "
    asleep += f"pathlib.Path({str(tmp_path)!r}, str(__import__('os').getpid())).touch()\n    time.sleep(600.0)\n"
    (tmp_path / "sitecustomize.py").write_text(asleep)
    asking = (
        "import threading, time\nfrom wirerope_mj.foundation.interrupts import end\n"
        "from wirerope_mj.studies.engines.local import in_processes\nimport pathlib\n"
        "results = in_processes(abs, [1, 2], lost=lambda question, reason: 0, workers=2)\n"
        "threading.Thread(target=next, args=(results,), daemon=True).start()\n"
        f"while sum(path.name.isdigit() for path in pathlib.Path({str(tmp_path)!r}).iterdir()) < 2:\n    time.sleep(0.01)\n"
        "end(15)\n"
    )
    paths = os.pathsep.join([str(tmp_path), *filter(None, sys.path)])
    ended = subprocess.run([sys.executable, "-c", asking], env={**os.environ, "PYTHONPATH": paths}, timeout=300.0)
    assert ended.returncode == 128 + 15
    for number in (int(path.name) for path in tmp_path.iterdir() if path.name.isdigit()):
        wait_until_ended(number)
