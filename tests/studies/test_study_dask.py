"""Studies on Dask's workers: the table of this machine's processes, whatever happens to a worker or the scheduler."""

import gc
import json
import os
import signal
import socket
import subprocess
import sys
import time
from concurrent.futures import CancelledError
from contextlib import contextmanager, nullcontext
from types import SimpleNamespace

import pyarrow as pa
import pytest

import wirerope_mj as wr
from wirerope_mj.studies import study as computing
from wirerope_mj.studies.study import chunks

pytest.importorskip("distributed")
import psutil  # noqa: E402  distributed brings it

from wirerope_mj.studies.engines import dask_engine  # noqa: E402
from wirerope_mj.studies.engines.dask_engine import check_answers, run_dask  # noqa: E402

pytestmark = pytest.mark.filterwarnings(  # of Dask's own sockets, when its processes are killed
    "ignore::ResourceWarning",
    "ignore::pytest.PytestUnraisableExceptionWarning",
    "ignore::DeprecationWarning:distributed",
    "ignore:the given step of",  # what is asked here holds at coarse steps
)


@pytest.fixture(autouse=True)
def collected():
    """Collect what clients without a scheduler leave, here and not in a later test, which would fail for their sockets."""
    yield
    gc.collect()


def study():
    """Return a study of the shock table in twelve chunks."""
    return wr.Study(
        model="shock_table.xml",
        motion=wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01),
        duration=0.1,
        vary={
            "mount/*/axial/alpha": wr.Normal(1.0, 0.1, relative=True, each=True),
            "motion/level": wr.Uniform(0.5, 1.5),
        },
        variants=24,
        timestep=1e-3,
        name="table",
    )


def bits(table):
    """Return a table's columns so that equal means equal in every bit, NaN included."""
    columns = {name: table[name] for name in table.column_names}
    return {
        name: column.to_numpy().tobytes() if pa.types.is_float64(column.type) else column.to_pylist()
        for name, column in columns.items()
    }


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Yield the address of a scheduler with one worker, as they stand on another machine, on a port of their own."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    dask = [sys.executable, "-m", "dask"]
    file = tmp_path_factory.mktemp("cluster") / "scheduler.json"
    where = ["--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file), "--no-dashboard"]
    scheduler = subprocess.Popen([*dask, "scheduler", *where], **quiet)
    while not (file.exists() and file.read_text().endswith("}")):  # a file is there before what is written into it
        time.sleep(0.05)
    address = json.loads(file.read_text())["address"]
    worker = subprocess.Popen([*dask, "worker", address, "--nworkers", "1", "--nthreads", "2", "--no-dashboard"], **quiet)
    yield address, scheduler, worker
    for process in (worker, scheduler):
        process.terminate()
        process.wait(timeout=120.0)


@pytest.fixture(scope="module")
def local(tmp_path_factory):
    return study().run(tmp_path_factory.mktemp("local") / "study", engine="local", workers=1).table


@pytest.mark.slow
def test_a_cluster_that_exists_gives_the_local_table_bit_for_bit(cluster, local, tmp_path):
    result = study().run(tmp_path / "study", keep="responses", engine="dask", address=cluster[0])
    table = result.table
    assert table.schema.equals(local.schema)
    assert bits(table) == bits(local)
    assert local.num_rows == 24
    assert set(local["status"].to_pylist()) == {"done"}
    # the responses travelled with the rows
    assert len(list((tmp_path / "study" / "responses").iterdir())) == 24
    kept, again = result.response(17), study().response(17)
    assert kept.path is not None
    names = again.samples.names
    assert kept.samples.columns(0, len(names)).tobytes() == again.samples.columns(0, len(names)).tobytes()


@pytest.mark.slow
def test_workers_of_other_versions_end_the_study_with_one_message(cluster, tmp_path, monkeypatch):
    here = dask_engine.versions()
    for name, word in (("mujoco", "mujoco 4.*instead of 99.0"), ("code", f"code {here['code']} instead of 99.0")):
        monkeypatch.setattr(dask_engine, "versions", lambda name=name: {**here, name: "99.0"})
        with pytest.raises(wr.SimulationError, match=f"a worker has {word}, .*every worker needs the versions of"):
            study().run(tmp_path / name, engine="dask", address=cluster[0])
        assert not (tmp_path / name / "variants.parquet").exists()
        assert not list((tmp_path / name / "parts").iterdir())


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_nothing(cluster, local):
    address, _, worker = cluster
    asked, found = study(), {}
    for part in run_dask(asked.work, chunks(asked, range(12)), workers=None, address=address):
        if not found:  # the one process that computes; its chunks are in flight
            (computing,) = [
                process
                for process in psutil.Process(worker.pid).children(recursive=True)
                if "multiprocessing.spawn" in " ".join(process.cmdline())
            ]
            os.kill(computing.pid, signal.SIGKILL)
        found[part.number] = part.table
    assert sorted(found) == list(range(12))
    assert bits(pa.concat_tables(found[number] for number in range(12))) == bits(local)


@pytest.mark.slow
def test_a_chunk_that_kills_its_workers_is_tried_alone_at_the_end_and_fails_alone(local, tmp_path, monkeypatch):
    tried = tmp_path / "tried"

    def deadly(work, chunk, versions, log=str(tried)):  # by value: workers know nothing of this file
        import os
        import signal

        from wirerope_mj.studies.engines.compute import compute

        with open(log, "a") as file:
            file.write(f"{chunk.number}\n")
        if chunk.number == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        return compute(work, chunk)

    with monkeypatch.context() as patch:
        patch.setattr(dask_engine, "_computed", deadly)
        patch.setattr(dask_engine, "ATTEMPTS", 0)  # each death costs the start of a process
        result = study().run(tmp_path / "study", engine="dask", workers=1)
    order = [int(line) for line in tried.read_text().split()]
    assert order.count(3) == 2
    assert set(order) == set(range(12))
    last = order.index(3, order.index(3) + 1)
    # All but what had waited beside it was tried before. A result that a death takes along is computed again, at any place.
    assert set(order[:last]) >= set(range(12)) - {4}
    assert sorted(result.failed) == [6, 7]
    assert "died again and again" in result.failed[6]
    done = [number for number in range(24) if number not in (6, 7)]
    assert bits(result.table.take(done)) == bits(local.take(done))
    again = study().run(tmp_path / "study", workers=1, resume=True)  # another engine, on which it lives
    assert bits(again.table) == bits(local)


@pytest.mark.slow
def test_what_is_no_scheduler_is_said():
    for address in ("tcp://127.0.0.1:9", "nonsense", "foo://here:1"):
        with pytest.raises(wr.SimulationError, match="no Dask scheduler answers at .*is this its address"):
            check_answers(address)


def test_workers_of_a_cluster_that_exists_are_not_this_studys_to_count(tmp_path):
    with pytest.raises(ValueError, match="`workers` belongs to a cluster of this machine"):
        study().run(tmp_path / "study", engine="dask", workers=2, address="tcp://127.0.0.1:9")


def test_a_cluster_without_workers_is_waited_for_and_that_is_said(monkeypatch):
    class Idle:
        def nthreads(self):
            return {}

    monkeypatch.setattr(dask_engine, "PATIENCE", 0.1)
    with pytest.warns(wr.ClusterWarning, match="cluster at tcp://here:1 has no workers yet; the study waits for them"):
        dask_engine._warn_if_idle(Idle(), "tcp://here:1")


@pytest.mark.slow
def test_a_cluster_that_cannot_be_reached_loses_nothing_of_what_is_done(local, tmp_path, monkeypatch):
    folder = tmp_path / "study"
    with socket.create_server(("127.0.0.1", 0)) as silent:  # takes the call, and never answers
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(wr.SimulationError, match=f"no Dask scheduler answers at '{address}'"):
            study().run(folder, engine="dask", address=address)
        assert not folder.exists()
    stop_after_first_part(monkeypatch, KeyboardInterrupt)
    with pytest.raises(KeyboardInterrupt):
        study().run(folder, workers=1)
    monkeypatch.undo()
    parts = {path.name: path.read_bytes() for path in (folder / "parts").iterdir()}
    assert list(parts) == ["000000.parquet"]
    with pytest.raises(wr.SimulationError, match="no Dask scheduler answers at"):
        study().run(folder, engine="dask", address="tcp://127.0.0.1:9", resume=True)
    assert {path.name: path.read_bytes() for path in (folder / "parts").iterdir()} == parts
    assert bits(study().run(folder, workers=1, resume=True).table) == bits(local)


def stop_after_first_part(monkeypatch, what):
    """Raise or call something when a study has written a part."""
    ordinary = computing.write_part

    def write(folder, part):
        ordinary(folder, part)
        if isinstance(what, type):
            raise what
        what()

    monkeypatch.setattr(computing, "write_part", write)


def test_chunks_in_flight_when_the_scheduler_goes_are_handed_over_again_and_none_twice(monkeypatch):
    class Losing:
        """Hands over three chunks at a time, loses its scheduler twice with chunks in flight, and once with a suspect."""

        losses = [1, 4, 12]

        def __init__(self, client, work, *, where):
            assert where == "the cluster at here"
            self.client = client

        def parts(self, chunks, running, suspect):
            for chunk in chunks:
                running[chunk] = chunk
                if len(running) < 3:
                    continue
                for number in list(running)[:2]:
                    if number in self.losses:
                        self.losses.remove(number)
                        raise CancelledError
                    del running[number]
                    if number == 7:
                        suspect(number)
                    else:
                        yield number
            while running:
                yield running.pop(min(running))

        def alone(self, chunk):
            if self.losses:
                self.losses.pop()
                self.client.status = "closed"  # of itself, after a time: its calls then raise whatever comes
                raise AttributeError
            return chunk

    monkeypatch.setattr(dask_engine, "_Cluster", Losing)
    monkeypatch.setattr(dask_engine, "_client", lambda workers, address: nullcontext(SimpleNamespace(status="running")))
    monkeypatch.setattr(dask_engine, "_warn_if_idle", lambda client, address: None)
    monkeypatch.setattr(dask_engine, "check_answers", lambda address: None)
    assert sorted(run_dask(None, range(12), workers=None, address="here")) == list(range(12))
    assert Losing.losses == []


def test_a_scheduler_that_goes_each_time_is_not_waited_for_without_end(monkeypatch):
    started = []

    @contextmanager
    def gone(workers, address):
        started.append(address)
        raise OSError
        yield

    monkeypatch.setattr(dask_engine, "_client", gone)
    monkeypatch.setattr(dask_engine, "check_answers", lambda address: None)
    with pytest.raises(wr.SimulationError, match="the scheduler of the cluster at here has gone; what is done is kept"):
        list(run_dask(None, range(12), workers=None, address="here"))
    assert len(started) == dask_engine.LOSSES + 1


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the cluster at .* has no workers yet")  # as long as one takes to start on a busy machine
def test_a_scheduler_that_is_started_again_loses_nothing(local, tmp_path, monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    dask, quiet = [sys.executable, "-m", "dask"], {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    address, started, restarts, ordinary = f"tcp://127.0.0.1:{port}", [], [], computing.write_part

    def start():
        where = ["--host", "127.0.0.1", "--port", port, "--no-dashboard"]
        started.append(subprocess.Popen([*dask, "scheduler", *where], **quiet))
        while socket.socket().connect_ex(("127.0.0.1", int(port))):
            time.sleep(0.05)
        worker = ["worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
        started.append(subprocess.Popen([*dask, *worker], cwd=tmp_path, **quiet))

    def write(folder, part):
        ordinary(folder, part)
        if not restarts:
            restarts.append(part.number)
            started[0].kill()
            started[0].wait()
            start()

    start()
    monkeypatch.setattr(computing, "write_part", write)
    try:
        result = study().run(tmp_path / "study", engine="dask", address=address)
    finally:
        for process in started:
            process.kill()
            process.wait()
    assert restarts
    assert bits(result.table) == bits(local)


@pytest.mark.slow
def test_a_scheduler_that_goes_away_costs_only_what_was_in_flight(cluster, local, tmp_path, monkeypatch):
    address, scheduler, _ = cluster
    folder = tmp_path / "study"
    stop_after_first_part(monkeypatch, scheduler.kill)
    monkeypatch.setattr(dask_engine, "AWAY", 0.5)
    with pytest.raises(wr.SimulationError, match="the scheduler of the cluster at .* has gone.*--resume"):
        study().run(folder, engine="dask", address=address)
    monkeypatch.undo()
    parts = list((folder / "parts").iterdir())
    assert 1 <= len(parts) < 12
    assert not (folder / "variants.parquet").exists()
    assert bits(study().run(folder, workers=1, resume=True).table) == bits(local)
