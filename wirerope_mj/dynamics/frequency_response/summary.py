"""Summary of a frequency response, level by level: what the command prints, and what its file holds."""

from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from wirerope_mj.dynamics.frequency_response.comparison import SweepComparison, compare
from wirerope_mj.dynamics.frequency_response.curve import BranchCurve, curve_of
from wirerope_mj.dynamics.frequency_response.peaks import ResonancePeak, peaks_of
from wirerope_mj.dynamics.frequency_response.result import FrequencyResponse, Level
from wirerope_mj.foundation.json_values import json_values


@dataclass(frozen=True, kw_only=True)
class LevelSummary:
    """Curve, peaks and comparisons of one level, each computed at first use."""

    level: Level

    @cached_property
    def curve(self) -> BranchCurve | None:
        """The branch as a fine line."""
        return None if self.level.branch is None else curve_of(self.level.branch)

    @cached_property
    def peaks(self) -> list[ResonancePeak]:
        """Peaks of the branch, the highest first."""
        return [] if self.level.branch is None else peaks_of(self.level.branch)

    @cached_property
    def comparisons(self) -> dict[str, SweepComparison]:
        """Comparisons of the sweeps with the branch, by their direction."""
        return {
            direction: compare(sweep, self.level.branch, self.curve) for direction, sweep in self.level.sweeps.items()
        }


def level_summaries(result: FrequencyResponse) -> list[LevelSummary]:
    """Return the summaries of all levels."""
    return [LevelSummary(level=level) for level in result.levels]


def summary(findings: list[LevelSummary]) -> list[dict[str, Any]]:
    """Return the summaries as plain values, SI units, None where there is no number."""
    return [_level(one) for one in findings]


def _level(summary: LevelSummary) -> dict[str, Any]:
    level, branch = summary.level, summary.level.branch
    content: dict[str, Any] = {"acceleration": level.acceleration}
    if branch is not None:
        content["continuation"] = {
            "points": int(branch.frequency.size),
            "complete": branch.complete,
            "message": branch.message,
            "model_steps": branch.model_steps,
            "seconds": round(level.branch_seconds, 3),
            "peaks": [asdict(peak) for peak in summary.peaks],
            "bifurcations": [
                {
                    "kind": event.kind, "frequency": event.frequency, "amplitude": event.amplitude,
                    "multiplier": [event.multiplier.real, event.multiplier.imag],
                    "unstable_before": event.before, "unstable_after": event.after,
                }
                for event in branch.bifurcations
            ],
            "jumps": [asdict(jump) for jump in branch.jumps],
            "side_branches": [asdict(side) for side in branch.side_branches],
        }  # fmt: skip
    for direction, sweep in level.sweeps.items():
        content[f"sweep_{direction}"] = asdict(summary.comparisons[direction]) | {
            "jumps": [[jump.fold, jump.frequency] for jump in summary.comparisons[direction].jumps],
            "cycles": int(sweep.frequency.size),
            "model_steps": sweep.model_steps,
            "warnings": list(sweep.warnings),
        }
    if level.sweeps:
        content["sweep_seconds"] = round(level.sweep_seconds, 3)
    plain: dict[str, Any] = json_values(content)
    return plain
