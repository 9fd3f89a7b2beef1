"""Run folders that were edited or damaged on their way, used as a colleague's folder is: read, replayed, reported, compared."""

import contextlib
import functools
import io
import json
import shutil
import tempfile
import warnings
from pathlib import Path
from unittest import mock

import numpy as np
from campaign import Case
from folder_files import KINDS

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge, summary
from wirerope_mj.cli.compare import compare
from wirerope_mj.runs import replay, run_scenario
from wirerope_mj.runs.folder import CHECKSUMS, write_checksums
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.sources import run_inputs

TEXT = """
<mujoco>
<option gravity="0 0 -9.80665"/>
<default><geom contype="0" conaffinity="0"/></default>
<worldbody>
<body name="deck"><joint name="deck_x" type="slide" axis="1 0 0"/><joint name="deck_z" type="slide" axis="0 0 1"/>
<geom size=".1" mass="5"/><site name="b" pos="0 0 .2"/></body>
<body name="mass" pos="0 0 .3"><joint name="mass_x" type="slide" axis="1 0 0"/><joint name="mass_z" type="slide" axis="0 0 1"/>
<geom type="box" size=".1 .1 .1" mass="30"/><site name="p" pos="0 0 -.1"/><site name="point/top" pos="0 0 .1"/></body>
</worldbody>
<custom><text name="isolator/a" data="a.toml"/>
<tuple name="mount/m1"><element objtype="site" objname="p"/><element objtype="site" objname="b"/>
<element objtype="text" objname="isolator/a"/></tuple>
<numeric name="limit/acceleration/mass" data="60"/></custom>
</mujoco>"""


def isolator() -> wr.Isolator:
    law = wr.BoucWen(alpha=1e5, beta=700.0, gamma=300.0, n=1.2, k=3e4)
    limits = {"static_load": 900.0, "travel": {"compression": 0.03, "shear": 0.02, "roll": 0.02}}
    return wr.Isolator.from_dict({
        "name": "a", "axial": {"law": "bouc-wen", **{k: getattr(law, k) for k in ("alpha", "beta", "gamma", "n", "k")}},
        "roll": {"law": "kelvin-voigt", "k": 3e4, "c": 200.0}, "limits": limits, "geometry": {"height": 0.1, "width": 0.1},
        "provenance": {"kind": "illustrative", "source": "made up"},
    })  # fmt: skip


@functools.cache
def runs() -> tuple[Path, Path]:
    """Return two small runs, made once in a process: of a pulse, and of a sum of a pulse and random vibration."""
    place = Path(tempfile.mkdtemp(prefix="fuzz-runs-"))
    shock = wr.HalfSine(peak=60.0, duration=0.01, direction="z", start=0.005)
    noise = wr.RandomVibration(psd=[(5.0, 0.1), (50.0, 0.1)], duration=0.5, seed=3, direction="x")
    simulate = {"duration": 0.05, "timestep": 1e-3, "sample_rate": 500.0}
    for name, motion in (("one", shock), ("other", shock + noise)):
        scenario = Scenario(
            question="How far?",
            model=TEXT,
            motion=motion,
            simulate=simulate,
            isolators={"a": isolator()},
            name=name,
            options={"level": 6.0},
        )
        with mock.patch("wirerope_mj.runs.write._write_views"):  # nothing reads them again
            run_scenario(scenario, place / name)
    return place / "one", place / "other"


def mutate(rng: np.random.Generator, folder: Path) -> Case:
    """Write a run and mutate one of its files; its checksums stay as they were, are removed, or are made anew."""
    run, other = runs() if rng.random() < 0.7 else reversed(runs())
    target = Path(shutil.copytree(run, folder / "run"))
    words, names, changed = KINDS[rng.integers(len(KINDS))](rng, target, other)
    sums = "kept" if words.startswith("checksums") else str(rng.choice(["kept", "removed", "anew"]))
    if sums != "kept":
        (target / CHECKSUMS).unlink()
    if sums == "anew":
        write_checksums(target)
    act = str(rng.choice(["read", "replay", "report", "compare"], p=[0.42, 0.5, 0.03, 0.05]))
    inputs = {"run": target, "beside": run, "act": act, "sums": sums, "changed": changed}
    return Case(f"{act}, checksums {sums}: {words}", inputs, (*names, "the model file", "the record"))


def use(case: Case) -> str | None:
    """Read, replay, report or compare the run; complain of what is accepted and cannot be right."""
    return globals()[f"_{case.inputs['act']}"](case)


def _read(case: Case) -> str | None:
    response = wr.load_response(case.inputs["run"])
    for part in (*response.bodies.values(), *response.points.values()):
        assert np.isfinite(np.hstack([part.position, part.acceleration])).all()
    for part in response.mounts.values():
        assert np.isfinite(np.hstack([part.deflection, part.force, part.hysteretic_state])).all()
    wrong = [verdict for verdict in judge(response) if not np.isfinite(verdict.value)]
    json.dumps(summary(response, judge(response)), allow_nan=False)
    run_inputs(case.inputs["run"])
    return f"{wrong[0]}" if wrong else None


def _replay(case: Case) -> str | None:
    result = replay(case.inputs["run"])
    if case.inputs["sums"] == "kept" and (result.intact or result.alterations is None):
        return "altered, and replay says that nothing was"
    if case.inputs["changed"] and result.identical:
        return "a number was changed, and replay says that all are identical"
    if case.inputs["changed"] and result.agrees and "tiny" not in case.mutation:
        return f"a number was changed, and replay says that they agree ({result.largest_difference:.3g} in {result.column})"
    return None


def _report(case: Case) -> str | None:
    from wirerope_mj.runs.report import write_report

    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        (page,) = write_report(case.inputs["run"])
    return _unsaid(case, said) or (None if page.stat().st_size > 1000 else "the page is empty")


def _compare(case: Case) -> str | None:
    target = case.inputs["run"].parent / "both.rrd"
    with warnings.catch_warnings(record=True) as said, contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("always")
        compare(case.inputs["run"], case.inputs["beside"], out=target)
    return _unsaid(case, said) or (None if target.stat().st_size else "the recording is empty")


def _unsaid(case: Case, said: list[warnings.WarningMessage]) -> str | None:
    """Return a complaint unless a warning says that a file was altered."""
    told = any("Since the run was written" in str(one.message) for one in said)
    return None if told or case.inputs["sums"] != "kept" else "altered, and no warning says so"
