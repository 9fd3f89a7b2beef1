"""`python -m verification.random_problems`: drawn problems, computed by the package and by `newton_euler`.

The error is that which `accuracy` of `wr.simulate` bounds: of samples and refined peaks, over the peak of their channel, and of
channels below a thousandth of the largest of their kind over that thousandth. All start by release under gravity.
"""

import argparse
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

import wirerope_mj as wr
from verification import newton_euler as ne
from verification.drawn_problems import Drawn, draw, motion_of

Array = np.ndarray

TIGHT, LOOSE = 1e-11, 1e-9  # tolerances of the reference, whose difference says how well it is known itself
SAMPLE_RATE = 1000.0
SMALL = 1e-3  # of the largest peak of a kind: below it channels are judged against that, as `wr.simulate` does
SENSITIVE = "sensitive"


@dataclass(frozen=True, kw_only=True)
class Compared:
    """A problem's errors: of the package against the reference, as the package estimates it, and of the reference itself."""

    drawn: Drawn
    error: float
    where: str
    estimate: float
    limited_by: str
    reference: float
    struck: bool
    engine: str
    seconds: tuple[float, float]

    @property
    def kept(self) -> str:
        """In one word: kept, missed (up to three times), sensitive within the spread that is said, wrong, or unsure."""
        asked = self.drawn.accuracy
        if self.reference > 0.3 * asked:
            return "unsure"
        if self.error <= asked:
            return "kept"
        if self.limited_by.startswith("what it hits"):
            return SENSITIVE if self.error <= self.estimate else "wrong"
        return "missed" if self.error <= 3.0 * asked else "wrong"


def _against(ours: ne.Solution, solution: ne.Solution, bodies: int) -> tuple[float, int]:
    """Measure the largest relative error of samples and peaks, and the channel that has it."""
    mounts = (ours.samples.shape[1] - bodies) // 2
    scale = solution.largest.copy()
    for kind in (slice(0, bodies), slice(bodies, bodies + mounts), slice(bodies + mounts, None)):
        scale[kind] = np.maximum(scale[kind], SMALL * scale[kind].max())
    errors = (
        np.max(
            [
                np.linalg.norm(ours.samples - solution.samples, axis=2).max(axis=0),
                np.abs(ours.minimum - solution.minimum).max(axis=1),
                np.abs(ours.maximum - solution.maximum).max(axis=1),
                np.abs(ours.largest - solution.largest),
            ],
            axis=0,
        )
        / scale
    )
    return float(errors.max()), int(errors.argmax())


def compare(drawn: Drawn) -> Compared:
    """Compute a problem both ways."""
    system = wr.load_system(drawn.text, isolators=drawn.isolators)
    bodies, names = drawn.problem.masses.size, list(system.mounts)
    began = perf_counter()
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        response = wr.simulate(
            system,
            motion_of(drawn.problem, Path(folder)),
            duration=drawn.duration,
            initial="unloaded",
            accuracy=drawn.accuracy,
            sample_rate=SAMPLE_RATE,
        )
    middle = perf_counter()
    tight, loose = (ne.solve(drawn.problem, response.time, tolerance) for tolerance in (TIGHT, LOOSE))
    seconds = (middle - began, perf_counter() - middle)
    moved = [response.bodies[f"body{b}"] for b in range(bodies)]
    peaks = [response.peaks.bodies[f"body{b}"].acceleration for b in range(bodies)]
    peaks += [response.peaks.mounts[name].deflection for name in names] + [response.peaks.mounts[name].force for name in names]
    histories = [body.acceleration for body in moved]
    histories += [response.mounts[name].deflection for name in names] + [response.mounts[name].force for name in names]
    minimum, maximum, largest = (np.array([getattr(peak, part) for peak in peaks]) for part in ("minimum", "maximum", "value"))
    ours = ne.Solution(samples=np.stack(histories, axis=1), minimum=minimum, maximum=maximum, largest=largest)
    error, at = _against(ours, tight, bodies)
    itself, _ = _against(loose, tight, bodies)
    channels = [f"acceleration body{b}" for b in range(bodies)]
    channels += [f"{kind} {name}" for kind in ("deflection", "force") for name in names]
    gaps = drawn.problem.laws[:, 2, ne.BELOW : ne.ABOVE + 1]
    deflections = slice(bodies, bodies + len(names))
    struck = np.any(-tight.minimum[deflections, 2] > gaps[:, 0]) or np.any(tight.maximum[deflections, 2] > gaps[:, 1])
    return Compared(
        drawn=drawn, error=error, where=channels[at], estimate=response.numerics.error_estimate,
        limited_by=response.numerics.limited_by, reference=itself, struck=bool(struck), engine=response.numerics.engine,
        seconds=seconds,
    )  # fmt: skip


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line a problem, and counts; return 1 if more than one of a hundred misses, or one by more than three times."""
    parser = argparse.ArgumentParser(prog="python -m verification.random_problems", description=__doc__)
    parser.add_argument("--problems", type=int, default=200, help="number of problems; every third one has stops")
    parser.add_argument("--seed", type=int, default=0, help="of the first problem; the others follow")
    options = parser.parse_args(arguments)
    counts: Counter[str] = Counter()
    struck = 0
    print("seed  asked  error    estimated  reference  outcome    where; what")
    for seed in range(options.seed, options.seed + options.problems):
        result = compare(draw(seed, stopped=seed % 3 == 0))
        counts[result.kept] += 1
        struck += result.struck
        print(
            f"{seed:4d}  {result.drawn.accuracy:.0e}  {result.error:.1e}  {result.estimate:.1e}    {result.reference:.1e}    "
            f"{result.kept:9}  {result.where}; {result.engine}; {result.limited_by}; {result.seconds[0]:.1f} s and "
            f"{result.seconds[1]:.1f} s; {result.drawn.words}",
            flush=True,
        )
    print(f"{options.problems} problems, stops struck in {struck}: {', '.join(f'{n} {word}' for word, n in counts.items())}")
    judged = options.problems - counts["unsure"]
    return int(counts["wrong"] > 0 or counts["missed"] > 0.01 * judged)


if __name__ == "__main__":
    sys.exit(main())
