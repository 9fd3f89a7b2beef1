"""Chunks on the workers of Dask: processes of this machine, or those of a cluster that is there already."""

import asyncio
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from itertools import chain
from typing import TYPE_CHECKING, Any

from wirerope_mj.foundation.errors import ClusterWarning, SimulationError
from wirerope_mj.foundation.processes import environment_of_children, processors
from wirerope_mj.studies.engines.compute import Chunk, Part, compute, failed_part
from wirerope_mj.studies.inputs_file import versions
from wirerope_mj.studies.vary.variants import Work

if TYPE_CHECKING:
    from distributed import Client, Future

# Longest time a scheduler may take to answer [s]: on a network that works it takes a fraction of a second.
PATIENCE = 5.0
# Chunks handed over per thread of a worker: one is computed, one lies ready, and no more stand in the scheduler's memory.
AHEAD = 2
# Further tries of a chunk whose worker died, as the local engine does; a cluster that exists has its own setting.
ATTEMPTS = 1
# Longest time in which workers of this machine start, or end without one another [s]: a busy machine imports slowly.
STARTING = 60.0
# Longest time for which a scheduler of a cluster that exists may be away, as where it is started again [s], and how often it
# may go while no chunk is done: what makes it go each time would do so for ever.
AWAY, LOSSES = 60.0, 5
_DEATH = (
    "the process that computed this chunk of variants died again and again. It may have run out of memory: go on with "
    "--resume (`resume=True`), which computes it again."
)
_SILENT: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)


def run_dask(
    work: Work, chunks: Iterable[Chunk], *, workers: int | None, address: str | None = None
) -> Generator[Part, None, None]:
    """Compute chunks with Dask, and yield their parts as they are ready, in any order.

    A worker that dies loses nothing: the scheduler gives what it had to another. A chunk that ends the life of its
    workers also where it is alone becomes rows that failed. At most `AHEAD` chunks per thread of the workers are handed
    over at a time. `workers` are processes of a cluster of this machine's own, `address` is that of a cluster's
    scheduler, tcp://HOST:8786; what was in flight when it went is handed over again if it is back within `AWAY`. ValueError
    if `workers` together with `address`, or Dask is not installed; SimulationError if no scheduler answers, it stays away,
    or its workers have other versions of the packages that compute.
    """
    check_cluster(workers, address)
    where = "this machine's own cluster" if address is None else f"the cluster at {address}"
    # Chunks to compute, those in flight, and those to compute alone: none is in two of them, and each leaves with its part.
    rest, running, suspects, losses = iter(chunks), dict[int, Chunk](), list[Chunk](), 0
    while True:
        try:
            with _client(workers, address) as client, _noticing_loss(client):
                if address is not None:
                    _warn_if_idle(client, address)
                here = _Cluster(client, work, where=where)
                for part in here.parts(rest, running, suspects.append):
                    losses = 0
                    yield part
                # Dask counts a death against all that waited there: only a chunk that is alone is its cause for certain.
                while suspects:
                    part = here.alone(suspects[0])
                    del suspects[0]
                    yield part
                return
        except (CancelledError, OSError) as error:
            losses += 1
            if address is None or losses > LOSSES or not _comes_back(address):
                text = f"the scheduler of {where} has gone; what is done is kept: go on with it with --resume (`resume=True`)."
                raise SimulationError(text) from error
            rest = chain(list(running.values()), rest)
            running.clear()


def check_cluster(workers: int | None, address: str | None) -> None:
    """Raise ValueError or SimulationError if Dask is not installed or the scheduler does not answer."""
    if find_spec("distributed") is None:
        raise ValueError("engine 'dask' needs Dask: pip install 'wirerope-mj[dask]'.")
    if address is not None and workers is not None:
        raise ValueError("`workers` belongs to a cluster of this machine's own; one at `address` has its own workers.")
    if address is not None:
        check_answers(address)


@contextmanager
def _noticing_loss(client: "Client") -> Iterator[None]:
    """Raise OSError in place of any error in the block if the client has lost its scheduler."""
    try:
        yield
    except Exception as error:
        if client.status == "running" or isinstance(error, SimulationError):
            raise
        raise OSError("the client has lost its scheduler") from error


def _comes_back(address: str) -> bool:
    """Wait for up to `AWAY` [s] until a scheduler answers at an address again; return whether one does."""
    began = time.monotonic()
    while time.monotonic() - began < AWAY:
        try:
            check_answers(address)
        except SimulationError:
            time.sleep(0.2)
        else:
            return True
    return False


class _Cluster:
    """Dask cluster, seen by its client, on whose workers chunks are computed."""

    def __init__(self, client: "Client", work: Work, *, where: str) -> None:
        self._client, self._work, self._where, self._versions = client, work, where, versions()

    def parts(self, chunks: Iterator[Chunk], running: dict[int, Chunk], suspect: Callable[[Chunk], None]) -> Iterator[Part]:
        """Yield the parts of chunks as they are ready; chunks computed where a worker died are reported as suspects.

        `running` holds by number the chunks that were handed over and have no part yet, also once the scheduler is lost.
        """
        from distributed import as_completed

        shared, done = self._shared(), as_completed(loop=self._client.loop)
        chunk_of: dict[Future, Chunk] = {}

        def hand_over() -> None:
            while len(running) < AHEAD * max(sum(self._client.nthreads().values()), 1):
                chunk = next(chunks, None)
                if chunk is None:
                    return
                running[chunk.number] = chunk
                future = self._submit(shared, chunk)
                chunk_of[future] = chunk
                done.add(future)

        hand_over()
        while running:
            future = next(done)
            part, chunk = self._part(future), chunk_of.pop(future)
            del running[chunk.number]
            if part is None:
                suspect(chunk)
            else:
                yield part
            hand_over()

    def alone(self, chunk: Chunk) -> Part:
        """Compute a chunk while nothing else runs; its part states it if workers die again."""
        part = self._part(self._submit(self._shared(), chunk))
        return failed_part(self._work, chunk, _DEATH) if part is None else part

    def _shared(self) -> "Future":
        """Submit the shared inputs as a task, not as scattered data: Dask makes them again if the worker that has them dies."""
        return self._client.submit(_handed_over, self._work, pure=False)

    def _submit(self, shared: "Future", chunk: Chunk) -> "Future":
        return self._client.submit(_computed, shared, chunk, self._versions, pure=False)

    def _part(self, future: "Future") -> Part | None:
        """Return the part of a chunk; None if its worker died too often."""
        from distributed import KilledWorker

        try:
            return future.result()
        except KilledWorker:
            return None
        except (ModuleNotFoundError, RuntimeError) as error:
            reason = error.__cause__ or error
            text = f"a worker of {self._where} cannot compute ({reason}); it must have the same wirerope-mj installed."
            raise SimulationError(text) from error


@contextmanager
def _client(workers: int | None, address: str | None) -> Iterator["Client"]:
    """Lend a client of the cluster at `address`, or of a cluster that exists during the block."""
    import dask.config
    from distributed import Client, LocalCluster

    with ExitStack() as open_things:
        if address is None:
            open_things.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": ATTEMPTS}))
            scheduler = LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=":0", silence_logs="CRITICAL")
            scheduler_at: str = open_things.enter_context(scheduler).scheduler_address
            processes = open_things.enter_context(_workers(scheduler_at, processors() if workers is None else workers))
        else:
            scheduler_at, processes = address, None
        client = open_things.enter_context(Client(scheduler_at, timeout=PATIENCE, set_as_default=False))
        if processes is not None and not _has_worker(client, STARTING, processes):
            raise SimulationError("Dask's workers do not start on this machine; use engine 'local'.")
        yield client


@contextmanager
def _workers(scheduler_at: str, number: int) -> Iterator["subprocess.Popen[bytes]"]:
    """Run worker processes of one thread each for the block; one that dies is started again."""
    # They are Dask's own command, not children that import the script that asked for the study: such a script needs no guard.
    command = [sys.executable, "-m", "dask", "worker", scheduler_at, "--nworkers", str(number), "--nthreads", "1",
               "--host", "127.0.0.1", "--no-dashboard", "--memory-limit", "0", "--death-timeout", f"{STARTING:g}"]  # fmt: skip
    with (
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen([*command, "--local-directory", folder], env=environment_of_children(), **_SILENT) as process,
    ):
        try:
            yield process
        finally:
            process.terminate()  # Dask ends the processes below it
            try:
                process.wait(timeout=STARTING)
            except subprocess.TimeoutExpired:
                process.kill()


def _has_worker(client: "Client", patience: float, processes: "subprocess.Popen[bytes] | None" = None) -> bool:
    """Wait for the first worker of a cluster for some time [s] while its processes live; return whether there is one."""
    began = time.monotonic()
    while not client.nthreads():
        if time.monotonic() - began > patience or (processes is not None and processes.poll() is not None):
            return False
        time.sleep(0.05)
    return True


def _warn_if_idle(client: "Client", address: str) -> None:
    """Warn if a cluster has no worker: those of a batch system may come much later."""
    if not _has_worker(client, PATIENCE):
        warnings.warn(f"the cluster at {address} has no workers yet; the study waits for them.", ClusterWarning, 2)


def check_answers(address: str) -> None:
    """Raise SimulationError unless a Dask scheduler answers at `address`."""
    from distributed.core import rpc
    from distributed.security import Security

    async def ask() -> str:
        keys = Security().get_connection_args("client")  # of Dask's own configuration, for tls://
        async with asyncio.timeout(PATIENCE), rpc(address, timeout=PATIENCE, connection_args=keys) as scheduler:
            return str((await scheduler.identity())["type"])

    try:
        # In a thread of its own: a notebook's thread has an event loop that runs already.
        with ThreadPoolExecutor(1) as thread:
            answer = thread.submit(asyncio.run, ask()).result()
    except Exception as error:  # what another service answers is read as anything, as exbibytes for instance
        text = f"no Dask scheduler answers at {address!r}; is it running, and is this its address (tcp://HOST:8786)?"
        raise SimulationError(text) from error
    if answer != "Scheduler":
        raise SimulationError(f"a Dask {answer.lower()} answers at {address!r}; give the address of the scheduler.")


def _handed_over(work: Work) -> Work:
    return work


def _computed(work: Work, chunk: Chunk, asked: dict[str, str]) -> Part:
    """Compute a chunk on a worker with the same package versions as the requesting process."""
    here = versions()
    differences = [f"{name} {here[name]} instead of {wanted}" for name, wanted in asked.items() if here[name] != wanted]
    if differences:
        raise SimulationError(
            f"a worker has {', '.join(differences)}, so that its rows would not be comparable: every worker needs the versions "
            "of the process that asks, and the same code of wirerope-mj. What is done is kept."
        )
    return compute(work, chunk)
