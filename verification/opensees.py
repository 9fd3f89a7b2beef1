"""OpenSees' BoucWen material and its transients, through openseespy.

OpenSees writes F = a K x + (1 - a) K z with z' = x' {A - |z|^n [gamma + beta sgn(x' z)]}, which is the law here with
k = a K, alpha = (1 - a) K A and beta, gamma times ((1 - a) K)^(1 - n). Its step is backward Euler, of first order in the
increment; two runs with steps of 2 h and h are therefore extrapolated to none, 2 F(h) - F(2 h).
"""

import contextlib
import ctypes
import importlib
import importlib.util
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import wirerope_mj as wr
from verification.case import Case, Comparison, NotRunError, series
from verification.models import chain, path_through

SOURCE = "F. McKenna et al., OpenSees, uniaxialMaterial BoucWen (T. Haukaas, A. Der Kiureghian 2003), run through openseespy"
NEEDS = ("openseespy",)

STIFFNESS, RATIO = 2.0e5, 0.15
"""K [N/m] and a of the material, in the size of an isolator."""


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep what OpenSees writes to standard error out of sight: it greets, and warns of every material."""
    saved = os.dup(2)
    with open(os.devnull, "wb") as null:
        os.dup2(null.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)


def _opensees() -> Any:
    """Return the module; its wheel carries a BLAS that the loader finds only if it is loaded before."""
    with contextlib.suppress(ImportError, AttributeError):
        folder = importlib.util.find_spec("openseespylinux")
        for library in ("libquadmath.so.0", "libgfortran.so.4", "libblas.so.3", "liblapack.so.3"):
            for place in (folder.submodule_search_locations or []) if folder else []:
                with contextlib.suppress(OSError):
                    ctypes.CDLL(str(Path(place) / "lib" / library), mode=ctypes.RTLD_GLOBAL)
    try:
        return importlib.import_module("openseespy.opensees")
    except (ImportError, RuntimeError) as error:
        raise NotRunError(f"openseespy cannot be loaded: {error}") from error


def _law(beta: float, gamma: float, n: float, stiffness: float = STIFFNESS) -> wr.BoucWen:
    """Return the law of a material whose z is a length: beta and gamma in 1/m^n."""
    hysteretic = (1.0 - RATIO) * stiffness
    scale = hysteretic ** (1.0 - n)
    return wr.BoucWen(alpha=hysteretic, beta=beta * scale, gamma=gamma * scale, n=n, k=RATIO * stiffness)


def _material(ops: Any, tag: int, beta: float, gamma: float, n: float, stiffness: float = STIFFNESS) -> None:
    """Define the material; its Newton iteration stops at 1e-14 m of z."""
    ops.uniaxialMaterial("BoucWen", tag, RATIO, stiffness, n, gamma, beta, 1.0, 0.0, 0.0, 0.0, 1e-14, 50)


def _stress(ops: Any, path: np.ndarray, beta: float, gamma: float, n: float) -> np.ndarray:
    """Return the force along a path of strains [N], as the material finds it increment by increment."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    _material(ops, 1, beta, gamma, n)
    ops.testUniaxialMaterial(1)
    force = np.zeros(path.size)
    for i, strain in enumerate(path[1:], start=1):
        ops.setStrain(float(strain))
        force[i] = ops.getStress()
    ops.wipe()
    return force


def _loop(beta: float, gamma: float, n: float) -> Comparison:
    """Return the comparison along 24 turning points of up to 12 mm, at 4,801 of 960,000 increments."""
    ops = _opensees()
    turns = (0.012 * np.random.default_rng(15).uniform(-1.0, 1.0, 24)).tolist()
    kept, fine = 200, 40_000
    with _quiet():
        force = _stress(ops, path_through(turns, fine), beta, gamma, n)[:: fine // kept]
        coarse = _stress(ops, path_through(turns, fine // 2), beta, gamma, n)[:: fine // 2 // kept]
    ours = _law(beta, gamma, n).trace(path_through(turns, kept)).force
    return series(2.0 * force - coarse, ours, "N")


RECORD_STEP, RECORD_LENGTH = 0.004, 3.0


def _record() -> np.ndarray:
    """Return a base acceleration [m/s^2] every 4 ms: a burst of twelve sines with random phases that grows and dies."""
    time = np.arange(0.0, RECORD_LENGTH + RECORD_STEP / 2, RECORD_STEP)
    rng = np.random.default_rng(1940)
    frequencies, phases = np.linspace(1.0, 14.0, 12), rng.uniform(0.0, 2.0 * np.pi, 12)
    burst = np.sin(2.0 * np.pi * np.outer(time, frequencies) + phases).sum(axis=1)
    return 1.5 * burst * np.sin(np.pi * time / RECORD_LENGTH) ** 2


Parameters = tuple[float, float, float, float]
"""beta, gamma, n and K of one spring."""


def _newmark(ops: Any, springs: Sequence[Parameters], masses: Sequence[float], parts: int, record: np.ndarray) -> np.ndarray:
    """Return the deflections of the springs at the record's instants [m], by Newmark's method with `parts` steps in each."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(0, 0.0)
    ops.fix(0, 1)
    for i, (spring, mass) in enumerate(zip(springs, masses, strict=True), start=1):
        ops.node(i, 0.0)
        ops.mass(i, mass)
        _material(ops, i, *spring)
        ops.element("zeroLength", i, i - 1, i, "-mat", i, "-dir", 1)
    ops.timeSeries("Path", 1, "-dt", RECORD_STEP, "-values", *record.tolist())
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    for name, *more in (("constraints", "Plain"), ("numberer", "Plain"), ("system", "FullGeneral")):
        getattr(ops, name)(*more)
    ops.test("NormDispIncr", 1e-13, 50, 0)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    history = np.zeros((record.size, len(masses)))
    for row in range(1, record.size):
        if ops.analyze(parts, RECORD_STEP / parts) != 0:
            raise RuntimeError(f"OpenSees did not converge in step {row}.")
        history[row] = [ops.nodeDisp(i, 1) for i in range(1, len(masses) + 1)]
    ops.wipe()
    return np.diff(history, axis=1, prepend=0.0)


def _transient(springs: Sequence[Parameters], masses: Sequence[float]) -> Comparison:
    """Return the comparison of all deflections of a chain under the record."""
    ops, record = _opensees(), _record()
    with _quiet():
        fine, coarse = (_newmark(ops, springs, masses, parts, record) for parts in (240, 120))
    system = chain([_law(*spring) for spring in springs], masses)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "burst.csv"
        time = RECORD_STEP * np.arange(record.size)
        np.savetxt(path, np.column_stack([time, record]), "%.17g", ",", header="time [s], z [m/s^2]", comments="")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", wr.RecordWarning)  # the base drifts away, here as in OpenSees
            motion = wr.load_record(path)
        response = wr.simulate(
            system, motion, duration=float(time[-1]), initial="unloaded", timestep=1e-4, sample_rate=1.0 / RECORD_STEP
        )
    ours = np.column_stack([response.mounts[f"m{i + 1}"].deflection[:, 2] for i in range(len(masses))])
    return series(2.0 * fine - coarse, ours, "m")


def _case(name: str, title: str, compares: str, bound: float, reason: str, run: Callable[[], Comparison]) -> Case:
    """Return a case of this file."""
    return Case(
        name=name, title=title, compares=compares, source=SOURCE, date="each run", bound=bound, reason=reason, run=run,
        needs=NEEDS,
    )  # fmt: skip


ALONG = "Force along one path with 24 random turning points of up to 12 mm; largest difference over the largest force."
PATH_REASON = (
    "what the extrapolation leaves of OpenSees' first-order increments (3e-7 m each): it falls with their square away from the "
    "reversals and linearly at them"
)
HISTORY_REASON = (
    "what the extrapolation leaves of OpenSees' steps of 17 microseconds, whose reversals fall inside steps: one from twice as "
    "long steps differs by 7e-7"
)

CASES = (
    _case("opensees-loop-softening", "Loops of a softening law", ALONG, 1e-7, PATH_REASON, lambda: _loop(320.0, 80.0, 1.0)),
    _case("opensees-loop-sharp", "Loops of a sharper law, n = 2", ALONG, 1e-7, PATH_REASON, lambda: _loop(9.0e4, 4.0e4, 2.0)),
    _case("opensees-loop-hardening", "Loops of a hardening law, beta + gamma < 0", ALONG, 1e-7, PATH_REASON,
          lambda: _loop(60.0, -100.0, 1.0)),
    _case("opensees-transient", "One mass on a Bouc-Wen mount under a burst",
          "Deflection at 751 instants of a burst of twelve sines; largest difference over the largest deflection.",
          1e-6, HISTORY_REASON, lambda: _transient([(320.0, 80.0, 1.0, STIFFNESS)], [150.0])),
    _case("opensees-chain", "Two masses on two Bouc-Wen mounts above each other, under the same burst",
          "Deflections of both mounts at 751 instants; largest difference over the largest deflection.",
          1e-6, HISTORY_REASON,
          lambda: _transient([(320.0, 80.0, 1.0, STIFFNESS), (9.0e4, 4.0e4, 2.0, 1.2e5)], [150.0, 40.0])),
)  # fmt: skip
