"""Every command that writes, where no file may grow beyond what it needs: one message, exit code 2, whole files or none."""

import shutil

import pytest
from writing_commands import FIRST, GOES_ON, NOTHING, WRITING, files, prepare

from wirerope_mj.cli import main
from wirerope_mj.cli.app import COMMANDS

pytestmark = pytest.mark.slow

resource = pytest.importorskip("resource", reason="Windows has no limits of file sizes")


def test_every_command_that_writes_is_here():
    assert {words[0] for words in WRITING.values()} | NOTHING == set(COMMANDS)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Return a folder with all that the commands read, and what those wrote that others read."""
    folder = tmp_path_factory.mktemp("full")
    prepare(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for name in FIRST:
            assert main(WRITING[name]) == 0
    return folder


def limited(words, size):
    """Run a command here while no file may be larger [bytes]: that meets the same errors as a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        return main(words)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("name", WRITING)
def test_a_full_disk_is_one_message_and_leaves_whole_files(name, place, tmp_path, monkeypatch, capsys):
    folder, words = tmp_path / "work", WRITING[name]
    shutil.copytree(place, folder, symlinks=True)
    monkeypatch.chdir(folder)
    monkeypatch.setattr("sys.dont_write_bytecode", True)  # Python itself cuts short what it compiles of modules
    first = {path.stat().st_ino for path in files(folder)}
    assert main(words) in (0, 1)
    whole = files(folder)
    sizes = sorted({path.stat().st_size for path in whole if path.stat().st_ino not in first})
    capsys.readouterr()
    for size in (0, sizes[-1] // 2):
        before = files(folder)
        assert limited(words, size) == 2
        told = [line for line in capsys.readouterr().err.splitlines() if "the peaks and verdicts above hold" not in line]
        assert told
        assert "there is no space left" in told[-1]
        assert "Errno" not in told[-1]
        assert not [path for path in folder.rglob(".*wirerope*") if "wirerope" in path.name]
        if name not in GOES_ON:
            assert files(folder) == before
    if name in GOES_ON:
        assert main([word for word in words if word != "--force"]) == 0
        assert {path.name for path in files(folder)} >= {path.name for path in whole}
