"""A study that takes a second: a mass on one mount with a rated travel, and a file that makes it."""

import textwrap

STUDY_FILE = textwrap.dedent('''
    """How does a mass on one mount do?

    A half-sine strikes it from below.
    """

    import wirerope_mj as wr
    from wirerope_mj.mounts.isolator import Limits, Travel
    from house import sdof_text


    def study(*, variants: int = 64, peak: float = 60.0, timestep: float = 1e-3) -> wr.Study:
        """Return the study.

        Args:
            variants: how many.
            peak: of the half-sine [m/s^2].
            timestep: largest step [s].
        """
        law = wr.BoucWen(alpha=2e4, beta=30.0, gamma=10.0, n=1.0, k=5e3)
        limits = Limits(travel=Travel(compression=0.008, tension=0.008))
        return wr.Study(
            model=sdof_text(),
            isolators={"a": wr.Isolator(name="a", axial=law, limits=limits)},
            motion=wr.HalfSine(peak=peak, duration=0.011, direction="z"),
            duration=0.2,
            timestep=timestep,
            variants=variants,
            vary={
                "mount/m1/axial/alpha": wr.Normal(1.0, 0.2, relative=True, low=0.3),
                "body/mass/mass": wr.Uniform(0.8, 1.2, relative=True),
                "motion/level": wr.Uniform(0.5, 1.5),
            },
        )
''').lstrip()


def write_study(folder):
    """Write the study's file and return its path."""
    path = folder / "small.py"
    path.write_text(STUDY_FILE, encoding="utf-8")
    return path
