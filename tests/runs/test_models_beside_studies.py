"""A relative path of a study's model starts at the folder of the study's file, then at the current one."""

import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.runs.study import load_study_file

pytestmark = pytest.mark.quick
STUDY = """import wirerope_mj as wr


def study(*, variants: int = 2) -> wr.Study:
    pulse = wr.HalfSine(peak=150.0, duration=0.011, direction="z")
    levels = {"motion/level": wr.Uniform(0.9, 1.1)}
    return wr.Study(model="mine.xml", motion=pulse, duration=0.1, vary=levels, variants=variants)
"""


def model(path, mass):
    text = (models_folder() / "shock_table.xml").read_text(encoding="utf-8")
    assert 'mass="' in text
    path.write_text(text.replace('<mujoco model="shock_table"', f'<mujoco model="of_{mass}"'), encoding="utf-8")


def test_the_model_beside_a_study_comes_before_that_of_the_current_folder(tmp_path, monkeypatch):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "study.py").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    model(tmp_path / "mine.xml", "here")
    assert load_study_file("there/study.py").make().base.path == tmp_path / "mine.xml"
    model(tmp_path / "there" / "mine.xml", "there")
    assert load_study_file("there/study.py").make().base.path == tmp_path / "there" / "mine.xml"
    assert wr.check("there/study.py") == ()


def test_a_model_that_is_nowhere_is_said_with_both_folders(tmp_path, monkeypatch):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "study.py").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(wr.ModelError, match=r"mine\.xml' in \S+there or \S+ and none that ships"):
        load_study_file("there/study.py").make()
    pulse = wr.HalfSine(peak=9.0, duration=0.011, direction="z")
    with pytest.raises(wr.ModelError, match=r"mine\.xml' in \S+ and none that ships"):  # no file is executed any more
        wr.Study(model="mine.xml", motion=pulse, duration=0.1, vary={}, variants=2)
