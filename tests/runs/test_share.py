"""A run as a folder that any web server shows."""

import json
import re
import shutil
from pathlib import Path

import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.runs.report import share_run
from wirerope_mj.runs.scenario import load_scenario


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "table"
    wr.run_scenario(load_scenario("shock_table").make(duration=0.12, level_g=60.0), folder)
    return folder


@pytest.fixture(scope="module")
def shared(run, tmp_path_factory):
    out = tmp_path_factory.mktemp("shared") / "out"
    share_run(run, out)
    return out


def test_the_folder_holds_report_recording_and_viewer(run, shared):
    assert {str(path.relative_to(shared)) for path in shared.rglob("*") if path.is_file()} == {
        "index.html", "run.rrd", "viewer/index.html", "viewer/show.js", "viewer/re_viewer.js", "viewer/re_viewer_bg.wasm",
    }  # fmt: skip
    assert (shared / "run.rrd").read_bytes() == (run / "run.rrd").read_bytes()
    assert (shared / "viewer" / "re_viewer_bg.wasm").read_bytes().startswith(b"\0asm")


def test_every_verdict_with_an_instant_opens_the_timeline_there(run, shared):
    page = (shared / "index.html").read_text(encoding="utf-8")
    links = re.findall(r'data-instant="([^"]*)"><a href="viewer/index\.html#([^"]*)" target="viewer">', page)
    assert links
    assert all(one == other for one, other in links)
    instants = {float(instant) for instant, _ in links}
    judged = json.loads((run / "summary.json").read_text(encoding="utf-8"))["judged"]
    timed = {row["time_s"] for row in judged if row["limit"] is not None and row["time_s"] is not None}
    assert timed
    assert timed <= instants


def test_no_page_asks_another_server_for_anything(shared):
    own = [shared / "index.html", shared / "viewer" / "index.html", shared / "viewer" / "show.js"]
    for path in own:
        text = path.read_text(encoding="utf-8").replace("http://www.w3.org/2000/svg", "")
        assert not re.search(r"(src|href)=\"(?!data:|#|viewer/|re_viewer\.js|show\.js)", text), path
        assert "http://" not in text, path
        assert "https://" not in text, path
    assert "default-src 'none'" in own[1].read_text(encoding="utf-8")


def test_what_cannot_be_shared_is_said_in_one_line(run, shared, tmp_path, capsys):
    with pytest.raises(RecordError, match="inside the run"):
        share_run(run, run / "out")
    with pytest.raises(RecordError, match=r"no report\.html here to share"):
        share_run(tmp_path, tmp_path / "out")
    assert main(["share", str(run), str(shared)]) == 2
    assert "--force" in capsys.readouterr().err
    assert main(["share", str(run), str(shared), "--force"]) == 0
    assert "MB" in capsys.readouterr().out


def test_what_a_link_leads_to_is_not_shared(run, tmp_path, capsys):
    copy = Path(shutil.copytree(run, tmp_path / "run"))
    (tmp_path / "secret").write_text("secret")
    for name in ("report.html", "run.rrd"):
        there = (copy / name).read_bytes()
        (tmp_path / "secret").write_bytes(there)
        (copy / name).unlink()
        (copy / name).symlink_to(tmp_path / "secret")
        assert main(["share", str(copy), str(tmp_path / "out")]) == 2
        assert f"{name}: this is a link" in capsys.readouterr().err
        assert not (tmp_path / "out").exists()
        (copy / name).unlink()
        (copy / name).write_bytes(there)
    assert main(["share", str(copy), str(tmp_path / "out")]) == 0


@pytest.mark.parametrize("name", ["report.html", "run.rrd"])
def test_what_was_altered_is_not_shared_and_a_report_made_anew_is(run, tmp_path, capsys, name):
    copy = Path(shutil.copytree(run, tmp_path / "run"))
    with (copy / name).open("ab") as file:
        file.write(b"<script>alert(1)</script>")
    assert main(["share", str(copy), str(tmp_path / "out")]) == 2
    assert f"{name} was altered or added since the run was written, and is not shared" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    if name == "report.html":
        assert main(["report", str(copy), "--force"]) == 0
        assert main(["share", str(copy), str(tmp_path / "out")]) == 0
        assert "alert(1)" not in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
