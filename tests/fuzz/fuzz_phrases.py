"""Motions of the base and forces on the payload in words, and the files of densities, spectra and forces that they name."""

import numpy as np
from campaign import Case
from hostile import pick
from tables import DAMAGE, table_of
from words import ignored, muddled

from wirerope_mj.motions.restore import motion_from_dict
from wirerope_mj.motions.spoken import SPOKEN_MOTIONS, motion_from_phrase

EXAMPLES = {kind: (spoken.example,) for kind, spoken in SPOKEN_MOTIONS.items()}
EXAMPLES |= {
    "psd": ("p.csv 0.4 s z seed 1", "p.csv 0.5 s xy seed 2 at 20 ms rise 60 ms fall 50 ms"),
    "spectrum": ("s.csv 1 s x damping 5 % seed 1",),
    "force-table": ("engine f.csv at 1 s", "engine f.csv"),
    "half-sine": ("15 g 11 ms z", "15 g 11 ms xz at 50 ms", "-150 m/s2 0.011 s 1,1,0 at 0.1 s"),
    "unbalance": ("engine 20 kg.mm 5 to 30 Hz 20 s x", "engine 20 kg.mm 25 Hz y for 10 s at 1 s order 2"),
    "sweep": ("0.5 g 5 to 50 Hz 2 oct/min z", "0.5 g 50 to 5 Hz 60 oct/min x"),
}
"""Phrases that are right."""


def mutate(rng: np.random.Generator, folder) -> Case:
    """Muddle a phrase, and sometimes the file that it names."""
    f = np.geomspace(20.0, 60.0, 6)
    tables = {
        "p.csv": table_of(["frequency [Hz]", "psd [g^2/Hz]"], [f, 0.01 + 0.0 * f]),
        "s.csv": table_of(["frequency [Hz]", "acceleration [g]"], [f / 10.0, 0.3 + 0.0 * f]),
        "f.csv": table_of(["time [s]", "fz [N]", "mx [N.m]"], [f - 20.0, f, 2.0 * f]),
    }
    kind = pick(rng, list(EXAMPLES))
    text, done, valid = pick(rng, EXAMPLES[kind]), "phrase", None
    file = next((name for name in tables if name in text), None)
    if file is not None and rng.random() < 0.5:
        change = pick(rng, DAMAGE)
        valid, done = change(tables[file], rng), change.__name__
        valid = False if valid is False else None
    else:
        text = muddled(rng, text)
    for name, table in tables.items():
        (folder / name).write_bytes(table.content())
    return Case(f"{kind} {done}: {text!r:.150}", {"kind": kind, "text": text, "folder": folder}, (kind, file or kind), valid)


def use(case: Case) -> str | None:
    """Make the motion, look at all of it, store and restore it, and try other numbers in its phrase."""
    kind, text, folder = case.inputs["kind"], case.inputs["text"], case.inputs["folder"]
    motion = motion_from_phrase(kind, text, folder=folder)
    corners = motion.corners[:: max(motion.corners.size // 50, 1)]
    ends = [motion.end] if np.isfinite(motion.end) else []
    times = np.unique(np.concatenate([corners, ends, np.linspace(0.0, 1.0, 7)]))
    for name in ("acceleration", "velocity", "displacement"):
        if not np.isfinite(getattr(motion, name)(times)).all():
            return f"{name} is not finite"
    for site in motion.loaded_sites:
        if not np.isfinite(motion.load(site, times)).all():
            return "a force is not finite"
    if not np.isfinite([time for time, _ in motion.events]).all() or not motion.description:
        return "an event is at no time"
    if not (np.isfinite(motion.acceleration(times)).any() and motion.shortest_time > 0.0):
        return "no shortest time"
    if motion_from_dict(motion.to_dict()).to_dict() != motion.to_dict():
        return "it is stored as another motion"
    if kind == "spectrum":
        return None  # other numbers take a search each
    return ignored(text, lambda other: motion_from_phrase(kind, other, folder=folder).to_dict())
