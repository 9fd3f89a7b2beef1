"""Peaks under another motion of the base, as a calibration predicts them, with bands."""

import math
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import choose_timestep
from wirerope_mj.foundation.arguments import integer
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.motions import BaseMotion, Scaled
from wirerope_mj.studies.calibration.calibrate import LEVEL, Calibration
from wirerope_mj.studies.calibration.measured_test import ACCURACY, MeasuredTest
from wirerope_mj.studies.engines.compute import DONE, Chunk, compute
from wirerope_mj.studies.inputs.variants import Work
from wirerope_mj.studies.measures import measure_names

DRAWS = 64  # Draws of the posterior that are run: a band's ends are then known to a sixth of its half width
ERRORS = 16  # Errors of the model with which each draw is multiplied: they cost nothing
SAMPLE_RATE = 1000.0  # Samples at which steps end [Hz]
# Levels at which draws are run where stops close, as multiples of the model's own error about the motion's own level
STEPS = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
LEAST = 0.1  # Least of these levels over the motion's own
# Measures on which the model's own error has no effect: counts, and loads at rest
UNSCALED = ("mounts", "struck", "static_load")


@dataclass(frozen=True, kw_only=True, repr=False)
class Prediction(Summarised):
    """Measures of a study, `ERRORS` rows a draw of the posterior."""

    names: tuple[str, ...]  #: of the measures, as `Study` has them
    samples: Array  #: with the model's own error, (n, n_measures), SI
    peak_error: float  #: the model's own error of a peak, over it [-]
    beyond: float  #: largest deflection over that in the tests, at least 1
    motion: str  #: of the base, in words

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {}
        for name in self.names:
            if np.isfinite(self.samples[:, self.names.index(name)]).all():
                low, high = self.band(name)
                lines[name] = f"{low:.4g} to {high:.4g}"
        return f"Prediction for {self.motion}: {len(self.samples) // ERRORS} draws, {100.0 * LEVEL:.0f} % bands", lines

    def values(self, name: str) -> Array:
        """Return the draws of one measure [SI], (n,)."""
        if name not in self.names:
            raise ValueError(f"there is no measure {name!r}; there is {', '.join(self.names)}.")
        return self.samples[:, self.names.index(name)]

    def band(self, name: str, level: float = LEVEL) -> tuple[float, float]:
        """Return the ends of the central band of a measure [SI]."""
        low, high = np.quantile(self.values(name), [0.5 - 0.5 * level, 0.5 + 0.5 * level])
        return float(low), float(high)

    def exceedance(self, name: str, limit: float) -> float:
        """Return the probability that a measure exceeds a limit [SI]."""
        return float(np.mean(self.values(name) > limit))


def predict(
    calibration: Calibration, motion: BaseMotion, *, duration: float, initial: str = "settled", draws: int = DRAWS,
    seed: int = 1,
) -> Prediction:  # fmt: skip
    """Return the measures of draws of the posterior under a motion of the base.

    Every draw is multiplied by 1 + e, where e is the model's own error of a peak: Student's t with as many degrees of freedom
    as errors of peaks in the tests are known, and of their size. Where the mounts deflect farther than in the tests, it
    grows in proportion. Where stops close, or would for an error of twice that size, peaks are not in proportion to each
    other: e changes the level of the motion instead, and all peaks but forces are what follows from it. The model's own error
    stands in these draws once: their values are those of the posterior, without the part that `Calibration.samples` add for it.

    Raises:
        ConvergenceError: no draw could be simulated.
    """
    forward, count = calibration.forward, integer("draws", draws, least=8)
    generator = np.random.default_rng(seed)
    start = initial_state(calibration.system, motion, initial)
    step = choose_timestep(
        calibration.system, motion, start, duration=duration, sample_rate=SAMPLE_RATE, accuracy=ACCURACY
    ).timestep
    work = Work(
        system=forward.system, motions=(motion,), columns=forward.columns, duration=duration, timestep=step,
        sample_rate=SAMPLE_RATE, initial=initial, corners=motion.corners,
    )  # fmt: skip
    posterior = calibration.posterior.values
    chosen = posterior[generator.choice(len(posterior), count, replace=False)]
    samples = _measures(work, chosen)
    measures = tuple(measure_names(forward.system))
    tested = [
        _measures(replace(work, motions=(test.motion,), initial=test.initial), calibration.values[np.newaxis])
        for test in forward.tests
        if isinstance(test, MeasuredTest)
    ]
    reached = [k for k, name in enumerate(measures) if name.startswith("deflection/")]
    beyond = (
        float(np.nanmedian(samples[:, reached].max(axis=1)) / max(np.max(one[:, reached]) for one in tested)) if tested else 1.0
    )
    beyond = max(beyond, 1.0)
    size, peaks = calibration.peak_error
    size = beyond * math.hypot(size, ACCURACY)  # of the peaks of runs and of those of tests alike
    error = generator.standard_t(peaks, count * ERRORS)
    scaled = [k for k, name in enumerate(measures) if name not in UNSCALED]
    struck, farther = measures.index("struck"), _at_level(work, calibration.values[np.newaxis], 1.0 + size * STEPS[-1])
    own, stopped = samples, (samples[:, struck] > 0.0).any() or (farther[:, struck] > 0.0).any()
    samples = np.repeat(samples, ERRORS, axis=0)
    samples[:, scaled] *= np.maximum(1.0 + size * error, 0.0)[:, np.newaxis]
    if stopped:  # a mount's force is off by the error of its law at any deflection
        levels = [own if step == 0.0 else _at_level(work, chosen, max(1.0 + size * step, LEAST)) for step in STEPS]
        between = _between(np.array(levels), error.reshape(count, ERRORS)).reshape(-1, len(measures))
        followed = [k for k in scaled if not measures[k].startswith("force/")]
        failed = np.isnan(between[:, followed])  # those draws stay multiplied
        samples[:, followed] = np.where(failed, samples[:, followed], between[:, followed])
    samples = samples[~np.isnan(samples).all(axis=1)]
    return Prediction(names=measures, samples=samples, peak_error=size, beyond=beyond, motion=motion.description)


def _at_level(work: Work, values: Array, factor: float) -> Array:
    """Return measures as `_measures` does, of the motion times a factor; NaN if no draw can be simulated."""
    try:
        return _measures(replace(work, motions=(Scaled(work.motions[0], factor),)), values)
    except ConvergenceError:
        return np.full((len(values), len(measure_names(work.system))), np.nan)


def _between(levels: Array, errors: Array) -> Array:
    """Return measures of draws (n_steps, n, n_measures) at multiples of the error (n, n_errors) between `STEPS`, and beyond."""
    left = np.clip(np.searchsorted(STEPS, errors) - 1, 0, STEPS.size - 2)
    draws = np.arange(len(errors))[:, np.newaxis]
    low, high = levels[left, draws], levels[left + 1, draws]
    return np.maximum(low + (high - low) * (errors - STEPS[left])[..., np.newaxis], 0.0)


def _measures(work: Work, values: Array) -> Array:
    """Return the measures of a study at values of the unknowns (n, d), NaN of those that fail, (n, n_measures)."""
    names = [column.name for column in work.columns]
    rows = [{"variant": k, **dict(zip(names, row.tolist(), strict=False))} for k, row in enumerate(values)]
    table = compute(work, Chunk(number=0, rows=rows)).table
    done = np.array(table["status"]) == DONE
    if not done.any():
        raise ConvergenceError(f"no draw of the posterior can be simulated: {table['message'][0]}")
    return np.where(
        done[:, np.newaxis], np.stack([table[name].to_numpy() for name in measure_names(work.system)], axis=1), np.nan
    )
