"""A genset of 1200 kg on six inclined wire-rope mounts that may travel 35 mm, and a study of its centre of mass.

The case is ours; the level of the shock is such that about one genset in twenty leaves that travel.
"""

from dataclasses import replace

import house

import wirerope_mj as wr
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.isolator import Limits, Travel

G = wr.STANDARD_GRAVITY
CENTRE = 0.35
"""Height of the centre of mass above the genset's origin, as the model says it [m]."""

TRAVEL = 0.035
SHOCK = wr.HalfSine(peak=15.2 * G, duration=0.011, direction=(0.0, 1.0, 0.3), start=0.01)
PLACES = {f"m{n}": (x, y) for n, (x, y) in enumerate([(x, y) for y in (-0.3, 0.3) for x in (-0.8, 0.0, 0.8)], start=1)}


def genset_text(*, turned=""):
    """Return the model; `turned` are attributes of the genset's body that turn it about its origin."""
    deck = house.deck(
        {f"b/{name}": f'pos="{x} {y} 0.1" euler="{30 if y < 0.0 else -30} 0 0"' for name, (x, y) in PLACES.items()}
    )
    sites = "".join(f'<site name="p/{name}" pos="{x} {y} 0"/>' for name, (x, y) in PLACES.items())
    genset = (
        f'<body name="genset" pos="0 0 0.1" simple="false" {turned}><freejoint/>'
        f'<inertial pos="0 0 {CENTRE}" mass="1200" diaginertia="180 420 440"/>'
        f'<geom type="box" size="0.9 0.25 0.4" pos="0 0 0.4"/>{sites}</body>'
    )
    return house.mjcf(deck + genset, [(name, f"p/{name}", f"b/{name}", "rope") for name in PLACES], gravity=G)


def genset_study(centre, *, variants=500, **others):
    """Return the study in which `centre` varies, and the mounts' stiffness and the level with it."""
    vary = {
        **centre,
        "mount/*/axial/alpha": wr.Normal(1.0, 0.1, relative=True, each=True, low=0.5),
        "motion/level": wr.Normal(1.0, 0.05),
    }
    travel = Travel(compression=TRAVEL, tension=TRAVEL, shear=TRAVEL, roll=TRAVEL)
    rope = replace(wr.load_isolator(catalogue_folder() / "enidine_wr16_400.toml"), limits=Limits(travel=travel))
    given = {"model": genset_text(), "isolators": {"rope": rope}, "motion": SHOCK, "duration": 1.0, "timestep": 2.5e-4}
    return wr.Study(vary=vary, variants=variants, **{**given, **others})
