"""A process that answers questions: reads them from its standard input and writes the answers to its standard output.

It is started by the local engine as a module of its own, so that it never runs the script that asked for the study: such a
script needs no guard. It ends with its input, and so with the process that started it, however that ends: at once, in the
middle of a chunk, too, so that it takes neither processors nor memory from a study that goes on.
"""

import os
import pickle
import queue
import signal
import threading
import traceback
from typing import Any, BinaryIO


def main() -> None:
    """Answer questions until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where a session of its own is not known
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints must not disturb the answers
    serve(os.fdopen(os.dup(0), "rb"), answers)


def serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Read a pickled function, then questions, and answer each with the function's result; never returns."""
    asked: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(questions, asked), daemon=True).start()
    function = asked.get()
    _answer(answers, "ready")
    while True:
        _answer(answers, function(asked.get()))


def _read(questions: BinaryIO, asked: "queue.SimpleQueue[Any]") -> None:
    """Queue the questions, and end the process when the asking process has gone."""
    try:
        while True:
            asked.put(pickle.load(questions))
    except (EOFError, OSError, pickle.UnpicklingError):
        os._exit(0)  # the process that asked is gone, perhaps in the middle of a question
    except BaseException:  # the main thread would wait for ever
        traceback.print_exc()
        os._exit(1)


def _answer(answers: BinaryIO, content: object) -> None:
    try:
        pickle.dump(content, answers, protocol=pickle.HIGHEST_PROTOCOL)
        answers.flush()
    except BrokenPipeError:
        os._exit(0)  # nobody waits for it


if __name__ == "__main__":
    main()
