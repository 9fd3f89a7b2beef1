"""A mass on one mount on a shock table: a study of forty variants that takes a second."""

import wirerope_mj as wr

G = wr.STANDARD_GRAVITY
PULSE = wr.HalfSine(peak=10.0 * G, duration=0.011, direction="z", start=0.01)
VARY = {
    "mount/m1/axial/alpha": wr.Normal(1.0, 0.1, relative=True),
    "body/block/mass": wr.Uniform(0.9, 1.1, relative=True),
    "motion/level": wr.Uniform(0.5, 1.5),
}

FILES = ["model", "study.toml", "summary.json", "variants.parquet"]
"""In the folder of a study that is complete."""


def table_study(**others):
    given = {"model": "shock_table.xml", "vary": VARY, "variants": 40, "duration": 0.05, "timestep": 1e-3}
    return wr.Study(**{**given, "motion": PULSE, **others})


def rows(table):
    """The rows with every bit of their numbers; NaN is equal to NaN."""
    return [{key: repr(value) for key, value in row.items()} for row in table.to_pylist()]
