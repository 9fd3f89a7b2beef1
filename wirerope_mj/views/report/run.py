"""A finished run with everything that a report needs of it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from wirerope_mj.assessment.criteria import Verdict, acceleration_verdicts, body_peaks
from wirerope_mj.dynamics.modes import Modes
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.statics import StaticTable
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.motions import BaseMotion
from wirerope_mj.motions.spectra import PowerSpectralDensity, ShockResponseSpectrum
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.views.display import title_of
from wirerope_mj.views.plots.report_response import MOST
from wirerope_mj.views.selection import Selection

BASE = "base"
"""Name of the base among the spectra."""


@dataclass(frozen=True, kw_only=True)
class FinishedRun:
    """A run with everything that is known of it.

    Attributes:
        name: of the scenario.
        question: of the scenario, paragraphs apart by an empty line.
        written: when it was simulated.
        model: name of the model's file.
        options: of the scenario, by name.
        initial: where the simulation started: "settled", "relaxed" or "unloaded".
        duration: simulated time [s].
        sample_rate: of the response [Hz].
        motion: of the base.
        record_warnings: warnings of its measured records.
        response: what came out.
        isolators: of every mount, by the mount's name.
        gravity: of the model [m/s^2].
        statics: where the system rests, on the first loading and relaxed.
        modes: about these positions by history, "virgin" and "relaxed".
        spectra: shock response spectra by axis ("x", "y", "z") and name of body or point; that of the base is `BASE`.
        densities: power spectral densities in the same way, if the base vibrates at random.
        spectra_held: frequency up to which samples hold shock response spectra within 1 % [Hz].
        verdicts: on every judged value.
        random: rms and 3-sigma accelerations of random vibration.
        untested: a sentence on mounts that leave what their laws were identified from; "" where none does.
        model_warnings: what the model says that is perhaps not meant.
        versions: of the packages that computed it.
        selection: what is shown of it, with its colours.
    """

    name: str
    question: str
    written: str
    model: str
    options: Mapping[str, Any]
    initial: str
    duration: float
    sample_rate: float
    motion: BaseMotion
    record_warnings: tuple[str, ...]
    response: Response
    isolators: Mapping[str, Isolator]
    gravity: float
    statics: StaticTable | Absent
    modes: Mapping[str, Modes | Absent]
    spectra: Mapping[str, Mapping[str, ShockResponseSpectrum]] | Absent
    densities: Mapping[str, Mapping[str, PowerSpectralDensity]]
    spectra_held: float
    verdicts: tuple[Verdict, ...]
    versions: Mapping[str, str]
    selection: Selection
    random: tuple[Verdict, ...] | Absent = ()
    untested: str = ""
    model_warnings: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """The scenario's name as text."""
        return title_of(self.name)


def worst_names(response: Response) -> list[str]:
    """Return the bodies and points to draw, three at most; of those that move alike, the first.

    First those that are nearest to their limits of acceleration, then others with limits, then the largest accelerations.
    """
    names: list[str] = []
    peaks: list[tuple[float, ...]] = []
    used = dict.fromkeys((limit.name for limit in response.scene.limits), 0.0)
    for verdict in acceleration_verdicts(response):  # from the peaks alone: rattle space would take every sample
        if verdict.utilisation is not None:
            used[verdict.subject] = max(verdict.utilisation, used[verdict.subject])
    for row in sorted(body_peaks(response), key=lambda row: -used.get(row.name, -1.0)):  # else as they are: by size
        size = (row.value, *row.axes)
        alike = any(np.allclose(size, other, rtol=1e-6, atol=1e-9) for other in peaks)  # a point of what cannot turn
        if row.kind != "base" and not alike:
            names.append(row.name)
            peaks.append(size)
    return names[:MOST]
