"""Files of studies with other inputs than those they were written with, under the digest of these."""

import shutil
import tempfile
import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import tomli_w
from campaign import Case
from edits import anywhere, damaged, edit
from hostile import pick

import wirerope_mj as wr
from wirerope_mj.studies.inputs_file import STUDY, identity, write_inputs


@cache
def folder_of_study() -> Path:
    """Return the folder of a study of two variants, written once a process."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-study-")) / "study"
    pulse = wr.HalfSine(peak=10.0, duration=0.01, direction="z")
    vary = {"motion/level": wr.Uniform(0.5, 1.5), "body/mass/mass": wr.Normal(1.0, 0.1, relative=True, low=0.5)}
    study = wr.Study(model="sdof_shaker", motion=pulse, duration=0.02, timestep=1e-3, vary=vary, variants=2)
    folder.mkdir()
    (folder / STUDY).write_text(tomli_w.dumps(write_inputs(study, folder, "peaks", None)), encoding="utf-8")
    return folder


def mutate(rng: np.random.Generator, folder) -> Case:
    """Edit one or two values of the file, or damage its bytes."""
    study = folder / "study"
    shutil.copytree(folder_of_study(), study)
    path = study / STUDY
    if rng.random() < 0.15:
        path.write_bytes(damaged(rng, path.read_bytes()))
        return Case("bytes", {"folder": study}, (STUDY, "study"))
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    done = []
    for _ in range(pick(rng, (1, 1, 2))):
        first = pick(rng, [key for key in content if key != "id"] + ["vary", "motions", "simulate", "sampling"])
        if first not in content:
            continue
        holder, key, where = anywhere(rng, content, first)
        done.append(f"{where}: {edit(rng, holder, key, toml=True)}")
    if rng.random() < 0.9:  # else the digest says so
        content["id"] = identity(content)
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    return Case("; ".join(done), {"folder": study}, (STUDY, "study", "vary", "model", "variants"))


def use(case: Case) -> str | None:
    """Read the study, its inputs, its systems and motions."""
    result = wr.load_study(case.inputs["folder"])
    study = result.study
    table = study.table()
    for name in table.column_names:
        column = table[name].to_numpy()
        if column.dtype.kind == "f" and not np.isfinite(column).all():
            return f"{name} is not finite"
    if study.size:
        study.system(0), study.motion(0)
    return None
