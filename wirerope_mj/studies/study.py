"""A study: its variants computed on all cores or on a cluster, into one table in a folder."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from time import perf_counter

from wirerope_mj.engine.simulation.progress import share_bar
from wirerope_mj.engine.simulation.recorder import column_plan
from wirerope_mj.engine.simulation.run import warn_of_aliasing, warn_of_missing_modes
from wirerope_mj.foundation.arguments import integer, one_of
from wirerope_mj.foundation.processes import processors
from wirerope_mj.studies.definition import StudyDefinition
from wirerope_mj.studies.engines.compute import Chunk, Engine
from wirerope_mj.studies.engines.local import run_local
from wirerope_mj.studies.folder import TABLE, finish, finished_chunks, study_folder, write_part
from wirerope_mj.studies.inputs_file import KEPT, PEAKS, RESPONSES
from wirerope_mj.studies.measures import measure_names, needs_samples
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.varied import summary
from wirerope_mj.studies.search.result import read_result


class Study(StudyDefinition):
    """Variants of one system under one base motion, or under several.

    What varies is named as follows; NAME may hold * and ?, and then stands for all that match, and several may be joined by
    commas: "mount/m01,m05,-m04,-m08/position_shift/x" moves the first two one way and the others, behind a minus, as far the
    other way. Values of a relative distribution are factors on what the model says; a name that ends in _shift is added to it;
    everything else replaces it::

        mount/NAME/AXIS/PARAMETER     value of a parameter of the law on axis roll, shear or axial [SI, as the law states];
                                      relative: a factor on what the isolator says
        mount/NAME/stiffness          factor on all forces of a mount, friction included
        mount/NAME/damping            factor on what dissipates in a mount
        mount/NAME/friction           factor on its friction alone, without dampers
        mount/NAME/stiffening/cycles, mount/NAME/stiffening/after_50
                                      values of an isolator with [stiffening]; relative: factors on them
        mount/NAME/isolator           Choice of the names of isolator files, of the same laws as the model's, or of the vendors'
                                      parts by a pattern such as "CB1400-*"; the foundation follows their height
        mount/NAME/spread             the isolator's [spread], as `Specimens`
        mount/NAME/position_shift/x   shift of the mount along a world axis [m]
        mount/NAME/turn/x             angle by which the mount turns about a world axis [deg]; several make a rotation vector
        mount/NAME/fitted             Choice of True and False: whether there is a mount at this place
        mount/NAME/failed             Choice of True and False, or of the name of the mount that has failed ("" = none)
        joint/NAME/frequency          natural frequency [Hz] that a joint's spring gives what stands on it alone
        body/NAME/mass                mass [kg] with the moments of inertia; relative: a factor on both
        body/NAME/centre/x            value: the centre of mass along an axis of the body, from the body's origin [m], as
                                      <inertial pos="..."/> says it in the model
        body/NAME/centre_shift/x      shift of the centre of mass along a world axis [m]
        motion/level                  factor on the motion
        motion/azimuth, motion/elevation
                                      direction of a motion along one line [deg], from x towards y and above that plane
        motion/record                 index in `motions`

    Names joined by " & " share a draw. A `centre` whose values are nearer to 0 than to the model's is refused, because shifts
    look like that.

    All arguments are attributes, and further:

    Attributes:
        base: the system as the model and `changes` say it.
        motions: the base motions; one, or those among which "motion/record" chooses.
        quantities: what varies, resolved.
        size: number of variants.
    """

    def run(
        self, folder: str | Path, *, keep: str = "peaks", engine: str = "local", workers: int | None = None,
        address: str | None = None, resume: bool = False, force: bool = False, progress: bool = False,
        when_done: Callable[[StudyResult], object] = lambda result: None,
    ) -> StudyResult:  # fmt: skip
        """Compute all variants and return the result, which is stored in `folder`.

        Finished parts of the table are kept whatever happens: a study that was killed goes on with what is missing. Its table
        has the same bits whatever the engine, the number of workers and the number of interruptions.

        Args:
            folder: of the study; it must not exist, or be empty, or be this study with `resume`, or any study with `force`.
            keep: "peaks": the table alone; "responses": the whole response of every variant, too, in `responses/`, which
                `StudyResult.response` reads.
            engine: "local": processes of this machine; "dask": the workers of a cluster.
            workers: number of processes; None for one per processor, 1 for this process itself.
            address: of a Dask scheduler that exists; None for a cluster of this machine's own.
            resume: whether the study that stands there goes on; it starts if there is none.
            force: whether a study that stands there is replaced, once this one is done.
            progress: whether a progress bar is shown on standard error.
            when_done: called with the result before that takes the place of another, to write more into its folder. An error
                of it is raised once it has; where something could not be written the other stays.

        Raises:
            ValueError: an argument is out of range.
            ModelError: a variant cannot be; says which and why.
            RecordError: the folder is not that of this study.
            SimulationError: the cluster cannot be reached, or what would replace another study is not whole.
        """
        folder = Path(folder)
        run = checked_engine(engine, workers=workers, address=address)
        one_of("keep", keep, KEPT)
        self.check()  # before anything is written

        def call(place: Path) -> None:
            when_done(read_result(place, type(self)))

        with study_folder(self, folder, keep=keep, resume=resume, force=force, when_done=call) as place:
            warn_of_missing_modes(self.base, self.motions)
            if keep == RESPONSES:
                warn_of_aliasing(self.motions, self.sample_rate)
            if not (place / TABLE).is_file():
                self.warn_of_given_step()
                size = chunk_size(self, keep)
                missing = sorted(set(range(math.ceil(self.size / size))) - finished_chunks(place))
                already = self.size - sum(min(size, self.size - number * size) for number in missing)
                used = 1 if engine != "local" else workers or processors()
                with share_bar(
                    "study", "variants/s", total=self.size, parts="variants", enabled=progress, begun=already / self.size,
                    memory=(used > 1) * used * memory_of_worker(keep), disk=disk_of(self, keep),
                ) as update:  # fmt: skip
                    began, ended = perf_counter(), 0
                    parts = run(self.work, chunks(self, missing, keep), workers=workers, address=address)
                    with closing(parts):  # no process goes on after this one
                        for part in parts:
                            write_part(place, part)
                            ended += part.table.num_rows
                            update((already + ended) / self.size, ended / (perf_counter() - began))
            finish(place, math.ceil(self.size / chunk_size(self, keep)), lambda: summary(read_result(place, type(self))))
        return read_result(folder, type(self))


def load_study(folder: str | Path) -> StudyResult:
    """Load the result of a study from its folder alone; of an interrupted one, its finished part.

    Raises:
        RecordError: the folder is not that of a study, or is damaged.
    """
    return read_result(Path(folder), Study)


CHUNK, _LARGEST_CHUNK = 32, 512  # variants, at the least and at the most: enough that stepping costs more than handing over
STEPS = 1_000_000  # mounts times steps of a chunk, about: half a second of a processor, which a kill may cost each worker
_FEWEST_CHUNKS = 16  # Chunks that a small study has, so that all workers have something to do until the end
# Samples of a chunk that are kept in memory [bytes]: 32 variants of a floor on 24 mounts with 400 samples each. The response
# of one variant may be larger; it is then alone.
MEMORY = 64 * 2**20
_ENGINES = ("local", "dask")


def chunk_size(study: StudyDefinition, keep: str = PEAKS) -> int:
    """Return the number of variants in a chunk; it depends on the study alone, so that other workers can resume it."""
    each = max(len(study.base.mounts), 1) * study.work.duration / study.work.timestep
    size = min(max(CHUNK, min(int(STEPS / each), _LARGEST_CHUNK)), math.ceil(study.size / _FEWEST_CHUNKS))
    if keep != RESPONSES and not needs_samples(study.base):
        return size
    samples = (int(study.work.duration * study.work.sample_rate) + 1) * len(column_plan(study.base).names)
    return min(size, max(MEMORY // (8 * samples), 1))


def memory_of_worker(keep: str = PEAKS) -> float:
    """Return about what a process that computes chunks takes of its own [B], beside the code that it shares with others."""
    return 1.2e8 + (3.0 * MEMORY if keep == RESPONSES else 0.0)


def disk_of(study: StudyDefinition, keep: str = PEAKS) -> float:
    """Return the size of a study's table, and of its variants' samples if they are kept [B]."""
    numbers = len(study.work.columns) + len(measure_names(study.base))
    if keep == RESPONSES:
        numbers += int(study.work.duration * study.work.sample_rate) * len(column_plan(study.base).names)
    return 8.0 * study.size * numbers


def chunks(study: StudyDefinition, numbers: Sequence[int], keep: str = PEAKS) -> Iterator[Chunk]:
    """Yield the chunks of variants with these numbers."""
    size = chunk_size(study, keep)
    for number in numbers:
        rows = study.rows(number * size, min(size, study.size - number * size)).to_pylist()
        yield Chunk(number=number, rows=rows, responses=keep == RESPONSES)


def checked_engine(name: str, *, workers: int | None, address: str | None) -> Engine:
    """Return the function that computes chunks by the engine `name`; ValueError if an argument does not suit it."""
    if workers is not None:
        integer("workers", workers, least=1)
    one_of("engine", name, _ENGINES)
    if name == "local":
        if address is not None:
            raise ValueError(f"`address` is for an engine with a cluster; the local engine has none, got {address!r}.")
        return run_local
    from wirerope_mj.studies.engines.dask_engine import check_cluster, run_dask  # an extra that is not always installed

    check_cluster(workers, address)  # before anything is checked or written
    return run_dask
