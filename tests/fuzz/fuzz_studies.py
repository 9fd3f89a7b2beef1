"""Studies: what varies, files of studies, service lives, options of frequency responses."""

import shutil
import tempfile
import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import tomli_w
from campaign import Case
from generators import NUMBERS, PYTHON_VALUES, damaged, edit, edited, finite, ignored, muddled, pick

import wirerope_mj as wr
from wirerope_mj.assessment.durability.mission import mission_damage, read_mission
from wirerope_mj.cli.frf import DEFAULT
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import order_bands
from wirerope_mj.foundation.directions import direction_in
from wirerope_mj.studies.inputs_file import STUDY, identity, write_inputs
from wirerope_mj.studies.vary.distributions import distribution_to_dict
from wirerope_mj.studies.vary.vary_option import read_vary

PHRASES = (
    "mount/m*/axial/alpha = Normal( 1 , 0.1 , relative, each)", "body/block/mass = Uniform( 0.8 , 1.2 , relative)",
    "motion/level = Uniform( 0.5 , 1.5 )", "motion/level = Choice( 1 , 2 , 3 )",
    "body/block/mass = Choice( 0.9 , 1.1 , relative)", "motion/level = Normal( 1 , 0.2 , low= 0.5 , high= 2 )",
    "motion/level = Uniform( 0.5 , 1.5 , points= 3 )", "body/block/mass = Normal( 1 , 0.05 , relative, group=ropes)",
    "motion/azimuth = Uniform( 0 , 90 )", "motion/elevation = Isotropic( -90 , 90 )",
)  # fmt: skip
COUNTS = (1, 3, 8, 16, None, 24, 32, 0, -1, 10**9, 10**12, 10**400, 2.0, True, "8", float("nan"))
SAMPLINGS = ("sobol", "latin-hypercube", "random", "grid", "list", "sobol-indices", "", None)


def columns(study):
    """Return a complaint if a number of a study's inputs is not finite, or its first variant is not made."""
    table = study.table()
    for name in table.column_names:
        column = table[name].to_numpy()
        if column.dtype.kind == "f" and not np.isfinite(column).all():
            return f"{name} is not finite"
    if study.size:
        study.system(0), study.motion(0)
    return None


def vary(rng, folder):
    """What varies, as `--vary` says it, with the number of variants, the sampling and the seed; the inputs are made."""
    texts = [muddled(rng, pick(rng, PHRASES)) for _ in range(int(rng.integers(1, 3)))]
    if rng.random() < 0.3:  # values behind the right words
        words = pick(rng, PHRASES).split(" ")
        for _ in range(int(rng.integers(1, 3))):
            words[pick(rng, [i for i, word in enumerate(words) if word[:1].isdigit()] or [-1])] = pick(rng, NUMBERS)
        texts = [" ".join(words)]
    arguments = {"variants": 8, "sampling": "sobol", "seed": 1}
    if rng.random() < 0.3:
        arguments["variants"] = pick(rng, COUNTS)
    if rng.random() < 0.3:
        arguments |= {"sampling": pick(rng, SAMPLINGS), "variants": pick(rng, COUNTS[:7])}
    if rng.random() < 0.1:
        arguments["seed"] = pick(rng, COUNTS)

    def use():
        pulse = wr.HalfSine(peak=10.0, duration=0.01, direction="x")
        kept = {"model": "shock_table", "motion": pulse, "duration": 0.01, "timestep": 1e-3}
        if complaint := columns(wr.Study(vary=read_vary(texts), **kept, **arguments)):
            return complaint
        plain = lambda text: [(key, distribution_to_dict(value)) for key, value in read_vary([text]).items()]  # noqa: E731
        return next(filter(None, (ignored(text, plain) for text in texts)), None)

    return Case(f"{texts!r:.150} {arguments!r:.80}", use)


@cache
def made_study():
    """Return the folder of a study of two variants, written once a process."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-study-")) / "study"
    pulse = wr.HalfSine(peak=10.0, duration=0.01, direction="z")
    vary = {"motion/level": wr.Uniform(0.5, 1.5), "body/mass/mass": wr.Normal(1.0, 0.1, relative=True, low=0.5)}
    study = wr.Study(model="sdof_shaker", motion=pulse, duration=0.02, timestep=1e-3, vary=vary, variants=2)
    folder.mkdir()
    (folder / STUDY).write_text(tomli_w.dumps(write_inputs(study, folder, "peaks", None)), encoding="utf-8")
    return folder


def studies(rng, folder):
    """The file of a study with other inputs than it was written with, most often under their digest; read, inputs made."""
    path = Path(shutil.copytree(made_study(), folder / "study")) / STUDY
    done, data = damaged(rng, path.read_bytes())
    if rng.random() < 0.85:
        content, done = tomllib.loads(path.read_text(encoding="utf-8")), ""
        for _ in range(pick(rng, (1, 1, 2))):
            first = pick(rng, [key for key in content if key != "id"] + ["vary", "motions", "simulate", "sampling"])
            done += f"; {edited(rng, content, first)}" if first in content else ""
        if rng.random() < 0.9:  # else the digest says so
            content["id"] = identity(content)
        data = tomli_w.dumps(content).encode()
    path.write_bytes(data)
    return Case(done, lambda: columns(wr.load_study(path.parent).study), (STUDY, "study", "vary", "model", "variants"))


@cache
def short_run():
    """Return the folder of a short run, written once a process."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-mission-"))
    sine = wr.Sine(frequency=8.0, acceleration=3.0, direction="z", duration=0.5)
    wr.simulate(wr.load_system("sdof_shaker"), sine, duration=0.6, timestep=1e-3).save(folder)
    return folder


def missions(rng, folder):
    """Service lives as files, for `wirerope durability`; the damage is counted."""
    stages = [{"run": str(short_run()), pick(rng, ("repetitions", "hours")): 10.0} for _ in range(int(rng.integers(1, 3)))]
    content = {"exponent": 4.0, "constant": 1e-3, "quantity": "deflection", "stage": stages}
    for _ in range(pick(rng, (0, 1, 1, 2))):
        holder = pick(rng, (content, content, *stages))
        if holder:
            edit(rng, holder, pick(rng, list(holder)))
    path, data = folder / "life.toml", tomli_w.dumps(content).encode()
    path.write_bytes(damaged(rng, data)[1] if rng.random() < 0.1 else data)

    def use():
        for damage in mission_damage(read_mission(path)):
            if complaint := finite(damage, ("total", "cycles", "largest_range")):
                return complaint
            if damage.cycles > 0.0 and damage.largest_range > 0.0 and not damage.total > 0.0:
                return "cycles without damage"
        return None

    return Case(f"{content!r:.200}", use, (path.name, "run", "folder", "exponent", "quantity"))


SYSTEM = cache(wr.load_system)
DIRECTIONS = ("x", "y", "z", "1,0,1", "0,0,0", "nan,1,1", "1e400,0,0", "-z", "", "xyz", "1,2", "1,2,3,4", "a,b,c")
PAYLOADS = ("mass", "block", "deck", "table", "nobody", "", None, 3)


def responses(rng, folder):
    """Options of frequency responses, checked as `wirerope frf` checks them; a few are computed."""
    options = {
        "accelerations": (1.0,), "method": "sweep", "direction": "z", "response_direction": None, "payload": None, "start": 2.0,
        "stop": 2.2, "rate": 60.0, "periods": 1, "largest_step": 0.02, "smallest_step": 1e-5, "smoothing": None,
    }  # fmt: skip
    strange = {
        "direction": DIRECTIONS, "response_direction": DIRECTIONS, "payload": PAYLOADS,
        "method": ("continuation", "both", "sweep", "", None, "Sweep"),
    }  # fmt: skip
    several = [tuple(pick(rng, (*PYTHON_VALUES, 1.0, 2.0)) for _ in range(int(rng.integers(0, 3)))) for _ in range(3)]
    for _ in range(pick(rng, (1, 1, 2))):
        name = pick(rng, list(options))
        options[name] = several[0] if name == "accelerations" else pick(rng, strange.get(name, PYTHON_VALUES))
    orders = several[1:] if rng.random() < 0.2 else None
    name, compute = pick(rng, ("sdof_shaker", "shock_table")), rng.random() < 0.02

    def use():
        for band in order_bands(*map(list, orders)) if orders else ():
            if not (np.isfinite([band.low, band.high]).all() and band.label):
                return "a band is not finite"
        said = {key: direction_in(options[key], key) for key in ("direction", "response_direction") if options[key] is not None}
        said["accelerations"] = tuple(options["accelerations"] or (DEFAULT,))
        checked = ResponseOptions(**options | said).checked(SYSTEM(name))
        low, high = checked.range
        if not (0.0 < low < high and np.isfinite([low, high, *checked.accelerations, checked.rate]).all()):
            return "the range is not finite"
        if compute and checked.method == "sweep" and high / low < 2.0 and checked.rate > 10.0:
            (level, *_) = frequency_response(SYSTEM(name), checked).levels
            return finite(level.up, ["amplitude"])
        return None

    names = (*options, "acceleration", "--orders", "--speed-rpm", "axes", "base", "moves", "sweep")
    return Case(f"{name} {options!r:.200} {orders}", use, names)
