"""Peaks under another motion of the base, as a calibration predicts them, with bands."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import choose_timestep
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import integer
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.foundation.summary import Summarised
from wirerope_mj.motions import BaseMotion, Scaled
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.studies.calibration.calibrate import DISCREPANT, LEVEL, Calibration
from wirerope_mj.studies.calibration.forward import SystemForward, travel_of
from wirerope_mj.studies.calibration.measured_test import ACCURACY, MeasuredTest
from wirerope_mj.studies.calibration.open_law import LOOKED_AT, rises
from wirerope_mj.studies.calibration.rig_tests import FrequencyTest
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.vary.variants import Work

FARTHER = 1.05  # Predicted over tested deflection from which on the law there counts as untested: 5 % is a peak's error
DRAWS = 64  # Draws of the posterior that are run: a band's ends are then known to a sixth of its half width
FEWEST = 0.5  # Fraction of the draws of opened laws whose forces must rise with deflection for these draws to be used
ERRORS = 16  # Errors of the model with which each draw is multiplied: they cost nothing
SAMPLE_RATE = 1000.0  # Samples at which steps end [Hz]
# Levels at which draws are run where stops close, as multiples of the model's own error about the motion's own level
STEPS = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
LEAST = 0.1  # Least of these levels over the motion's own
# Measures on which the model's own error has no effect: counts, and loads at rest
UNSCALED = ("mounts", "struck", "static_load")


@dataclass(frozen=True, kw_only=True)
class Travel:
    """A deflection of a mount, predicted and tested."""

    mount: str  #: name of the mount; "" where nothing deflects
    axis: str  #: "roll", "shear" or "axial"
    reached: float  #: median of the prediction [m]
    tested: float  #: largest in the tests, as the calibrated model has it [m]

    @property
    def ratio(self) -> float:
        """Predicted over tested deflection, at least 1."""
        return max(self.reached / self.tested, 1.0) if self.tested > 0.0 else 1.0 if self.reached == 0.0 else math.inf

    @property
    def beyond(self) -> bool:
        """Whether the predicted deflection exceeds the tested one by more than a peak's error."""
        return self.ratio > FARTHER

    @property
    def text(self) -> str:
        return (
            f"beyond the tested {1e3 * self.tested:.3g} mm: mount {self.mount!r} deflects {1e3 * self.reached:.3g} mm "
            f"{'axially' if self.axis == 'axial' else f'along its {self.axis} axis'}, and no test says what its law does there"
        )


@dataclass(frozen=True, kw_only=True, repr=False)
class Prediction(Summarised):
    """Predicted measures of a study, `ERRORS` rows for each draw of the posterior."""

    names: tuple[str, ...]  #: of the measures, as `Study` has them
    samples: Array  #: with the model's own error, (n, n_measures), SI
    peak_error: float  #: the model's own error of a peak, over it [-]
    farthest: Travel  #: the deflection that is farthest beyond those of the tests
    #: measures that are not predicted: no test measured them, and the model does not follow what the tests measured
    refused: tuple[str, ...]
    hardening: bool  #: whether the bands hold what the tests leave open of how the laws harden
    motion: str  #: of the base, in words

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {}
        for name in self.names:
            if np.isfinite(self.samples[:, self.names.index(name)]).all():
                low, high = self.band(name)
                lines[name] = f"{low:.4g} to {high:.4g}"
        beyond = f", {self.farthest.text}" if self.farthest.beyond else ""
        return f"Prediction for {self.motion}{beyond}: {len(self.samples) // ERRORS} draws, {100.0 * LEVEL:.0f} % bands", lines

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
        """Return the probability that a measure exceeds a limit [SI]; NaN of one that is not predicted."""
        values = self.values(name)
        return math.nan if np.isnan(values).all() else float(np.mean(values[~np.isnan(values)] > limit))


def predict(
    calibration: Calibration, motion: BaseMotion, *, duration: float, initial: str = "settled", draws: int = DRAWS,
    seed: int = 1,
) -> Prediction:  # fmt: skip
    """Predict the measures of a study under a motion of the base, for draws of the posterior.

    Draws are those of `Calibration.opened`, whose laws harden, and are unlike on their two sides, as far as the tests leave
    that open: within the tested travel little, beyond it what such laws may do there. A rope's force rises with deflection:
    draws whose laws fall within what they travel, or fail, are left out, and where those are most, draws are of the laws as
    they are.

    Each is multiplied by 1 + e, where e is the model's own error of a peak: Student's t with as many degrees of freedom as
    errors of peaks are known from the tests, and of their rms; for what no test measured, of that of the laws as they are if
    it is larger, since what only opened laws follow may be something else, such as a mode. Where the mounts deflect farther
    than in the tests, it grows in proportion. Where stops close, or would for an error of twice that size, peaks are not in
    proportion to each other: e changes the level of the motion instead, and all peaks but forces are what follows from it. The
    draws of the unknowns are not widened by the model's own error, so that it counts once.

    Raises:
        ConvergenceError: no draw could be simulated.
    """
    count, generator = integer("draws", draws, least=8), np.random.default_rng(seed)
    # of the laws as they are: among opened ones are such whose force falls, and which fail at any step
    start = initial_state(calibration.system, motion, initial)
    step = choose_timestep(
        calibration.system, motion, start, duration=duration, sample_rate=SAMPLE_RATE, accuracy=ACCURACY
    ).timestep
    measures = tuple(measure_names(calibration.system))
    for used in (calibration.opened, calibration):
        forward = used.forward
        work = Work(
            system=forward.system, motions=(motion,), columns=forward.columns, duration=duration, timestep=step,
            sample_rate=SAMPLE_RATE, initial=initial, corners=motion.corners,
        )  # fmt: skip
        chosen = used.posterior.values[generator.choice(len(used.posterior.values), count, replace=False)]
        samples = forward.measures(work, chosen) if used is calibration else _at_level(forward, work, chosen, 1.0)
        kept = np.array([not np.isnan(row).all() for row in samples])
        if used is calibration:
            break
        for row in np.flatnonzero(kept):
            kept[row] = _forces_rise(calibration.system, forward.isolators_at(chosen[row]), travel_of(measures, samples[row]))
        if kept.sum() >= FEWEST * count:
            break
    chosen, samples, count = chosen[kept], samples[kept], int(kept.sum())
    reached, tested = travel_of(measures, np.median(np.nan_to_num(samples), axis=0)), calibration.tested_travel
    # of those that are not small beside the largest
    large = [key for key, value in reached.items() if value >= LOOKED_AT * max(reached.values()) > 0.0]
    travels = [Travel(mount=key[0], axis=key[1], reached=reached[key], tested=tested[key]) for key in large]
    farthest = max(travels, key=lambda travel: travel.ratio, default=Travel(mount="", axis="", reached=0.0, tested=0.0))
    most, before = max(reached.values(), default=0.0), max(tested.values(), default=0.0)
    farther, (peak_error, peaks) = max(most / before, 1.0) if before > 0.0 else 1.0, used.peak_error
    channels = {
        f"{channel.quantity}/{channel.subject.partition('/')[2]}"
        for test in forward.tests if isinstance(test, MeasuredTest) for channel in test.channels
    } | {f"acceleration/{test.payload}" for test in forward.tests if isinstance(test, FrequencyTest)}  # fmt: skip
    measured = np.array(["/".join(name.split("/")[:2]) in channels for name in measures])
    # of the peaks of runs and of those of tests alike; what terms explain that were added may be due to something else
    errors = np.where(measured, peak_error, max(peak_error, calibration.peak_error[0]))
    sizes = farther * np.hypot(errors, ACCURACY)
    size, error = float(sizes.max()), generator.standard_t(peaks, count * ERRORS)
    scaled = [k for k, name in enumerate(measures) if name not in UNSCALED]
    higher = _at_level(forward, work, np.median(chosen, axis=0)[np.newaxis], 1.0 + size * STEPS[-1])
    nominal, stopped = samples, (np.concatenate([samples, higher])[:, measures.index("struck")] > 0.0).any()
    samples = np.repeat(samples, ERRORS, axis=0)
    samples[:, scaled] *= np.maximum(1.0 + sizes[scaled] * error[:, np.newaxis], 0.0)
    if stopped:  # a mount's force is off by the error of its law at any deflection
        levels = [nominal if step == 0.0 else _at_level(forward, work, chosen, max(1.0 + size * step, LEAST)) for step in STEPS]
        # straight between `STEPS`, and beyond
        errors = error.reshape(count, ERRORS)
        lower, rows = np.clip(np.searchsorted(STEPS, errors) - 1, 0, STEPS.size - 2), np.arange(count)[:, np.newaxis]
        low, high = np.array(levels)[lower, rows], np.array(levels)[lower + 1, rows]
        between = np.maximum(low + (high - low) * (errors - STEPS[lower])[..., np.newaxis], 0.0).reshape(-1, len(measures))
        followed = [k for k in scaled if not measures[k].startswith("force/")]
        failed = np.isnan(between[:, followed])  # those draws stay multiplied
        samples[:, followed] = np.where(failed, samples[:, followed], between[:, followed])
    samples = samples[~np.isnan(samples).all(axis=1)]
    # what was measured is known with that error
    unknown = ~measured & ~np.isin(measures, UNSCALED) & (calibration.discrepancies.max() > DISCREPANT)
    samples[:, unknown] = np.nan
    refused = tuple(name for name, left_out in zip(measures, unknown, strict=True) if left_out)
    return Prediction(
        names=measures, samples=samples, peak_error=size, farthest=farthest, refused=refused,
        hardening=used is not calibration, motion=motion.description,
    )  # fmt: skip


def _forces_rise(system: System, isolators: Mapping[str, Isolator], travel: Mapping[tuple[str, str], float]) -> bool:
    """Tell whether forces of isolators rise over their travel [m], except where those of the system fall, too."""
    judged: set[tuple[int, str, float]] = set()  # mounts that vary together share their isolators
    for (mount, axis), reached in travel.items():
        law, before = (device.axes[axis] if device else None for device in (isolators.get(mount), system.mounts[mount].written))
        if law is None or before is None or (id(law), axis, reached) in judged:
            continue
        judged.add((id(law), axis, reached))
        if not rises(law, reached) and rises(before, reached):
            return False
    return True


def _at_level(forward: SystemForward, work: Work, values: Array, factor: float) -> Array:
    """Return the measures at values of unknowns (n, d) under the motion times a factor, (n, n_measures); NaN if all fail."""
    try:
        return forward.measures(replace(work, motions=(Scaled(work.motions[0], factor),)), values)
    except ConvergenceError:
        return np.full((len(values), len(measure_names(work.system))), np.nan)
