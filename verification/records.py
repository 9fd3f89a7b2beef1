"""Universal files that pyuff wrote, read back as records.

The library's reader lets pyuff parse a dataset; what is checked is what it makes of that: channels, directions, clocks, units.
"""

import tempfile
import warnings
from pathlib import Path

import numpy as np
import pyuff

import wirerope_mj as wr
from verification.case import Case, Comparison, series

STEP, SAMPLES = 5e-4, 4000
DIRECTIONS = {"x": 1, "y": 2, "z": 3}
UNITS = {"g": wr.STANDARD_GRAVITY, "m/s^2": 1.0, "in/s^2": 0.0254}


def _dataset(values: np.ndarray, *, direction: int, unit: str, binary: int) -> dict[str, object]:
    """Return dataset 58 of an acceleration history at node 12."""
    return dict(
        pyuff.prepare_58(
            binary=binary, id1="a record", func_type=1, rsp_node=12, rsp_dir=direction, ref_node=0, ref_dir=0,
            rsp_ent_name="NONE", ref_ent_name="NONE", ver_num=0, load_case_id=0, ord_data_type=4, num_pts=values.size,
            abscissa_spacing=1, abscissa_min=0.0, abscissa_inc=STEP, abscissa_spec_data_type=17,
            abscissa_axis_units_lab="s", ordinate_spec_data_type=12, ordinate_axis_units_lab=unit,
            orddenom_spec_data_type=0, z_axis_spec_data_type=0, z_axis_value=0.0, data=values,
            x=STEP * np.arange(values.size),
        )
    )  # fmt: skip


def _three_axes(unit: str, *, binary: bool) -> Comparison:
    """Return the comparison of three histories as they were written with the base motion that is read."""
    rng, time = np.random.default_rng(3), STEP * np.arange(SAMPLES)
    written = np.sin(np.pi * time / time[-1])[:, None] ** 2 * rng.normal(size=(SAMPLES, 3))
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # pyuff leaves the closing of its files to Python
        # Noise has no quiet end and drifts: doubts about the record, not about reading it.
        warnings.simplefilter("ignore", wr.RecordWarning)
        path = Path(folder) / "three.uff"
        file = pyuff.UFF(str(path))
        for column, direction in zip(written.T, DIRECTIONS.values(), strict=True):
            file.write_sets([_dataset(column, direction=direction, unit=unit, binary=int(binary))], "add")
        found = wr.load_record(path).acceleration(time[:-1])
    return series(UNITS[unit] * written[:-1], found, "m/s^2")


def _case(unit: str, *, binary: bool, bound: float, reason: str) -> Case:
    """Return the case of a unit and a way to write numbers."""
    form = "binary" if binary else "text"
    return Case(
        name=f"uff-{form}-{unit.split('/')[0]}",
        title=f"Three accelerations in {unit} through a universal file written by pyuff as {form}",
        compares="Base acceleration at 3 x 3,999 instants; largest difference over the largest acceleration.",
        source="pyuff (J. Slavic and others, LADISK), dataset 58; the layout is SDRC's universal file format",
        date="each run",
        bound=bound,
        reason=reason,
        run=lambda: _three_axes(unit, binary=binary),
    )


CASES = (
    _case("g", binary=True, bound=1e-12, reason="64-bit numbers: rounding of the linear pieces between samples"),
    _case(
        "in/s^2",
        binary=False,
        bound=1e-8,
        reason="eleven digits and more of each ordinate are written; the clock has six",
    ),
)
