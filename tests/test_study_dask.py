"""Studies on Dask's workers: the table of this machine's processes, whatever happens to a worker or the scheduler."""

import os
import signal
import subprocess
import sys
import time

import pyarrow as pa
import pytest

import wirerope_mj as wr
from wirerope_mj.study.run import chunks

pytest.importorskip("distributed")
import psutil  # noqa: E402  distributed brings it

from wirerope_mj.study.dask_engine import check_answers, run_dask  # noqa: E402

pytestmark = pytest.mark.filterwarnings(  # of Dask's own sockets, when its processes are killed
    "ignore::ResourceWarning",
    "ignore::pytest.PytestUnraisableExceptionWarning",
    "ignore::DeprecationWarning:distributed",
)


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
def cluster():
    """Yield the address of a scheduler with one worker, as they stand on another machine."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    port = "23786"
    address = f"tcp://127.0.0.1:{port}"
    dask = [sys.executable, "-m", "dask"]
    scheduler = subprocess.Popen([*dask, "scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"], **quiet)
    worker = subprocess.Popen(
        [*dask, "worker", address, "--nworkers", "1", "--nthreads", "2", "--no-dashboard"], **quiet
    )
    yield address, scheduler
    for process in (worker, scheduler):
        process.terminate()
        process.wait(timeout=60.0)


@pytest.fixture(scope="module")
def local(tmp_path_factory):
    return study().run(tmp_path_factory.mktemp("local") / "study", engine="local", workers=1).table


def test_a_cluster_that_exists_gives_the_local_table_bit_for_bit(cluster, local, tmp_path):
    table = study().run(tmp_path / "study", engine="dask", address=cluster[0]).table
    assert table.schema.equals(local.schema)
    assert bits(table) == bits(local)
    assert local.num_rows == 24
    assert set(local["status"].to_pylist()) == {"done"}


def test_a_worker_that_is_killed_loses_nothing(local, tmp_path):
    asked, found = study(), {}
    for part in run_dask(asked.work, chunks(asked, range(12)), workers=1):
        if not found:  # the one process that computes; its chunks are in flight
            computing = [
                p for p in psutil.Process().children(recursive=True) if "multiprocessing.spawn" in " ".join(p.cmdline())
            ]
            assert computing
            for process in computing:
                os.kill(process.pid, signal.SIGKILL)
        found[part.number] = part.table
    assert sorted(found) == list(range(12))
    assert bits(pa.concat_tables(found[number] for number in range(12))) == bits(local)


def test_what_is_no_scheduler_is_said_within_seconds():
    for address in ("tcp://127.0.0.1:9", "nonsense", "foo://here:1"):
        began = time.monotonic()
        with pytest.raises(wr.SimulationError, match="no Dask scheduler answers at .*is this its address"):
            check_answers(address)
        assert time.monotonic() - began < 20.0  # 5 s of patience, on a machine that is busy


def test_workers_of_a_cluster_that_exists_are_not_this_studys_to_count(tmp_path):
    with pytest.raises(ValueError, match="`workers` belongs to a cluster of this machine"):
        study().run(tmp_path / "study", engine="dask", workers=2, address="tcp://127.0.0.1:9")


def test_a_scheduler_that_goes_away_costs_only_what_was_in_flight(cluster):
    address, scheduler = cluster
    asked, found = study(), []

    def run():
        for part in run_dask(asked.work, chunks(asked, range(12)), workers=None, address=address):
            found.append(part.number)
            scheduler.kill()

    with pytest.raises(wr.SimulationError, match="the scheduler of the cluster at .* has gone.*resume=True"):
        run()
    assert len(found) >= 1
