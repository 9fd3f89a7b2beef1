"""The local engine of studies: processes side by side on one machine, each on one thread with a batch of variants."""

import pickle
import queue
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from functools import partial
from typing import Any, Generic, TypeVar, cast

from wirerope_mj.foundation.errors import SimulationError
from wirerope_mj.foundation.interrupts import at_end
from wirerope_mj.foundation.processes import environment_of_children, processors
from wirerope_mj.studies.engines.compute import Chunk, Part, compute, failed_part
from wirerope_mj.studies.vary.variants import Work

_PATIENCE = 0.2  # time between two looks whether to stop [s]
TRIES = 2  # Tries of a chunk whose process dies: the first death may have been an accident

_started: "weakref.WeakSet[subprocess.Popen[bytes]]" = weakref.WeakSet()
_ending = threading.Event()


def _end_all() -> None:
    """End all workers as this process exits: a worker that is still starting would notice only seconds later."""
    _ending.set()
    for process in list(_started):
        process.kill()


at_end(_end_all, early=True)

Question = TypeVar("Question")
Answer = TypeVar("Answer")


class WorkerDiedError(Exception):
    """A process ended in the middle of a chunk."""


def run_local(
    work: Work, chunks: Iterable[Chunk], *, workers: int | None = None, address: str | None = None
) -> Generator[Part, None, None]:
    """Compute chunks in this process and others, and yield their parts as they are ready; `address` is ignored."""

    def lost(chunk: Chunk, reason: str) -> Part:
        return failed_part(
            work,
            chunk,
            f"the process that computed this chunk of variants {reason}, {TRIES} times in a row. It may have run out of "
            "memory: go on with --resume (`resume=True`), which computes it again, and with fewer --workers (`workers`).",
        )

    yield from in_processes(partial(compute, work), chunks, lost=lost, workers=workers)


def in_processes(
    function: Callable[[Question], Answer], questions: Iterable[Question], *, lost: Callable[[Question, str], Answer],
    workers: int | None = None, stop: threading.Event | None = None,
) -> Generator[Answer, None, None]:  # fmt: skip
    """Call a module's function with each question in worker processes; yield the answers as they are ready, in any order.

    All three are pickled. Questions are read as processes become free; a single worker is this process. `lost` answers a
    question during which a process died `TRIES` times; its second argument says how. Processes end, in the middle of a
    question, once `stop` is set.
    """
    workers = processors() if workers is None else workers
    if workers == 1:
        for question in questions:
            yield function(question)
        return
    yield from _Pool(function, questions, lost, workers, stop or threading.Event()).results()


def futures_of_processes(
    function: Callable[[Question], Answer], questions: Sequence[Question], stop: threading.Event | None = None
) -> list[Future[Answer | str]]:
    """Have other processes answer questions as `in_processes` does, and return at once: a future is done with each answer.

    One whose process is lost is answered by a sentence that says so. One processor is left to this process if there are more.
    Once `stop` is set, the futures without an answer are cancelled.
    """
    futures = [Future[Answer | str]() for _ in questions]
    asked = cast("Callable[[Question], Answer | str]", function)

    def wait() -> None:
        lost, waiting = (lambda _, why: f"Its process {why} each time."), iter(futures)
        try:
            for answer in in_processes(asked, questions, lost=lost, workers=max(2, processors() - 1), stop=stop):
                next(waiting).set_result(answer)
        except BaseException as error:
            next(waiting).set_exception(error)
        for future in waiting:
            future.cancel()

    threading.Thread(target=wait, daemon=True).start()
    return futures


class _Pool(Generic[Question, Answer]):
    """One thread for each worker process: it hands out questions, and starts the process again if it dies."""

    def __init__(
        self, function: Callable[[Question], Answer], questions: Iterable[Question], lost: Callable[[Question, str], Answer],
        workers: int, stop: threading.Event,
    ) -> None:  # fmt: skip
        self._questions, self._lost, self._workers = iter(questions), lost, workers
        self._pickled = pickle.dumps(function, protocol=pickle.HIGHEST_PROTOCOL)
        self._lock, self._stop = threading.Lock(), stop
        # A slow reader holds the workers up, so that memory does not grow.
        self._done: queue.Queue[Answer | BaseException | None] = queue.Queue(maxsize=2 * workers)
        self._processes: list[_Process | None] = [None] * workers

    def results(self) -> Generator[Answer, None, None]:
        """Yield the answers; threads and processes end when all are there, `stop` is set, or the generator is closed."""
        threads = [threading.Thread(target=self._serve, args=(n,), daemon=True) for n in range(self._workers)]
        for thread in threads:
            thread.start()
        try:
            running = self._workers
            while running and not self._stop.is_set():
                try:
                    result = self._done.get(timeout=_PATIENCE)
                except queue.Empty:
                    continue
                if isinstance(result, BaseException):
                    raise result
                if result is None:
                    running -= 1
                else:
                    yield result
        finally:
            self._stop.set()
            for thread in threads:
                while thread.is_alive():
                    for process in filter(None, self._processes):
                        process.end()
                    while not self._done.empty():  # a thread may wait for a place
                        self._done.get_nowait()
                    thread.join(timeout=0.05)

    def _serve(self, number: int) -> None:
        """Have worker process `number` answer questions until none is left; queue the answers, then None, or an error."""
        try:
            while not self._stop.is_set():
                with self._lock:
                    question = next(self._questions, None)
                if question is None:
                    break
                answer = self._answer(number, question)
                if not self._stop.is_set():
                    self._done.put(answer)
            self._done.put(None)
        except BaseException as error:
            self._done.put(error)
        finally:
            process = self._processes[number]
            if process is not None:
                process.kill()

    def _answer(self, number: int, question: Question) -> Answer:
        """Have worker process `number`, started again where it died, answer a question; after `TRIES` deaths `lost` does."""
        reason = ""
        for _ in range(TRIES):
            try:
                process = self._processes[number] = self._processes[number] or _Process(self._pickled)
                return process.compute(question)
            except WorkerDiedError as death:
                reason, self._processes[number] = str(death), None
                if self._stop.is_set():
                    break
        return self._lost(question, reason)


class _Process:
    """A worker process and its pipes."""

    def __init__(self, pickled_function: bytes) -> None:
        if _ending.is_set():
            raise WorkerDiedError("has ended with the process that asks")
        environment = environment_of_children()
        # One thread each: more of them would fight for the processors that the other processes have.
        environment |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
        # A session of its own: Ctrl-C is for the process that started this one, which ends it.
        self._process = subprocess.Popen(
            [sys.executable, "-m", "wirerope_mj.studies.engines.worker"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment, start_new_session=True,
        )  # fmt: skip
        _started.add(self._process)
        try:
            self._asked(pickled_function)
        except WorkerDiedError as death:
            raise SimulationError(
                f"a worker process could not start: it {death}. Its own message stands on standard error; with one of "
                "`workers` all is computed in this process."
            ) from None

    def compute(self, question: object) -> Any:
        return self._asked(pickle.dumps(question, protocol=pickle.HIGHEST_PROTOCOL))

    def _asked(self, question: bytes) -> object:
        """Send a pickled question and wait for its answer; WorkerDiedError if the process ends first."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(question)
            self._process.stdin.flush()
            return pickle.load(self._process.stdout)
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(timeout=5.0)
            code = self._process.poll()
            self.kill()
            ending = "" if code is None else f" (signal {-code})" if code < 0 else f" (exit status {code})"
        raise WorkerDiedError(f"died{ending}") from None

    def end(self) -> None:
        """End the process; a thread that waits for it finds it dead."""
        self._process.kill()

    def kill(self) -> None:
        """End the process and close its pipes."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with suppress(OSError):  # what was not yet written has nobody to read it
                    pipe.close()
