"""Files of levels, as `wirerope levels` writes them and a specification fills them in."""

import numpy as np
import tomli_w
from campaign import Case
from edits import damaged
from fuzz_phrases import EXAMPLES
from hostile import pick
from words import ignored, muddled

from wirerope_mj.motions.restore import level_templates, motion_of_levels

VALUES = (
    None,
    True,
    3,
    2.5,
    float("nan"),
    float("inf"),
    -1.0,
    0.0,
    1e300,
    1e-300,
    10**18,
    "",
    "x",
    "15 g 11 ms z",
    [],
    {},
    [1.0],
)
KINDS = tuple(kind for kind in EXAMPLES if kind not in ("psd", "spectrum", "force-table"))


def mutate(rng: np.random.Generator, folder) -> Case:
    """Write a file of levels with muddled phrases, strange values or damaged bytes."""
    path = folder / "levels.toml"
    if rng.random() < 0.2:
        template = level_templates()[pick(rng, list(level_templates()))].read_bytes()
        path.write_bytes(template if rng.random() < 0.3 else damaged(rng, template))
        return Case("template", {"path": path}, (path.name,), False if b"?" in path.read_bytes() else None)
    tables = []
    for _ in range(int(rng.integers(1, 4))):
        kind = pick(rng, KINDS)
        text = pick(rng, EXAMPLES[kind])
        table = {kind: muddled(rng, text) if rng.random() < 0.4 else text}
        if rng.random() < 0.4:
            table["factor"] = pick(
                rng, [value for value in VALUES if value is not None] if rng.random() < 0.6 else [0.5, 2, -1.0]
            )
        if rng.random() < 0.1:
            table[pick(rng, ("half-sine", "sine", "note", ""))] = pick(rng, VALUES[1:])
        tables.append(table)
    content = {"standard": "house", "motion": tables}
    if rng.random() < 0.1:
        content[pick(rng, ("standard", "motion", "other"))] = pick(rng, VALUES[1:])
    text = tomli_w.dumps(content)
    data = text.encode()
    path.write_bytes(damaged(rng, data) if rng.random() < 0.1 else data)
    return Case(f"{tables!r:.150}", {"path": path}, (path.name,))


def use(case: Case) -> str | None:
    """Read the motions, and other numbers in their place."""
    path = case.inputs["path"]
    motion = motion_of_levels(path)
    times = np.unique(np.concatenate([motion.corners, np.linspace(0.0, 1.0, 7)]))
    for name in ("acceleration", "velocity", "displacement"):
        if not np.isfinite(getattr(motion, name)(times)).all():
            return f"{name} is not finite"
    text = path.read_text(encoding="utf-8")
    if "#" in text or text.count('"') % 2 or 'standard = "house"' not in text:
        return None
    other_path = path.with_name("other.toml")

    def answer(other: str):
        other_path.write_text(other, encoding="utf-8")
        return motion_of_levels(other_path).to_dict()

    return ignored(text, answer)
