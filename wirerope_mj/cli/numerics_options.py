"""Options of commands that simulate: the accuracy for which a step is chosen, or the step itself."""

from collections.abc import Mapping
from typing import Any

from wirerope_mj.cli.function_options import own_option
from wirerope_mj.foundation.arguments import positive

ACCURACY = "error allowed, as a fraction of the peaks; the step is chosen for it: 1e-4 by default"
TIMESTEP = "largest step [s], in place of one that is chosen; no error is estimated then"

NUMERICS = (
    own_option("accuracy", float | None, None, ACCURACY),
    own_option("timestep", float | None, None, TIMESTEP),
)


def with_numerics(simulate: Mapping[str, Any], *, accuracy: float | None, timestep: float | None) -> dict[str, Any]:
    """Return arguments of `simulate` with the accuracy or the step that was asked for in place of their own.

    Raises:
        ValueError: both are given, or one is out of range.
    """
    if accuracy is not None and timestep is not None:
        raise ValueError(
            "`--accuracy` and `--timestep` exclude each other: a step is either chosen for an accuracy or given. Give one."
        )
    if accuracy is not None and not 0.0 < accuracy < 1.0:
        raise ValueError(f"`--accuracy` is a fraction of the peaks, above 0 and below 1, got {accuracy:g}.")
    if timestep is not None:
        positive("--timestep", timestep, unit="s")
    given = {name: value for name, value in (("accuracy", accuracy), ("timestep", timestep)) if value is not None}
    kept = {name: value for name, value in simulate.items() if not given or name not in ("accuracy", "timestep")}
    return kept | given
