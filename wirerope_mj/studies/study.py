"""A study: a system and a base motion, what varies of them, and how it is sampled."""

from collections.abc import Mapping, Sequence
from copy import copy
from functools import cached_property
from pathlib import Path

import pyarrow as pa

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.grid import joined
from wirerope_mj.engine.simulation.simulate import check_arguments
from wirerope_mj.engine.system import Changes, System, load_system
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.resources import model_source
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.studies.inputs.check import check_variants
from wirerope_mj.studies.inputs.distributions import Distribution
from wirerope_mj.studies.inputs.meant import check_centres
from wirerope_mj.studies.inputs.quantities import Column, quantities
from wirerope_mj.studies.inputs.sampling import inputs
from wirerope_mj.studies.inputs.variants import Maker, Row, Work
from wirerope_mj.studies.responses import whole_number
from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.run import run_study
from wirerope_mj.studies.step import common_step

STARTS = ("settled", "relaxed", "unloaded")

GIVEN = "given"
"""What `sampling` says where the variants were not sampled, but given."""


class Study:
    """Variants of one system under one base motion, or under several.

    What varies is named as follows; NAME may hold * and ?, and then stands for all that match, and several may be joined by
    commas: "mount/m01,m05,-m04,-m08/position_shift/x" moves the first two one way and the others, behind a minus, as far the
    other way. Values of a relative distribution are factors on what the model says; a name that ends in _shift is added to it;
    everything else replaces it.

        mount/NAME/AXIS/PARAMETER     value of a parameter of the law on axis roll, shear or axial [SI, as the law states]
        mount/NAME/spread             the isolator's [spread], as `Specimens`
        mount/NAME/position_shift/x   shift of the mount along a world axis [m]
        mount/NAME/fitted             Choice of True and False: whether there is a mount at this place
        mount/NAME/failed             Choice of True and False, or of the name of the mount that has failed ("" = none)
        body/NAME/mass                mass [kg] with the moments of inertia; relative: a factor on both
        body/NAME/centre/x            value: the centre of mass along an axis of the body, from the body's origin [m], as
                                      <inertial pos="..."/> says it in the model
        body/NAME/centre_shift/x      shift of the centre of mass along a world axis [m]
        motion/level                  factor on the motion
        motion/azimuth, elevation     direction of a motion along one line [deg], from x towards y and above that plane
        motion/record                 index in `motions`

    A `centre` whose values are nearer to 0 than to the model's is refused, because shifts look like that.

    Attributes:
        base: the system as the model and `changes` say it.
        motions: the base motions; one, or those among which "motion/record" chooses.
        quantities: what varies, resolved.
        size: number of variants.
        All arguments, too.
    """

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
        changes: Sequence[Changes] = (),
        name: str = "study",
        question: str = "",
        folder: Path | None = None,
    ) -> None:
        """Prepare a study; nothing is simulated, and names and distributions are checked.

        Args:
            model: MJCF file or text; a relative path starts at `folder`, then at the models that ship with the package.
            motion: base motion.
            motions: several of them instead, among which "motion/record" chooses.
            duration: simulated time [s].
            vary: distributions by the names above.
            variants: how many; may be left out of a grid, whose values say it.
            sampling: "sobol", "latin-hypercube", "random"; or "grid": all combinations of Choice(...) and of
                Uniform(..., points=...); or "list": the first values of all of them, then the second, and so on; or
                "sobol-indices": what `sobol_indices` needs, n (factors + 2) variants with n a power of two; a factor is one
                entry of `vary`, or several with the same `group`.
            seed: of the sampling.
            timestep: largest step [s] of all variants; None: chosen once, for the nominal system under the highest levels.
            accuracy: for which it is chosen, as `simulate` does; of no use with a `timestep`.
            sample_rate: as `simulate` takes it [Hz].
            initial: "settled", "relaxed" or "unloaded".
            isolators: isolators in memory by the name that follows `isolator/` in the model.
            changes: what the base system differs by from the model, as `changes` of what `wirerope_mj.varied` returns.
            name: what the study is called.
            question: what it asks.
            folder: where a relative model path starts; None for the current folder.

        Raises:
            ValueError: an argument is out of range.
            ModelError: the model is not what it must be, or a name stands for nothing in it.
        """
        check_arguments(duration=duration, timestep=timestep, accuracy=accuracy, sample_rate=sample_rate)
        if initial not in STARTS:
            raise ValueError(f"`initial` must be one of {', '.join(STARTS)}, got {initial!r}.")
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise ValueError(f"`seed` must be an integer >= 0, got {seed!r}.")
        self.name, self.question, self.vary = name, question, dict(vary)
        self.duration, self.sample_rate, self.initial = float(duration), float(sample_rate), initial
        self.timestep, self.accuracy = None if timestep is None else float(timestep), accuracy
        self.sampling, self.seed = sampling, seed
        self.motions = _motions(motion, motions)
        written = load_system(model_source(model, folder=folder, asker=f"study {name!r}"), isolators=isolators)
        self.base = with_changes(written, changes)
        self.quantities = quantities(self.vary, self.base, self.motions)
        check_centres(self.quantities, self.base)
        if len(self.motions) > 1 and not any(one.name == "motion/record" for one in self.quantities):
            raise ValueError('`motions` holds several base motions, and `vary` has no "motion/record" that chooses.')
        self._inputs = inputs(self.quantities, variants=variants, sampling=sampling, seed=seed)
        self.size = self._inputs.num_rows
        self._maker = Maker(self.base, self.motions, self._columns)

    def table(self) -> pa.Table:
        """Return the inputs of all variants: `variant` and one column for every sampled number.

        Raises:
            ModelError: a variant cannot be: a value is outside a law's valid range, for instance; says which and why.
        """
        return self._checked

    def row(self, variant: int) -> Row:
        """Return the inputs of one variant by column."""
        variant = whole_number(variant)
        if not 0 <= variant < self.size:
            raise ValueError(f"`variant` must be from 0 to {self.size - 1}, got {variant}.")
        return self._inputs.slice(variant, 1).to_pylist()[0]

    def system(self, variant: int) -> System:
        """Return the system of one variant."""
        return self._maker.system(self.row(variant))

    def motion(self, variant: int) -> BaseMotion:
        """Return the base motion of one variant."""
        return self._maker.motion(self.row(variant))

    def response(self, variant: int) -> Response:
        """Return the whole response of one variant; its peaks are those of the study, bit for bit."""
        work = self.work
        return simulate(
            self.system(variant), self.motion(variant), duration=work.duration, timestep=work.timestep,
            initial=work.initial, sample_rate=work.sample_rate, corners=work.corners,
        )  # fmt: skip

    def of(self, rows: pa.Table) -> "Study":
        """Return this study with other variants, to be looked at: `rows` has the columns of its table. Its step stays."""
        work = self.work
        other = copy(self)
        vars(other).pop("_checked", None)
        other._inputs, other.size, other.sampling = rows.select(self._inputs.column_names), rows.num_rows, GIVEN
        vars(other)["work"] = work
        return other

    def run(
        self,
        folder: str | Path,
        *,
        keep: str = "peaks",
        engine: str = "local",
        workers: int | None = None,
        address: str | None = None,
        resume: bool = False,
        force: bool = False,
        progress: bool = False,
    ) -> StudyResult:
        """Compute all variants and return the result, which stands in `folder`.

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
            force: whether a study that stands there is replaced.
            progress: whether a progress bar is shown on standard error.

        Raises:
            ValueError: an argument is out of range.
            ModelError: a variant cannot be; says which and why.
            RecordError: the folder is not that of this study.
            SimulationError: the cluster cannot be reached.
        """
        return run_study(
            self, Path(folder), keep=keep, engine=engine, workers=workers, address=address, resume=resume, force=force,
            progress=progress,
        )  # fmt: skip

    @cached_property
    def work(self) -> Work:
        """What all variants share, the timestep chosen."""
        step = self.timestep
        if step is None:
            step = common_step(
                self.base, self._maker, self._columns, self._checked, initial=self.initial, duration=self.duration,
                sample_rate=self.sample_rate, accuracy=self.accuracy,
            )  # fmt: skip
        return Work(
            system=self.base, motions=self.motions, columns=self._columns, duration=self.duration, timestep=step,
            sample_rate=self.sample_rate, initial=self.initial, corners=joined(*(one.corners for one in self.motions)),
        )  # fmt: skip

    @property
    def _columns(self) -> tuple[Column, ...]:
        return tuple(column for quantity in self.quantities for column in quantity.columns)

    @cached_property
    def _checked(self) -> pa.Table:
        check_variants(self.name, self.base, self.motions, self._columns, self._inputs)
        return self._inputs


def _motions(motion: BaseMotion | None, motions: Sequence[BaseMotion]) -> tuple[BaseMotion, ...]:
    found = (motion,) if motion is not None else tuple(motions)
    if (motion is None) == (len(motions) == 0):
        raise ValueError("either `motion` or `motions` must be given.")
    for one in found:
        if not isinstance(one, BaseMotion):
            raise ValueError(f"`motion` must be a base motion, got {one!r}.")
    return found
