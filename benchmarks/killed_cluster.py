"""A study on a cluster to which everything happens: workers killed, the scheduler started again, a slow disk.

    python benchmarks/killed_cluster.py                     # 20 000 variants
    python benchmarks/killed_cluster.py --variants 200000 --kill-every 20 --slow 0.05

`wirerope study --engine dask` on a scheduler and four worker processes of this machine, which are started again when they are
gone, as a batch system does. Workers are killed (SIGKILL) at random instants, the scheduler when a third of the variants is
there, and every part of the table takes a random time to be written. Then the same study is computed by processes of this
machine that nobody disturbs. Each variant must have been written once, and both tables must be the same file, bit for bit.
The exit code says so. This file is the study, too.
"""

import argparse
import random
import resource
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

import wirerope_mj as wr
from wirerope_mj.cli import main as wirerope
from wirerope_mj.studies import study as computing
from wirerope_mj.studies.engines.compute import Part

WORKERS = 4
RESTART = 2.0
"""For so long the scheduler is away [s]."""
DASK = [sys.executable, "-m", "dask"]


def study(*, variants: int = 20_000) -> wr.Study:
    """Return a mass on one mount of a shock table.

    Args:
        variants: how many.
    """
    return wr.Study(
        model="shock_table.xml", motion=wr.HalfSine(peak=100.0, duration=0.011, direction="z"), duration=0.03, timestep=1e-3,
        variants=variants,
        vary={
            "mount/m1/axial/alpha": wr.Normal(1.0, 0.1, relative=True, low=0.5),
            "body/block/mass": wr.Uniform(0.9, 1.1, relative=True),
            "motion/level": wr.Uniform(0.5, 1.5),
        },
    )  # fmt: skip


class Cluster:
    """A scheduler and its workers, each started again within a second after it is gone."""

    def __init__(self, folder: Path, seed: int, kill_every: float) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.address, self.kills, self.restarts = f"tcp://127.0.0.1:{self.port}", 0, 0
        self._folder, self._random, self._kill_every = folder, random.Random(seed), kill_every
        self._ends = threading.Event()
        self._scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", str(self.port))
        while socket.socket().connect_ex(("127.0.0.1", self.port)):
            time.sleep(0.1)
        self._workers = [self._worker() for _ in range(WORKERS)]
        self._threads = [threading.Thread(target=work, daemon=True) for work in (self._watch, self._kill)]
        for thread in self._threads:
            thread.start()

    def restart_scheduler(self) -> None:
        self._scheduler.kill()
        self._scheduler.wait()
        time.sleep(RESTART)
        self._scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", str(self.port))
        self.restarts += 1

    def end(self) -> None:
        self._ends.set()
        for thread in self._threads:
            thread.join()
        for process in (*self._workers, self._scheduler):
            process.kill()
            process.wait()

    def _start(self, *words: str) -> subprocess.Popen[bytes]:
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.Popen([*DASK, *words, "--no-dashboard"], cwd=self._folder, **quiet)  # type: ignore[call-overload]

    def _worker(self) -> subprocess.Popen[bytes]:
        return self._start("worker", self.address, "--nthreads", "1", "--no-nanny", "--memory-limit", "0")

    def _watch(self) -> None:
        while not self._ends.wait(0.5):
            self._workers = [worker if worker.poll() is None else self._worker() for worker in self._workers]

    def _kill(self) -> None:
        while not self._ends.wait(self._random.expovariate(1.0 / self._kill_every)):
            self._random.choice(self._workers).kill()
            self.kills += 1


def disturbed(variants: int, folder: Path, seed: int, kill_every: float, slow: float) -> tuple[Counter[int], Cluster, float]:
    """Compute the study on a cluster: how often each part was written, the cluster, and the seconds."""
    written, chance, ordinary = Counter[int](), random.Random(seed), computing.write_part
    cluster = Cluster(folder, seed, kill_every)

    def write_part(place: Path, part: Part) -> None:
        time.sleep(chance.uniform(0.0, 2.0 * slow))
        ordinary(place, part)
        written[part.number] += 1
        if not cluster.restarts and 3 * sum(written.values()) * part.table.num_rows > variants:
            cluster.restart_scheduler()

    computing.write_part = write_part
    began = time.monotonic()
    try:
        code = wirerope(["study", __file__, "--variants", str(variants), "--engine", "dask", "--address", cluster.address,
                         "--out", str(folder / "disturbed")])  # fmt: skip
    finally:
        computing.write_part = ordinary
        cluster.end()
    if code:
        raise SystemExit(f"the study on the cluster ended with exit code {code}")
    return written, cluster, time.monotonic() - began


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--variants", type=int, default=20_000)
    parser.add_argument("--kill-every", type=float, default=5.0, help="seconds between kills, on average")
    parser.add_argument("--slow", type=float, default=0.02, help="seconds that a part takes to be written, on average")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        written, cluster, seconds = disturbed(asked.variants, folder, asked.seed, asked.kill_every, asked.slow)
        if wirerope(["study", __file__, "--variants", str(asked.variants), "--out", str(folder / "alone")]):
            raise SystemExit("the study on this machine failed")
        here, there = (folder / name / "variants.parquet" for name in ("disturbed", "alone"))
        table = pq.read_table(here, columns=["variant", "status"])
        once = set(written.values()) == {1} and np.array_equal(table["variant"], np.arange(asked.variants))
        done = set(table["status"].to_pylist()) == {"done"}
        same = here.read_bytes() == there.read_bytes()
    print(f"{asked.variants} variants in {len(written)} chunks, {seconds:.0f} s")
    print(f"{cluster.kills} workers killed, scheduler started again {cluster.restarts} times")
    print(f"each variant once: {once}; all computed: {done}; the bits of one machine: {same}")
    print(f"most memory of the process that asks: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB")
    return int(not (once and done and same))


if __name__ == "__main__":
    sys.exit(main())
