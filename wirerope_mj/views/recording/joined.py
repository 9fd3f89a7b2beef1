"""Recordings of several runs in one file: the viewer lists them and switches from one to another."""

import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.views.recording.viewer import viewer_binary


def join_recordings(recordings: Sequence[Path], target: Path) -> None:
    """Write recordings into one file, each as it is.

    Raises:
        RecordError: one of them is missing or damaged.
        WireRopeError: rerun-sdk is incomplete.
    """
    with atomic_file(target) as temporary:
        command = [str(viewer_binary()), "rrd", "merge", "-o", str(temporary), *map(str, recordings)]
        done = subprocess.run(command, env={**os.environ, "CI": "1"}, capture_output=True, text=True, check=False)
        if done.returncode != 0 or not temporary.stat().st_size:
            said = " ".join(done.stderr.split()[-40:])
            raise RecordError(f"{target}: the recordings could not be joined: {said}")
