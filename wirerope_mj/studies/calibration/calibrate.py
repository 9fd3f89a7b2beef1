"""A system and its tests to what varies, with its uncertainty."""

from collections.abc import Mapping, Sequence

from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.studies.calibration.fit import Forward, Problem, fit
from wirerope_mj.studies.calibration.forward import SystemForward, Test
from wirerope_mj.studies.calibration.noise import Series
from wirerope_mj.studies.calibration.posterior import sample
from wirerope_mj.studies.calibration.prior import Prior
from wirerope_mj.studies.calibration.result import Calibrated, Calibration
from wirerope_mj.studies.calibration.spectral import DOMAINS, Domain
from wirerope_mj.studies.inputs.distributions import Distribution
from wirerope_mj.studies.inputs.vary_option import read_vary


def calibrate(
    system: System, tests: Sequence[Test], *, vary: Mapping[str, Distribution] | Sequence[str], residuals: Domain = "time",
    draws: int = 1000, seed: int = 1,
) -> Calibration:  # fmt: skip
    """Return what varies of a system as its tests tell it: values, covariance, draws, and the system with them.

    A coarse design of the prior, computed in lanes, gives the best points from which least squares begin. Noise and the model's
    own error are estimated for every channel with the unknowns integrated out; draws are emcee's on a quadratic emulator that
    is checked against runs.

    Args:
        system: as far as it is known.
        tests: measured channels with the base's motion, frequency responses, loops of an isolator in a rig.
        vary: priors of what is to be found, by the names that a study takes, and of channels as "channel/NAME/gain", "delay" or
            "offset"; or the same as lines of text.
        residuals: "time", or "srs" or "spectrum" for the logarithms of the channels' spectra; frequency responses and loops are
            compared as they are.
        draws: of the posterior.
        seed: of design and sampler.

    Raises:
        ValueError: a prior is missing, or is none that can be calibrated.
        ModelError: a name stands for nothing in the system.
        RecordError: a channel is not of this system, is too short or dead.
        ConvergenceError: the model cannot be computed within the priors.
    """
    if not tests:
        raise ValueError("`tests` must name one measured test at least, got none.")
    one_of("residuals", residuals, DOMAINS)
    distributions = dict(vary) if isinstance(vary, Mapping) else read_vary(vary)
    forward = SystemForward(system, tests, distributions, residuals)
    own = calibrate_model(forward, forward.series, forward.prior, draws=draws, seed=seed)
    return Calibration(problem=own.problem, fit=own.fit, posterior=own.posterior, forward=forward)


def calibrate_model(
    forward: Forward, series: Sequence[Series], prior: Prior, *, draws: int = 1000, seed: int = 1
) -> Calibrated:
    """Return the unknowns of any forward model as measured series tell them; arguments as those of `calibrate`."""
    problem = Problem(forward, series, prior)
    found = fit(problem, seed=seed)
    return Calibrated(problem=problem, fit=found, posterior=sample(problem, found, draws=draws, seed=seed))
