"""A study: a system and a base motion, what varies of them, and how it is sampled."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow as pa

from wirerope_mj.excitation import BaseMotion
from wirerope_mj.isolator import Isolator
from wirerope_mj.response import Response
from wirerope_mj.study.distributions import Distribution
from wirerope_mj.study.result import StudyResult
from wirerope_mj.system import System


class Study:
    """Variants of one system under one base motion, or under several."""

    def __init__(
        self,
        *,
        model: str | Path,
        motion: BaseMotion | None = None,
        motions: Sequence[BaseMotion] = (),
        duration: float,
        vary: Mapping[str, Distribution],
        variants: int | None = None,
        sampling: str = "sobol",
        seed: int = 1,
        timestep: float | None = None,
        accuracy: float = 1e-4,
        sample_rate: float = 1000.0,
        initial: str = "settled",
        isolators: Mapping[str, Isolator] | None = None,
        name: str = "study",
        question: str = "",
    ) -> None:
        raise NotImplementedError

    def table(self) -> pa.Table:
        """Return the inputs of all variants: `variant` and one column for every sampled number."""
        raise NotImplementedError

    def system(self, variant: int) -> System:
        """Return the system of one variant."""
        raise NotImplementedError

    def motion(self, variant: int) -> BaseMotion:
        """Return the base motion of one variant."""
        raise NotImplementedError

    def response(self, variant: int) -> Response:
        """Return the whole response of one variant; its peaks are those of the study, bit for bit."""
        raise NotImplementedError

    def run(
        self,
        folder: str | Path,
        *,
        engine: str = "local",
        workers: int | None = None,
        address: str | None = None,
        resume: bool = False,
        force: bool = False,
        progress: bool = False,
    ) -> StudyResult:
        """Return the result."""
        raise NotImplementedError
