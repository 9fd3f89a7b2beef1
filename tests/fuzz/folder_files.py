"""Mutations of the files of a run's folder.

Each returns what it did, names of which a refusal must hold one, and whether a number differs that replay compares.
"""

import json
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import tomli_w
from edits import anywhere, damaged, edit

SCENARIO, SUMMARY, RESPONSE, CHECKSUMS = "scenario.toml", "summary.json", "response.parquet", "checksums.txt"
MODEL, ISOLATOR = "model/model.xml", "model/a.toml"
KEY = b"wirerope_mj"
REPLACED = (
    ('mass="30"', 'mass="31"'), ('mass="30"', 'mass="nan"'), ('pos="0 0 .3"', 'pos="0 0 .31"'), ("9.80665", "9.81"),
    ('name="mass"', 'name="block"'), ('data="60"', 'data="6"'), ("point/top", "point/tip"), ("-.1", "-.10001"), ("m1", "m2"),
)  # fmt: skip
"""Edits of the model."""


def scenario(rng, run, other):
    path = run / SCENARIO
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    if rng.random() < 0.15:
        path.write_bytes(damaged(rng, path.read_bytes()))
        return "bytes of the scenario", [SCENARIO, "model", "run"], False
    holder, key, where = anywhere(rng, content)
    words = edit(rng, holder, key, toml=True)
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    return f"scenario {where}: {words}", [SCENARIO, "the run's folder"], False


def summary_file(rng, run, other):
    path = run / SUMMARY
    if rng.random() < 0.15:
        path.write_bytes(damaged(rng, path.read_bytes()))
        return "bytes of the summary", [SUMMARY], False
    content = json.loads(path.read_text(encoding="utf-8"))
    holder, key, where = anywhere(rng, content)
    before = holder[key]
    words = edit(rng, holder, key)
    path.write_text(json.dumps(content, indent=2), encoding="utf-8")
    changed = isinstance(before, float) and words.startswith("number") and "seconds" not in where
    return f"summary {where}: {words}", [SUMMARY], changed


def metadata(rng, run, other):
    path = run / RESPONSE
    content = json.loads(pq.read_metadata(path).metadata[KEY])
    part = str(rng.choice(list(content)))
    if part == "motion" or rng.random() < 0.3:
        part = "peaks"
    holder, key, where = anywhere(rng, content, part)
    before = holder[key]
    words = edit(rng, holder, key)
    table = pq.read_table(path)
    pq.write_table(table.replace_schema_metadata({KEY: json.dumps(content).encode()}), path)
    changed = isinstance(before, float) and words.startswith("number") and not where.startswith("numerics.versions")
    changed &= not where.startswith(("numerics.accuracy", "numerics.error"))  # nothing to compare with
    return f"metadata {where}: {words}", [RESPONSE], changed


def table(rng, run, other):
    path = run / RESPONSE
    table = pq.read_table(path)
    meta = {KEY: pq.read_metadata(path).metadata[KEY]}
    names, columns = list(table.column_names), [column.to_numpy().copy() for column in table.columns]
    i, j = (int(n) for n in rng.choice(len(names), 2, replace=False))
    row = int(rng.integers(table.num_rows))
    kind = str(
        rng.choice(
            [
                "rename",
                "drop",
                "swap",
                "order",
                "rows",
                "nan",
                "inf",
                "number",
                "int",
                "text",
                "null",
                "twice",
                "none",
                "one",
                "half",
                "bare",
            ]
        )
    )
    changed = False
    if kind == "rename":
        names[i] = str(rng.choice(["", "x", names[i].upper(), names[j]]))
    elif kind == "drop":
        del names[i], columns[i]
    elif kind == "swap":
        columns[i], columns[j] = columns[j], columns[i]
        changed = not np.array_equal(columns[i], columns[j])
    elif kind == "order":
        names[i], names[j], columns[i], columns[j] = names[j], names[i], columns[j], columns[i]
    elif kind == "rows":
        order = rng.permutation(table.num_rows)
        columns = [column[order] for column in columns]
    elif kind in ("nan", "inf"):
        columns[i][row] = {"nan": np.nan, "inf": -np.inf}[kind]
    elif kind == "number":
        columns[i][row] += 1e-3 * max(np.abs(columns[i]).max(), 1e-6)
        changed = True
    elif kind == "int":
        columns[i] = columns[i].astype(int)
    elif kind == "text":
        columns[i] = np.array([str(x) for x in columns[i]], dtype=object)
    elif kind == "null":
        columns[i] = pa.array([None if k == row else x for k, x in enumerate(columns[i])], pa.float64())
    elif kind == "twice":
        names, columns = [*names, names[i]], [*columns, columns[i]]
    elif kind in ("none", "one", "half"):
        count = {"none": 0, "one": 1, "half": table.num_rows // 2}[kind]
        columns = [column[:count] for column in columns]
    else:
        meta = {}
    made = pa.Table.from_arrays([pa.array(column) for column in columns], names=names)
    pq.write_table(made.replace_schema_metadata(meta), path)
    return f"table {kind} {names[min(i, len(names) - 1)]!r} row {row}", [RESPONSE], changed


def bytes_of(rng, run, other):
    name = str(rng.choice([RESPONSE, RESPONSE, RESPONSE, SUMMARY, ISOLATOR, MODEL]))
    path = run / name
    path.write_bytes(damaged(rng, path.read_bytes()))
    return f"bytes of {name}", [Path(name).name, "run", "model"], False


def model(rng, run, other):
    if rng.random() < 0.5:
        path = run / ISOLATOR
        content = tomllib.loads(path.read_text(encoding="utf-8"))
        holder, key, where = anywhere(rng, content)
        words = edit(rng, holder, key, toml=True)
        path.write_text(tomli_w.dumps(content), encoding="utf-8")
        return f"isolator {where}: {words}", ["a.toml", "isolator", "m1", RESPONSE, "response"], False
    path = run / MODEL
    text = path.read_text(encoding="utf-8")
    old, new = REPLACED[rng.integers(len(REPLACED))]
    path.write_text(text.replace(old, new), encoding="utf-8")
    return f"model {old} -> {new}", ["model", "mount", "mass", RESPONSE], False


def missing(rng, run, other):
    name = str(rng.choice([SCENARIO, SUMMARY, RESPONSE, MODEL, ISOLATOR]))
    (run / name).unlink()
    if rng.random() < 0.2:
        (run / name).mkdir()
    return f"{name} missing", [Path(name).name, "model"], False


def swapped(rng, run, other):
    name = str(rng.choice([SCENARIO, SUMMARY, RESPONSE]))
    shutil.copyfile(other / name, run / name)
    return f"{name} of another run", [SCENARIO, SUMMARY, RESPONSE], True


def checksums(rng, run, other):
    path = run / CHECKSUMS
    lines = path.read_text(encoding="utf-8").splitlines()
    i = int(rng.integers(len(lines)))
    kind = str(rng.choice(["bytes", "cut", "digest", "gone", "file"]))
    if kind == "bytes":
        path.write_bytes(damaged(rng, path.read_bytes()))
        return "checksums bytes", [CHECKSUMS], False
    lines[i] = {"cut": lines[i][:30], "digest": "0" * 64 + lines[i][64:], "gone": "", "file": f"{'0' * 64}  nothing"}[kind]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return f"checksums {kind}", [CHECKSUMS], False


FILES = (
    scenario,
    scenario,
    scenario,
    summary_file,
    metadata,
    metadata,
    metadata,
    table,
    table,
    bytes_of,
    model,
    missing,
)
KINDS = (*FILES, swapped, checksums)
