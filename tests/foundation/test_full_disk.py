"""A disk that is full: one message, exit code 2, nothing left, and an end within seconds."""

import errno
import subprocess
import sys

import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.atomic_files import atomic_file, atomic_folder
from wirerope_mj.foundation.errors import DiskFullError
from wirerope_mj.runs.scenario import load_scenario

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limits of file sizes")

# A file that may not grow meets the same errors as one on a full disk, and needs neither a disk nor rights.
LIMITED = """
import resource, sys
from wirerope_mj.cli import main
from wirerope_mj.foundation.resources import models_folder
import wirerope_mj as wr

size, what, folder = int(sys.argv[1]), sys.argv[2], sys.argv[3]
sys.dont_write_bytecode = True  # Python itself cuts short what it compiles of modules, and reads that the next time
resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
if what == "recording":
    motion = wr.HalfSine(peak=100.0, duration=0.011, direction="z")
    response = wr.simulate(wr.load_system(models_folder() / "shock_table.xml"), motion, duration=0.05)
    try:
        wr.record_rerun(response, folder + "/run.rrd")
    except wr.RecordError as error:
        sys.exit(f"{type(error).__name__}: {error}")
sys.exit(main(["run", "shock_table", "--duration", "0.1", "--out", folder + "/run"] if what == "run" else what.split()))
"""


def limited(size, what, folder):
    """Return exit code and message of a process whose files may not be larger [bytes]; one that hangs is an error."""
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, str(size), what, folder], capture_output=True, text=True, timeout=300.0
    )
    return done.returncode, done.stderr


@pytest.mark.slow
def test_a_recording_that_finds_no_space_ends_with_an_error_and_leaves_nothing(tmp_path):
    code, told = limited(100_000, "recording", tmp_path)
    assert code == 1
    assert f"DiskFullError: {tmp_path}/run.rrd: there is no space left for it" in told
    assert list(tmp_path.iterdir()) == []


# Less than the model, than the samples, and than the recording.
@pytest.mark.slow
@pytest.mark.parametrize("size", [2_000, 30_000, 500_000])
def test_a_run_that_finds_no_space_is_one_message_and_nothing_is_left(tmp_path, size):
    code, told = limited(size, "run", tmp_path)
    assert code == 2
    *_, last = [line for line in told.strip().splitlines() if "the peaks and verdicts above hold" not in line]
    assert last.startswith(f"wirerope: {tmp_path}/run: there is no space left for it")
    assert "Free some space, or choose another place." in last
    assert "Traceback" not in told
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory):
    """Return a run that there was room for."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    wr.run_scenario(load_scenario("shock_table").make(duration=0.1), folder)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("before", [None, b"as it was"])
@pytest.mark.parametrize("name", ["o.fmu", "o.h5", "o.csv", "o.mat"])
def test_a_file_that_finds_no_space_is_one_message_and_what_was_there_stays(name, before, run_folder, tmp_path):
    target = tmp_path / name
    if before is not None:
        target.write_bytes(before)
    words = f"fmu shock_table {target} --force" if name == "o.fmu" else f"export {run_folder} {target} --force"
    code, told = limited(5_000, words, tmp_path)
    assert code == 2
    (line,) = told.strip().splitlines()
    assert line.startswith(f"wirerope: {target}: there is no space left for it")
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == ({} if before is None else {target: before})


@pytest.mark.parametrize("number", ["ENOSPC", "EDQUOT", "EFBIG"])
def test_the_error_names_the_place_that_people_know_and_not_the_hidden_one(tmp_path, number):
    def write():
        with (
            atomic_folder(tmp_path / "run", force=False, kind="run", marks=()) as folder,
            atomic_file(folder / "picture.png"),
        ):
            raise OSError(getattr(errno, number), "", "hidden")

    with pytest.raises(DiskFullError, match=r"/run: there is no space left for it") as told:
        write()
    assert "picture" not in str(told.value)
    assert list(tmp_path.iterdir()) == []


def test_other_errors_of_the_operating_system_are_left_as_they_are(tmp_path):
    with pytest.raises(FileNotFoundError), atomic_file(tmp_path / "a.txt"):
        (tmp_path / "absent").read_text()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize("size", ["256k", "1m"])
def test_a_run_into_a_small_file_system_ends_with_one_message(tmp_path, size):
    small = tmp_path / "small"
    small.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", small], capture_output=True).returncode:
        pytest.skip("only root may mount a small file system")
    try:
        code = "import sys; from wirerope_mj.cli import main; sys.exit(main())"
        words = ["run", "shock_table", "--out", str(small / "run")]
        done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, timeout=300.0)
        assert list(small.iterdir()) == []
    finally:
        subprocess.run(["umount", small], check=True)
    assert done.returncode == 2
    assert f"{small}/run: there is no space left for it (No space left on device)" in done.stderr
