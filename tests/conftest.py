"""What tests of several wings stand on: kernels at hand, and an empty folder to stand in."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import examples_drawn  # noqa: F401  # its profile of Hypothesis is that of all tests
import pytest

# Commands that tests start read compiled modules, which the first of them writes: a start takes half the time.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
# Tests run side by side: threads of linear algebra would wait for each other, three times as long as one needs.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
PACKAGE = Path(__file__).parents[1] / "wirerope_mj"
COMPILE = "from wirerope_mj.cli import main; main()"


def pytest_sessionstart(session):
    """Compile kernels once, in two processes, before each worker would compile them all; a state that was compiled is known."""
    cache = getattr(session.config, "cache", None)
    if cache is None or hasattr(session.config, "workerinput"):
        return
    digest = hashlib.sha256(f"{sys.version} {os.environ.get('NUMBA_CACHE_DIR')}".encode())
    for content in (path.read_bytes() for path in sorted(PACKAGE.rglob("*.py"))):
        if b"njit" in content or b"inlined" in content:
            digest.update(content)
    if cache.get("wirerope/compiled", "") != digest.hexdigest():
        subprocess.run([sys.executable, "-c", COMPILE, "compile"], check=True, stdout=subprocess.DEVNULL)
        cache.set("wirerope/compiled", digest.hexdigest())


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Give each worker one half of the tests as they stand: fewer files are cut, whose fixtures both would make."""
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log) if config.getvalue("dist") == "load" else None


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path
