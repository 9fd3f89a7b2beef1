"""A process that computes chunks: reads them from its standard input and writes their tables to its standard output.

It is started by `wirerope_mj.study.local` as a module of its own, so that it never runs the script that asked for the study:
such a script needs no guard. It ends with its input, and so with the process that started it.
"""

import os
import pickle
import signal
import sys
from typing import BinaryIO

from wirerope_mj.study.compute import compute


def main() -> None:
    """Serve chunks until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that started this one
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints must not disturb the answers
    serve(sys.stdin.buffer, answers)


def serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Answer every chunk with its table; the first question is the work that all of them share."""
    try:
        work = pickle.load(questions)
        while True:
            table = compute(work, pickle.load(questions))
            pickle.dump(table, answers, protocol=pickle.HIGHEST_PROTOCOL)
            answers.flush()
    except (EOFError, BrokenPipeError):
        return


if __name__ == "__main__":
    main()
