"""Limits of the payload in words, as `--limit` and files of scenarios say them."""

import numpy as np
from campaign import Case
from hostile import pick
from words import ignored, muddled

import wirerope_mj as wr
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.runs.scenario_file import judge_table, judged_by, read_judge_table

_TABLE = wr.load_system("shock_table")
EXAMPLES = (
    "acceleration/block = 15 g", "acceleration/block = 10 10 5 m/s^2", "clearance/block = 30 30 20 mm",
    "clearance/block = 30 30 30 30 20 20 mm", "acceleration/block=3 g",
)  # fmt: skip


def mutate(rng: np.random.Generator, folder) -> Case:
    """Muddle one or two limits, or the table of a stored scenario that holds them."""
    if rng.random() < 0.3:
        return _stored(rng)
    texts = [muddled(rng, pick(rng, EXAMPLES)) for _ in range(int(rng.integers(1, 3)))]
    return Case(f"{texts!r:.150}", {"texts": texts}, ("limit",))


def _stored(rng: np.random.Generator) -> Case:
    values = (
        None,
        True,
        "x",
        [],
        [1.0],
        [1.0, 2.0],
        ["1"],
        [10**400],
        [float("nan")],
        [0.0, 0.0, 0.0],
        [-1.0],
        {},
        3,
        [1e308],
    )
    keys = ("acceleration/block", "clearance/block", "acceleration/nobody", "x", "", "acceleration/")
    content = {"limits": {pick(rng, keys): pick(rng, values)}}
    if rng.random() < 0.3:
        content = {pick(rng, ("limits", "combined_travel", "other")): pick(rng, values)}
    return Case(f"judge {content!r:.150}", {"content": content}, ("judge", "limit"))


def use(case: Case) -> str | None:
    """Judge a system by the limits."""
    if "content" in case.inputs:
        read = read_judge_table(case.inputs["content"])
        judged_by(_TABLE, **read)
        again = read_judge_table(judge_table(**read))
        return None if again == {"combined_travel": True} | read else "it is stored as another limit"
    limits = [limit_from_text(text) for text in case.inputs["texts"]]
    system = judged_by(_TABLE, combined_travel=True, limits=limits)
    if any(limit not in system.limits for limit in limits):
        return "a limit was not taken"
    complaints = [ignored(text, lambda other: vars(limit_from_text(other))) for text in case.inputs["texts"]]
    return next((complaint for complaint in complaints if complaint), None)
