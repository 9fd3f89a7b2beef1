"""Whole responses of variants, kept beside the table on request: one file each, as a run's."""

from pathlib import Path
from tempfile import TemporaryDirectory

from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.engine.response.response import FILE
from wirerope_mj.engine.simulation.recorder import column_plan
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.studies.vary.variants import Work

RESPONSES = "responses"  # Folder of the responses, in that of the study
PEAKS = "peaks"
# Content that may be kept of each variant: the measures of its peaks, or its whole response, too.
KEPT = (PEAKS, RESPONSES)
# Samples of a chunk that are kept in memory [bytes]: 32 variants of a floor on 24 mounts with 400 samples each. The response
# of one variant may be larger; it is then alone.
MEMORY = 64 * 2**20


def most_together(work: Work) -> int:
    """Return how many variants of a study may have their samples in memory together."""
    columns = len(column_plan(work.system).names)
    samples = int(work.duration * work.sample_rate) + 1
    return max(MEMORY // (8 * columns * samples), 1)


def packed(response: Response) -> bytes:
    """Return a response as the content of its file, which is a fraction of the samples."""
    with TemporaryDirectory() as folder:
        response.save(folder)
        return (Path(folder) / FILE).read_bytes()


def write_response(folder: Path, variant: int, content: bytes) -> None:
    """Write the response of a variant into the study's `folder`, atomically."""
    path = _file(folder, variant)
    path.parent.mkdir(exist_ok=True)
    with atomic_file(path, clear=False) as beside:
        beside.write_bytes(content)


def kept_response(folder: Path, variant: int) -> Response | None:
    """Return the response of a variant as it was kept in the study's `folder`; None if it was not.

    RecordError if its file is damaged.
    """
    path = _file(folder, variant)
    try:
        return load_response(path) if path.is_file() else None
    except RecordError as error:
        raise RecordError(f"{error} It was kept by a study: remove it, and it is simulated when it is asked for.") from None


def kept_numbers(folder: Path) -> set[int]:
    """Return the numbers of the variants whose responses are kept in the study's `folder`."""
    return {int(path.stem) for path in (folder / RESPONSES).glob("*.parquet") if path.stem.isdigit()}


def _file(folder: Path, variant: int) -> Path:
    return folder / RESPONSES / f"{variant:06d}.parquet"
