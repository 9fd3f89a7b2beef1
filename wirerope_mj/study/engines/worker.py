"""A process that computes chunks: reads them from its standard input and writes their parts to its standard output.

It is started by the local engine as a module of its own, so that it never runs the script that asked for the study: such a
script needs no guard. It ends with its input, and so with the process that started it.
"""

import os
import pickle
import signal
import sys
from typing import Any, BinaryIO

from wirerope_mj.study.engines.compute import compute


def main() -> None:
    """Serve chunks until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where a session of its own is not known
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints must not disturb the answers
    serve(sys.stdin.buffer, answers)


def serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Answer every chunk with its part; before them comes the work that all of them share."""
    try:
        work = pickle.load(questions)
        _answer(answers, "ready")
        while True:
            _answer(answers, compute(work, pickle.load(questions)))
    except (EOFError, BrokenPipeError):
        return


def _answer(answers: BinaryIO, what: Any) -> None:
    pickle.dump(what, answers, protocol=pickle.HIGHEST_PROTOCOL)
    answers.flush()


if __name__ == "__main__":
    main()
