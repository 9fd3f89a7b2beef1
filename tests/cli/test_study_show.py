"""`wirerope show` of a study: the worst variants that were written, or how to write them."""

import pytest
from small_study import write_study

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.views.recording.viewer import find_recording


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return the folder of a study without its worst variants, with the command that made it."""
    place = tmp_path_factory.mktemp("studies")
    command = ["study", str(write_study(place)), "--variants", "8", "--workers", "1", "--out", str(place / "out")]
    assert main(command) == 0
    return place / "out", command


@pytest.mark.slow
def test_the_worst_variants_are_opened_once_they_are_there(folder, capsys):
    folder, command = folder
    assert main(["show", str(folder)]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "none of its variants was written as a run. Write the worst with the command that computed it" in message
    assert f"--resume --out {folder} --open-worst 3" in message
    assert main([*command, "--resume", "--open-worst", "1"]) == 0
    (run,) = (folder / "worst").iterdir()
    assert find_recording(folder) == run / "run.rrd"
    assert main([*command, "--resume", "--open-worst", "2"]) == 0
    assert find_recording(folder) == folder / "worst" / "worst.rrd"
    (folder / "worst" / "worst.rrd").unlink()
    with pytest.raises(wr.RecordError, match="several variants of this study were written one by one; open one: .*variant-"):
        find_recording(folder)
