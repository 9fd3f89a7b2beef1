"""Files that are written whole or not at all, and places where none can be."""

import pytest

from wirerope_mj.errors import RecordError
from wirerope_mj.whole import check_place, written_whole


def test_what_fails_leaves_nothing(tmp_path):
    def fail():
        with written_whole(tmp_path / "a.txt") as beside:
            beside.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_one_sentence_without_the_hidden_name(tmp_path, monkeypatch):
    def refuse(**_):
        raise PermissionError(13, "Permission denied", ".a.7lt3qll7.part.txt")

    monkeypatch.setattr("tempfile.mkstemp", refuse)
    place = written_whole(tmp_path / "a.txt")
    with pytest.raises(RecordError, match=r"a\.txt: cannot write here \(Permission denied\)\.$"):
        place.__enter__()


def test_places_are_refused_before_the_work(tmp_path, monkeypatch):
    check_place(tmp_path / "a.txt")
    with pytest.raises(RecordError, match="this is a folder"):
        check_place(tmp_path)
    with pytest.raises(RecordError, match=r"there is no folder '.*new'"):
        check_place(tmp_path / "new" / "a.txt")
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordError, match=r"there is no folder '.*file'"):
        check_place(tmp_path / "file" / "a.txt")
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(RecordError, match="cannot write here"):
        check_place(tmp_path / "a.txt")
