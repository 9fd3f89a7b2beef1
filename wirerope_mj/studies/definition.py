"""The definition of a study: a system and a base motion, what varies of them, and how it is sampled."""

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from functools import cached_property, partial
from pathlib import Path
from typing import Self

import numpy as np
import pyarrow as pa

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation import simulate, simulate_batch
from wirerope_mj.engine.simulation.grid import merge_instants
from wirerope_mj.engine.simulation.simulate import check_arguments
from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import choose_timestep
from wirerope_mj.engine.system import Changes, System, load_system
from wirerope_mj.engine.system.model_files import read_changes
from wirerope_mj.engine.system.named_files import check_inside
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.arguments import integer, one_of
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.budget import require_time
from wirerope_mj.foundation.resources import model_source
from wirerope_mj.motions import BaseMotion
from wirerope_mj.motions.registry import check_records, motion_from_dict
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.studies.vary.distributions import Distribution, distribution_from_dict
from wirerope_mj.studies.vary.mount_quantities import OtherIsolator
from wirerope_mj.studies.vary.quantities import MotionSettings, quantities
from wirerope_mj.studies.vary.quantity import InputColumn
from wirerope_mj.studies.vary.sampling import BLOCK, drawing
from wirerope_mj.studies.vary.variants import Maker, Row, Work, check_variants

STARTS = ("settled", "relaxed", "unloaded")
GIVEN = "given"  # Value of `sampling` of a study whose variants were not sampled, but given


class StudyDefinition:
    """Variants of one system under one base motion, or under several; `Study` computes them."""

    def __init__(
        self, *, model: str | Path, motion: BaseMotion | None = None, motions: Sequence[BaseMotion] = (), duration: float,
        vary: Mapping[str, Distribution], variants: int | None = None, sampling: str = "sobol", seed: int = 1,
        timestep: float | None = None, accuracy: float = 1e-4, sample_rate: float = 1000.0, initial: str = "settled",
        isolators: Mapping[str, Isolator] | None = None, changes: Sequence[Changes] = (), name: str = "study",
        question: str = "", folder: Path | None = None,
    ) -> None:  # fmt: skip
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
            folder: where a relative model path starts; None for that of the study file that makes it, then the current one.

        Raises:
            ValueError: an argument is out of range.
            ModelError: the model is not what it must be, or a name stands for nothing in it.
        """
        check_arguments(duration=duration, timestep=timestep, accuracy=accuracy, sample_rate=sample_rate)
        one_of("initial", initial, STARTS)
        self.name, self.question = name, question
        self.vary = {quantity: OtherIsolator.listed(quantity, distribution) for quantity, distribution in vary.items()}
        self.duration, self.sample_rate, self.initial = float(duration), float(sample_rate), initial
        self.timestep, self.accuracy = None if timestep is None else float(timestep), accuracy
        self.sampling, self.seed = sampling, integer("seed", seed, least=0)
        if (motion is None) == (len(motions) == 0):
            raise ValueError("either `motion` or `motions` must be given.")
        self.motions = (motion,) if motion is not None else tuple(motions)
        for entry in self.motions:
            if not isinstance(entry, BaseMotion):
                raise ValueError(f"`motion` must be a base motion, got {entry!r}.")
        written = load_system(model_source(model, folder=folder, asker=f"study {name!r}"), isolators=isolators)
        self.base = with_changes(written, changes)
        self.quantities = quantities(self.vary, self.base, self.motions)
        if len(self.motions) > 1 and not any(varied.name == "motion/record" for varied in self.quantities):
            raise ValueError('`motions` holds several base motions, and `vary` has no "motion/record" that chooses.')
        self.size, self._draw = drawing(self.quantities, variants=variants, sampling=sampling, seed=seed)
        self.require_time(f"a study of {self.size} variants", self.size, "`variants`")
        self._drawn: tuple[int, pa.Table] | None = None  # the block that was drawn last, by its number
        self._maker = Maker(self.base, self.motions, self._columns)

    def require_time(self, subject: str, runs: float, fewer: str) -> None:
        """Raise BudgetError if so many runs take too long; the message begins with `subject`, the remedy is fewer `fewer`."""
        require_time(
            f"{subject} of {self.duration:.4g} s",
            runs * self.duration * max(self.sample_rate, 1.0 / self.timestep if self.timestep else 0.0),
            f"Compute fewer {fewer}, a shorter `duration`, or use a lower `sample_rate`, at whose samples steps end.",
        )

    @classmethod
    def restored(cls, folder: Path, content: Entries) -> Self:
        """Restore the study from `content`, its `study.toml`, and its folder alone."""
        model = check_inside(folder, content["model"])
        for motion in content["motions"]:
            check_records(motion, folder)
        vary = {row["name"]: {key: value for key, value in row.items() if key != "name"} for row in content["vary"]}
        return cls(
            model=model, changes=read_changes(folder / content["model"]["changes"]) if "changes" in content["model"] else (),
            motions=[motion_from_dict(motion, folder=folder) for motion in content["motions"]],
            vary={name: distribution_from_dict(value) for name, value in vary.items()},
            variants=content["sampling"]["variants"], sampling=content["sampling"]["method"],
            seed=content["sampling"]["seed"], name=content["name"], question=content["question"], **content["simulate"],
        )  # fmt: skip

    def table(self) -> pa.Table:
        """Return the inputs of all variants: `variant` and one column for every sampled number.

        Raises:
            ModelError: a variant cannot be: a value is outside a law's valid range, for instance; says which and why.
        """
        self.check()
        return pa.concat_tables(self._blocks())

    def check(self) -> None:
        """Raise ModelError if a variant cannot be, as `table` does, without all inputs in memory."""
        _ = self._checked

    def rows(self, first: int, count: int) -> pa.Table:
        """Draw the inputs of some variants, as they stand in `table`."""
        blocks = range(first // BLOCK, (first + count - 1) // BLOCK + 1)
        return pa.concat_tables([self._block(number) for number in blocks]).slice(first - blocks.start * BLOCK, count)

    def row(self, variant: int) -> Row:
        """Return the inputs of one variant by column."""
        variant = integer("variant", variant, least=0)
        if variant >= self.size:
            raise ValueError(f"`variant` must be from 0 to {self.size - 1}, got {variant}.")
        return self.rows(variant, 1).to_pylist()[0]

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

    def of(self, rows: pa.Table) -> Self:
        """Return this study with the variants `rows`, which have the columns of its table. Its step stays."""
        work = self.work
        narrowed = copy(self)
        vars(narrowed).pop("_checked", None)
        names = ["variant", *(column.name for column in self._columns)]
        narrowed._draw, narrowed._drawn = rows.select(names).slice, None
        narrowed.size, narrowed.sampling = rows.num_rows, GIVEN
        vars(narrowed)["work"] = work
        return narrowed

    @cached_property
    def work(self) -> Work:
        """Inputs that all variants share, with the timestep chosen."""
        step = self.timestep
        if step is None:  # the smallest of those for the nominal system under the extreme motions
            choose = partial(
                choose_timestep, self.base, duration=self.duration, sample_rate=self.sample_rate, accuracy=self.accuracy
            )
            starts = ((motion, initial_state(self.base, motion, self.initial)) for motion in self._extreme_motions())
            step = min(choose(motion, start).timestep for motion, start in starts)
        return Work(
            system=self.base, motions=self.motions, columns=self._columns, duration=self.duration, timestep=step,
            sample_rate=self.sample_rate, initial=self.initial,
            corners=merge_instants(*(motion.corners for motion in self.motions)),
        )  # fmt: skip

    def _extreme_motions(self) -> Iterator[BaseMotion]:
        """Yield the motion of the highest level of every record; if the direction varies, those farthest along x, y and z."""
        self.check()
        farthest = dict[tuple[int, int], tuple[float, int, Row]]()  # by record and axis: how far, the variant's place, and it
        for place, block in enumerate(self._blocks()):
            settings = MotionSettings.of(self._columns, {name: np.asarray(block[name]) for name in block.column_names})
            size = np.broadcast_to(np.abs(1.0 if settings.level is None else settings.level), block.num_rows)
            reaches = [size]
            if settings.turns:
                a, e = (np.radians(0.0 if angle is None else angle) for angle in (settings.azimuth, settings.elevation))
                axes = (np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e))
                reaches = [size * np.abs(axis) for axis in axes]
            record = np.broadcast_to(settings.record, block.num_rows)
            for number in np.unique(record).tolist():
                rows_of_record = np.flatnonzero(record == number)
                for axis, reach in enumerate(reaches):
                    row = int(rows_of_record[np.argmax(reach[rows_of_record])])
                    if (number, axis) not in farthest or reach[row] > farthest[number, axis][0]:
                        farthest[number, axis] = float(reach[row]), place * BLOCK + row, block.slice(row, 1).to_pylist()[0]
        chosen = {variant: inputs for _, (_, variant, inputs) in sorted(farthest.items())}
        for inputs in chosen.values():
            yield self._maker.motion(inputs)

    def warn_of_given_step(self) -> None:
        """Warn of a given step that is too long for the friction of the nominal system under the extreme motions."""
        if self.timestep is not None:
            simulate_batch(
                self.base, list(self._extreme_motions()), duration=self.duration, timestep=self.timestep,
                initial=self.initial, sample_rate=self.sample_rate,
            )  # fmt: skip

    def _block(self, number: int) -> pa.Table:
        """Draw the inputs of a block of variants, unless it was the last that was drawn."""
        if self._drawn is None or self._drawn[0] != number:
            self._drawn = number, self._draw(number * BLOCK, min(BLOCK, self.size - number * BLOCK))
        return self._drawn[1]

    def _blocks(self) -> Iterator[pa.Table]:
        return map(self._block, range(-(-self.size // BLOCK)))

    @property
    def _columns(self) -> tuple[InputColumn, ...]:
        return tuple(column for quantity in self.quantities for column in quantity.columns)

    @cached_property
    def _checked(self) -> bool:
        check_variants(self.name, self.base, self.motions, self._columns, self._blocks())
        return True
