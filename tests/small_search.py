"""A search that takes a second: a beam with an eccentric load on up to five mounts, of which 32 designs can be made."""

import textwrap

from house import mjcf

import wirerope_mj as wr
from wirerope_mj.mounts.isolator import Limits, Travel

PLACES = {"m1": -0.4, "m2": -0.2, "m3": 0.0, "m4": 0.2, "m5": 0.4}
"""Where the mounts stand along the beam [m]."""


def beam_text(places=PLACES):
    """Return a beam that heaves and pitches on vertical mounts at `places` {name: x}."""
    sites = {
        body: "".join(f'<site name="{body}/{m}" pos="{x!r} 0 0"/>' for m, x in places.items()) for body in ("deck", "beam")
    }
    world = (
        f'<body name="deck"><joint name="deck_z" type="slide" axis="0 0 1"/><geom size=".1" mass="1000"/>{sites["deck"]}</body>'
        '<body name="beam"><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>'
        f'<inertial pos="0.08 0 0" mass="10" diaginertia="0.1 0.8 0.8"/>{sites["beam"]}'
        '<site name="point/end" pos="0.5 0 0"/></body>'
    )
    return mjcf(world, [(m, f"beam/{m}", f"deck/{m}", "a") for m in places], gravity=9.80665)


def beam_study(*, text=None, travel=0.025, **given):
    """Return a study of the beam under a half-sine; by default any place may be fitted."""
    law = wr.BoucWen(alpha=8e3, beta=400.0, gamma=100.0, n=1.0, k=3e3)
    limits = Limits(travel=Travel(compression=travel, tension=travel))
    arguments = {
        "model": beam_text() if text is None else text,
        "isolators": {"a": wr.Isolator(name="a", axial=law, limits=limits)},
        "motion": wr.HalfSine(peak=60.0, duration=0.011, direction="z"),
        "duration": 1.2,
        "timestep": 1e-3,
        "vary": {"mount/*/fitted": wr.Choice(False, True, each=True)},
    }
    return wr.Study(**(arguments | given))


def beam_search(*, generations=8, travel=0.025, variants=8, minimise=("acceleration", "travel"), limits=None, **given):
    """Return a search for designs of the beam; with eight generations it finds all that are on the front."""
    study = beam_study(travel=travel, variants=variants, seed=3, **given)
    return wr.Search(
        study, minimise=minimise, limits={"travel": 1.0} if limits is None else limits, generations=generations,
        start=[{"mount/*/fitted": True}],
    )  # fmt: skip


SEARCH_FILE = textwrap.dedent('''
    """Which places does the beam need?"""

    import wirerope_mj as wr
    from small_search import beam_search


    def study(*, generations: int = 3, travel: float = 0.025) -> wr.Search:
        """Return the search.

        Args:
            generations: how many.
            travel: that is rated [m].
        """
        return beam_search(generations=generations, travel=travel)
''').lstrip()
