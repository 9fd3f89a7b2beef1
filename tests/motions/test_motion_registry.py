"""The registry of motions: names that are one thing each, and one list behind commands, files, stored runs and pages."""

import inspect
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from wirerope_mj.cli.shock import shock
from wirerope_mj.motions import BaseMotion, motion_from_dict
from wirerope_mj.motions.registry import BY_KIND, REGISTERED, SPOKEN_MOTIONS, motion_from_phrase, motion_from_words
from wirerope_mj.runs.job_file import load_job

pytestmark = pytest.mark.quick

ROOT = Path(__file__).parents[2]
FILES = {
    "transport.csv": "frequency [Hz], psd [g^2/Hz]\n5, 0.01\n200, 0.01\n",
    "floor.csv": "frequency [Hz], acceleration [g]\n1, 0.5\n5, 1\n33, 0.4\n",
    "rrs.csv": "frequency [Hz], acceleration [g]\n1, 0.5\n5, 1\n33, 0.4\n",
    "levels.csv": "from [Hz], to [Hz], displacement [mm]\n4, 15, 0.76\n16, 25, 0.51\n",
    "start.csv": "time [ms], fz [kN], mx [N.m]\n0, 0, 0\n10, 2, 30\n20, 0, 0\n",
}


def concrete(motion):
    every = {one for part in motion.__subclasses__() for one in concrete(part)}
    return every if inspect.isabstract(motion) else every | {motion}


def test_every_motion_is_registered_under_a_name_of_its_own():
    shipped = {motion for motion in concrete(BaseMotion) if motion.__module__.startswith("wirerope_mj.motions")}
    assert shipped == set(BY_KIND.values())
    assert len(BY_KIND) == len(shipped)
    said = Counter(form.name for motion in REGISTERED for form in motion.phrases)
    assert set(said.values()) == {1}


@pytest.mark.parametrize("kind", SPOKEN_MOTIONS)
def test_what_a_phrase_says_is_stored_and_said_alike_everywhere(tmp_path, monkeypatch, kind):
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    form = SPOKEN_MOTIONS[kind]
    motion = motion_from_phrase(kind, form.example, folder=tmp_path)
    restored = motion_from_dict(motion.to_dict())
    time = np.linspace(0.0, min(motion.end, 5.0), 50)
    assert restored.to_dict() == motion.to_dict()
    assert restored.displacement(time).tobytes() == motion.displacement(time).tobytes()
    assert motion_from_words(f"{kind} {form.example}").to_dict() == motion.to_dict()


@pytest.mark.parametrize("kind", SPOKEN_MOTIONS)
def test_commands_files_and_pages_have_every_phrase(tmp_path, kind):
    form = SPOKEN_MOTIONS[kind]
    assert (form.option or kind).replace("-", "_") in inspect.signature(shock).parameters
    job = tmp_path / "job.toml"
    job.write_text(f'name = "j"\nmodel = "shock_table"\n[[case]]\nname = "c"\n{kind} = "nonsense"\n', encoding="utf-8")
    with pytest.raises(Exception, match=f'{kind} "nonsense"'):
        load_job(job)
    assert f"`--{form.option or kind}`" in (ROOT / "docs/shock.md").read_text(encoding="utf-8")
    assert not form.option or f"`{kind}` for `--{form.option}`" in (ROOT / "docs/toml_files.md").read_text(encoding="utf-8")
