"""Runs: folders that were edited or damaged on their way, scenarios and their files, actions of a board."""

import atexit
import contextlib
import io
import json
import shutil
import tempfile
import tomllib
import warnings
from functools import cache
from pathlib import Path
from unittest import mock

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import tomli_w
from campaign import Case
from fuzz_devices import GUIDED, model
from generators import PYTHON_VALUES, TOML_VALUES, VALUES, damaged, edit, finite, pick, place

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge, summary
from wirerope_mj.cli.compare import compare
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.runs import replay, run_scenario
from wirerope_mj.runs.board.board import Board
from wirerope_mj.runs.board.opened import from_template, opened
from wirerope_mj.runs.folder import CHECKSUMS, write_checksums
from wirerope_mj.runs.report import write_report
from wirerope_mj.runs.scenario import Scenario, load_scenario, shipped_scenarios
from wirerope_mj.runs.scenario_file import judged_by, run_inputs
from wirerope_mj.runs.write import checked_arguments

SCENARIO, SUMMARY, RESPONSE, MODEL, ISOLATOR = (
    "scenario.toml",
    "summary.json",
    "response.parquet",
    "model/model.xml",
    "model/a.toml",
)
KEY = b"wirerope_mj"
REPLACED = (
    ('mass="30"', 'mass="31"'), ('mass="30"', 'mass="nan"'), ('pos="0 0 .3"', 'pos="0 0 .31"'), ("9.80665", "9.81"),
    ('name="box"', 'name="block"'), ('data="300"', 'data="6"'), ("point/top", "point/tip"), ("-.1", "-.10001"), ("m1", "m2"),
)  # fmt: skip
"""Edits of the model."""


@cache
def made_runs():
    """Return two small runs, made once in a process: of a pulse, and of a sum of a pulse and random vibration."""
    law = wr.BoucWen(alpha=1e5, beta=700.0, gamma=300.0, n=1.2, k=3e4)
    limits = {"static_load": 900.0, "travel": {"compression": 0.03, "shear": 0.02, "roll": 0.02}}
    isolator = wr.Isolator.from_dict({
        "name": "a", "axial": {"law": "bouc-wen", **{k: getattr(law, k) for k in ("alpha", "beta", "gamma", "n", "k")}},
        "roll": {"law": "kelvin-voigt", "k": 3e4, "c": 200.0}, "limits": limits, "geometry": {"height": 0.1, "width": 0.1},
        "provenance": {"kind": "illustrative", "source": "made up"},
    })  # fmt: skip
    folder = Path(tempfile.mkdtemp(prefix="fuzz-runs-"))
    shock = wr.HalfSine(peak=60.0, duration=0.01, direction="z", start=0.005)
    noise = wr.RandomVibration(psd=[(5.0, 0.1), (50.0, 0.1)], duration=0.5, seed=3, direction="x")
    simulate = {"duration": 0.05, "timestep": 1e-3, "sample_rate": 500.0}
    for name, motion in (("one", shock), ("other", shock + noise)):
        kept = {"isolators": {"a": isolator}, "name": name, "options": {"level": 6.0}}
        with mock.patch("wirerope_mj.runs.write._write_views"):  # nothing reads them again
            run_scenario(Scenario("How far?", model(1, GUIDED), motion, simulate, **kept), folder / name)
    return folder / "one", folder / "other"


def _of_text(rng, run, name):
    """Edit a TOML or JSON file of the run, or its bytes."""
    path, toml = run / name, name.endswith(".toml")
    if rng.random() < 0.15:
        return _of_bytes(rng, run, name)
    content = (tomllib if toml else json).loads(path.read_text(encoding="utf-8"))
    holder, key, where = place(rng, content)
    before = holder[key]
    done = edit(rng, holder, key, TOML_VALUES if toml else (*VALUES, None))
    path.write_text(tomli_w.dumps(content) if toml else json.dumps(content, indent=2), encoding="utf-8")
    changed = not toml and isinstance(before, float) and done.startswith("number") and "seconds" not in where
    return f"{name} {where}: {done}", changed


def _of_bytes(rng, run, name):
    path = run / name
    how, data = damaged(rng, path.read_bytes())
    path.write_bytes(data)
    return f"{name}: {how}", False


def _metadata(rng, run):
    """Edit what the response says of itself."""
    path = run / RESPONSE
    content = json.loads(pq.read_metadata(path).metadata[KEY])
    part = "peaks" if rng.random() < 0.3 else pick(rng, [part for part in content if part != "motion"])
    holder, key, where = place(rng, content, part)
    before = holder[key]
    done = edit(rng, holder, key, (*VALUES, None))
    pq.write_table(pq.read_table(path).replace_schema_metadata({KEY: json.dumps(content).encode()}), path)
    changed = isinstance(before, float) and done.startswith("number")
    # nothing to compare the latter with
    return f"metadata {where}: {done}", changed and not where.startswith(
        ("numerics.versions", "numerics.accuracy", "numerics.error")
    )


def _columns(rng, run):
    """Change columns, rows or values of the response."""
    path = run / RESPONSE
    table = pq.read_table(path)
    meta = {KEY: pq.read_metadata(path).metadata[KEY]}
    names, columns = list(table.column_names), [column.to_numpy().copy() for column in table.columns]
    i, j = (int(n) for n in rng.choice(len(names), 2, replace=False))
    row, name, column = int(rng.integers(table.num_rows)), names[i], columns[i]
    size = np.abs(column).max()
    kind = pick(
        rng, ("rename", "drop", "swap", "order", "rows", "nan", "number", "number", "type", "null", "twice", "cut", "bare")
    )
    if kind == "rename":
        names[i] = pick(rng, ("", "x", name.upper(), names[j]))
    elif kind == "drop":
        del names[i], columns[i]
    elif kind in ("swap", "order"):
        columns[i], columns[j] = columns[j], columns[i]
        if kind == "order":
            names[i], names[j] = names[j], names[i]
    elif kind == "rows":
        columns = [column[rng.permutation(table.num_rows)] for column in columns]
    elif kind == "nan":
        column[row] = pick(rng, (np.nan, -np.inf))
    elif kind == "number":
        column[row] += 1e-3 * (size or 1e-6)
    elif kind == "type":
        columns[i] = pick(rng, (column.astype(int), np.array([str(x) for x in column], dtype=object)))
    elif kind == "null":
        columns[i] = pa.array([None if k == row else x for k, x in enumerate(column)], pa.float64())
    elif kind == "twice":
        names, columns = [*names, name], [*columns, column]
    elif kind == "cut":
        count = pick(rng, (0, 1, table.num_rows // 2))
        columns = [column[:count] for column in columns]
    else:
        meta = {}
    made = pa.Table.from_arrays([pa.array(column) for column in columns], names=names)
    pq.write_table(made.replace_schema_metadata(meta), path)
    swapped = kind == "swap" and not np.array_equal(columns[i], columns[j])
    # A column of zeros has no size of its own: what is added may be rounding next to the others.
    return f"table {kind} {name!r} row {row}", swapped or (kind == "number" and size > 0.0)


def _model(rng, run):
    path, (old, new) = run / MODEL, pick(rng, REPLACED)
    path.write_text(path.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    return f"model {old} -> {new}", False


def _missing(rng, run):
    name = pick(rng, (SCENARIO, SUMMARY, RESPONSE, MODEL, ISOLATOR))
    (run / name).unlink()
    if rng.random() < 0.2:
        (run / name).mkdir()
    return f"{name} missing", False


def _another(rng, run):
    """Take a file of another run."""
    (source,) = (other for other in made_runs() if other.joinpath(RESPONSE).read_bytes() != run.joinpath(RESPONSE).read_bytes())
    name = pick(rng, (SCENARIO, SUMMARY, RESPONSE))
    shutil.copyfile(source / name, run / name)
    return f"{name} of another run", True


def _checksums(rng, run):
    path = run / CHECKSUMS
    lines = path.read_text(encoding="utf-8").splitlines()
    i = int(rng.integers(len(lines)))
    lines[i] = pick(rng, (lines[i][:30], "0" * 64 + lines[i][64:], "", f"{'0' * 64}  nothing"))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return f"checksums {lines[i][:20]}", False


FILES = (
    (3, lambda rng, run: _of_text(rng, run, SCENARIO), (SCENARIO, "the run's folder", "model", "run")),
    (1, lambda rng, run: _of_text(rng, run, SUMMARY), (SUMMARY,)),
    (1, lambda rng, run: _of_text(rng, run, ISOLATOR), ("a.toml", "isolator", "m1", RESPONSE, "response", "model")),
    (3, _metadata, (RESPONSE,)), (2, _columns, (RESPONSE,)), (1, _model, ("model", "mount", "mass", RESPONSE)),
    (1, lambda rng, run: _of_bytes(rng, run, pick(rng, (RESPONSE, RESPONSE, SUMMARY, ISOLATOR, MODEL))),
     (RESPONSE, SUMMARY, "a.toml", "run", "model")),
    (1, _missing, (SCENARIO, SUMMARY, RESPONSE, "model", "a.toml")), (1, _another, (SCENARIO, SUMMARY, RESPONSE)),
    (1, _checksums, (CHECKSUMS,)), (0.3, lambda rng, run: _of_bytes(rng, run, CHECKSUMS), (CHECKSUMS,)),
)  # fmt: skip
"""How often each is taken, what it does and whether replay compares what differs, and the names of which a refusal has one."""

OFTEN = np.array([often for often, *_ in FILES])


def folders(rng, folder):
    """A run's folder, one of whose files was changed, read, replayed, reported or compared."""
    source = made_runs()[int(rng.random() < 0.3)]
    run = Path(shutil.copytree(source, folder / "run"))
    _, change, names = FILES[rng.choice(len(FILES), p=OFTEN / OFTEN.sum())]
    done, changed = change(rng, run)
    sums = "kept" if CHECKSUMS in names else pick(rng, ("kept", "removed", "anew"))
    if sums != "kept":
        (run / CHECKSUMS).unlink()
    if sums == "anew":
        write_checksums(run)
    act = rng.choice(["read", "replay", "report", "compare"], p=[0.42, 0.5, 0.03, 0.05])

    def read():
        response = wr.load_response(run)
        for part in (*response.bodies.values(), *response.points.values()):
            assert np.isfinite(np.hstack([part.position, part.acceleration])).all()
        for part in response.mounts.values():
            assert np.isfinite(np.hstack([part.deflection, part.force, part.hysteretic_state])).all()
        wrong = [verdict for verdict in judge(response) if not np.isfinite(verdict.value)]
        json.dumps(summary(response, judge(response)), allow_nan=False)
        run_inputs(run)
        return f"{wrong[0]}" if wrong else None

    def replayed():
        result = replay(run)
        if sums == "kept" and (result.intact or result.alterations is None):
            return "altered, and replay says that nothing was"
        if changed and result.identical:
            return "a number was changed, and replay says that all are identical"
        if changed and result.agrees and "tiny" not in done:
            return f"a number was changed, and replay says that they agree ({result.largest_difference:.3g} in {result.column})"
        return None

    def shown():
        with warnings.catch_warnings(record=True) as caught, contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("always")
            if act == "report":
                (written,) = write_report(run)
            else:
                compare(run, source, out=(written := folder / "both.rrd"))
        if sums == "kept" and not any("Since the run was written" in str(warning.message) for warning in caught):
            return "altered, and no warning says so"
        return None if written.stat().st_size > 1000 else "what is written is empty"

    use = {"read": read, "replay": replayed}.get(act, shown)
    return Case(f"{act}, checksums {sums}: {done}", use, (*names, "the model file", "the record"))


ARGUMENTS = ("duration", "sample_rate", "timestep", "accuracy", "initial", "callback", "engine", "corners", "out", "colour")


@cache
def shipped():
    """Return the scenario files that ship."""
    return tuple(load_scenario(name) for name in shipped_scenarios())


def scenarios(rng, folder):
    """Options of shipped scenarios with wrong values, made and shaken for a moment; wrong arguments of `simulate`, run."""
    if rng.random() < 0.5:
        file = pick(rng, shipped())
        options = {pick(rng, list(file.defaults)): pick(rng, PYTHON_VALUES) for _ in range(int(rng.integers(1, 3)))}
        if rng.random() < 0.05:
            options["colour"] = 1.0

        def use():
            made = file.make(**options)
            if complaint := finite(made.motion, ("acceleration", "velocity", "displacement"), np.linspace(0.0, 0.1, 7)):
                return complaint
            duration = made.simulate["duration"]
            if isinstance(duration, float) and (duration > 2.0 or made.motion.corners.size > 1000):
                return None  # a long run is a valid one
            duration = min(duration, 0.002) if isinstance(duration, float) else duration
            system = wr.load_system(made.model_source(), isolators=made.isolators)
            return _forces(wr.simulate(system, made.motion, **{**made.simulate, "timestep": 5e-4, "duration": duration}))

        return Case(f"{file.name} {options!r:.120}", use, (file.path.name, file.name, *options, *file.defaults))
    arguments = {"duration": 0.01, "timestep": 1e-3, "sample_rate": 1000.0}
    for _ in range(int(rng.integers(1, 3))):
        arguments[pick(rng, ARGUMENTS)] = pick(rng, PYTHON_VALUES)
    if rng.random() < 0.1:
        del arguments["duration"]
    if isinstance(arguments.get("duration"), float) and arguments["duration"] > 1.0:
        arguments["duration"] = 0.005
    pulse = wr.HalfSine(peak=20.0, duration=0.002, direction="z")
    return Case(
        f"simulate {arguments!r:.120}",
        lambda: _forces(run_scenario(Scenario("does it hold?", "sdof_shaker.xml", pulse, arguments), folder / "run")),
        (*ARGUMENTS, "step", "sdof_shaker", "samples", "state", "starts"),
    )


def _forces(response):
    """Return a complaint if forces of a response are not finite."""
    wrong = [name for name, mount in response.mounts.items() if not np.isfinite(mount.force).all()]
    return f"mount {wrong[0]}: forces are not finite" if wrong else None


SOURCES = (
    "None", "3", "2.5", "float('nan')", "float('inf')", "-1.0", "0", "1e308", "10**400", "True", "'text'", "b'x'", "[]", "[1]",
    "[None]", "{}", "{1: 2}", "{'a': 1}", "()", "set()", "object()", "wr", "len", "lambda: 0", "wr.HalfSine", "motion",
    "motion + motion", "wr.load_system('sdof_shaker')", "Silent()", "1j", "'\\0'", "'x' * 5000", "wr.BoucWen", "[motion]",
    "Exception('x')", "...", "range(3)", "(x for x in [1])", "__import__('numpy').zeros(3)",
    "__import__('numpy').float64(0.01)", "__import__('pathlib').Path()",
)  # fmt: skip
"""What Python may make anywhere, as it is written."""

PLACES = (
    "question", "model", "motion", "simulate", "isolators", "name", "options", "folder", "changes", "combined_travel", "limits",
)  # fmt: skip
FORMS = (
    "{}", "wr.Scenario({}, {}, {}, {})",
    *["wr.Scenario(**(good | {{'simulate': {{'duration': 0.01, 'timestep': 1e-3, 'NAME': {}}}}}))"] * 5,
    *[f"wr.Scenario(**(good | {{{{{place!r}: {{}}}}}}))" for place in PLACES],
    *[f"wr.Scenario(**(good | {{{{{entry}}}}}))" for entry in ("'limits': [{}]", "'limits': [{0}, {0}]", "'changes': [{}]",
      "'isolators': {{'sdof_36hz': {}}}", "'motion': motion + {}")],
    *[f"wr.Scenario(**(good | {{{{'motion': wr.{call}, direction='z')}}}}))" for call in (
        "HalfSine(peak={}, duration=0.01", "HalfSine(peak=1.0, duration={}", "Sine(frequency={}, acceleration=1.0",
        "Sweep(start=1, stop=2, rate={}, acceleration=1.0", "RandomVibration(psd={}, duration=1.0, seed=1",
        "RandomVibration(psd=[(20, 1), (50, 1)], duration=1.0, seed={}", "DecayingSine(frequency=10, damping={}, velocity=1.0",
    )],
)  # fmt: skip
"""What a function of a scenario returns, with places for what is wrong."""

FILE = '''"""Does it hold?"""
import wirerope_mj as wr
class Silent:
    def __repr__(self):
        raise RuntimeError
motion = wr.HalfSine(peak=10.0, duration=0.01, direction="z")
good = {"question": "?", "model": "sdof_shaker", "motion": motion, "simulate": {"duration": 0.01, "timestep": 1e-3}}
def scenario(*, level: float = 1.0) -> wr.Scenario:
    return '''


def returns(rng, folder):
    """Functions that return something else than a scenario, or one with something else inside; what is before a run, and it."""
    path = folder / "mine.py"
    returned = pick(rng, FORMS).format(*(pick(rng, SOURCES) for _ in range(4))).replace("NAME", pick(rng, ARGUMENTS))
    path.write_text(f"{FILE}{returned}\n", encoding="utf-8")

    def use():
        scenario = load_scenario(path).make()
        arguments = checked_arguments(scenario)
        system = with_changes(wr.load_system(scenario.model_source(), isolators=scenario.isolators), scenario.changes)
        system = judged_by(system, combined_travel=scenario.combined_travel, limits=scenario.limits)
        samples = float(arguments["duration"]) * float(arguments.get("sample_rate", 1000.0))
        if samples > 1e5 or scenario.motion.corners.size > 1e5:
            return None  # a long run is a valid one
        return _forces(wr.simulate(system, scenario.motion, **arguments))

    return Case(returned[:150], use, (path.name, "mine", "model", "limit", *ARGUMENTS))


@cache
def board():
    """Return a board of the genset's tables and a short load case, made once a process; it is put back after every input."""
    folder = from_template("genset", Path(tempfile.mkdtemp(prefix="fuzz-board-")) / "genset")
    job = 'model = "."\n[[case]]\nname = "a"\nhalf-sine = "5 g 11 ms z"\nduration = 0.02\ntimestep = 1e-3\n'
    (folder / "job.toml").write_text(job, encoding="utf-8")
    made = Board(opened(folder))
    atexit.register(made.close)
    return made


ACTED = (
    "move", "drag", "turn", "mirror", "align", "distribute", "stand", "duplicate", "remove", "cell", "part", "add",
    "case", "add-case", "remove-case", "limit", "add-limit", "job", "slide", "redo", "judge", "nothing",
)  # fmt: skip
SAID = {
    "names": (["mount/m1"], ["mount/m1", "mass/frame"], ["stop/s1", "stop/s2"], ["point/turbocharger"], [], ["x"], "m1"),
    "by": ([10, 0, 0], [0.0, -20.5, 3], [1e9, 0, 0], [1, 2], ["a", 1, 2], None), "degrees": (90, 45, -90, 1e9, "x", None),
    "axis": ("x", "y", "z", "w", ""), "on": ("floor", "wall", "ceiling", "roof"), "case": ("0", "1", "-1", "x"),
    "table": ("mounts", "masses", "stops", "points", "forces", "envelope", "job"), "row": ("m1", "frame", "s1", "nobody"),
    "column": ("x", "z", "mass", "name", "isolator", "inclination", "gap", "mounts", "ixx", "size_x"),
    "key": ("motions", "name", "level", "mass", "deck", "temperature", "document.project", "acceleration/equipment", "x", ""),
    "value": (
        "1", "-0.5", "12", "1e400", "nan", "", "WR16-600", "half-sine 15 g 11 ms z", "drop 200 mm", "10 Hz 800 kg 4 %",
        "acceleration/equipment = 5 g", "5 g", "<b>x</b>", "m2", "a,b", 'a"b', "x\ny", 0.7, None,
    ),
}  # fmt: skip


def actions(rng, folder):
    """Actions of a board: done, or refused in words; messages are JSON, and undone everything is as it was."""
    action = {"do": pick(rng, ACTED), "id": "1"} | {
        key: pick(rng, values) for key, values in SAID.items() if rng.random() < 0.8
    }

    def use():
        made = board()
        before, told = dict(made._documents.texts), [message for _, message in made.act(action)]
        json.dumps(told, allow_nan=False)
        refusals = [message["said"] for message in told if "refused" in message]
        if dict(made._documents.texts) != before:
            list(made.act({"do": "undo"}))
        made.act({"do": "slide", "key": "level", "value": 1.0})
        if dict(made._documents.texts) != before:
            return "undoing does not give the texts back"
        if refusals:
            raise ValueError(refusals[0])
        return None

    words = ("selected", "load case", "limited", "table", "here", "numbers", "degrees", "mount", "slider")
    return Case(json.dumps(action)[:150], use, (*words, *action, *(str(value) for value in action.values())))
