"""Sampled histories: read without keeping them, and their extremes."""

from wirerope_mj.assessment.between_samples import sample_rate
from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.arrays import Array


def read_columns(response: Response, first: str, count: int) -> Array:
    """Return `count` columns from the one named `first` on, (n_t, count).

    They are not kept in the response: of a long one in a file only what is looked at is in memory.
    """
    column = response.samples.names.index(first)
    return response.samples.columns(column, column + count)


def read_start(response: Response, first: str, count: int) -> Array:
    """Return the first sample of `count` columns from the one named `first` on, (count,)."""
    column = response.samples.names.index(first)
    return next(iter(response.samples.blocks(column, column + count)))[0]


def sampled_text(time: Array) -> str:
    """Return at what rate something is sampled, as a note of what is not judged for it."""
    return f"sampled at {sample_rate(time):.4g} Hz"


def sampled_peak(time: Array, values: Array) -> tuple[float, float]:
    """Return the largest of `values` (n,) and its instant [s], refined by the parabola through the samples beside it."""
    k = int(values.argmax())
    if 0 < k < values.size - 1:
        before, here, after = values[k - 1 : k + 2].tolist()
        bend = before - 2.0 * here + after
        if bend < 0.0:
            shift = 0.5 * (before - after) / bend
            return here - 0.25 * (before - after) * shift, float(time[k] + shift * (time[k + 1] - time[k]))
    return float(values[k]), float(time[k])
