"""A system as a functional mock-up unit: FMI 3, co-simulation."""

import re
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

import tomli_w

from wirerope_mj.engine.simulation.simulate import checked_step
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.model_files import write_model
from wirerope_mj.foundation.atomic_files import atomic_file, check_writable, place_named
from wirerope_mj.foundation.errors import RecordError

# Quantities that a unit gives out unless it is asked for all.
OUTPUTS = ("position", "acceleration", "relative_displacement", "deflection", "force")
SAFE = 0.1  # Of the largest stable step, which a unit takes where none is given


def write_fmu(
    system: System, path: str | Path, *, timestep: float | None = None, initial: str = "settled", every: bool = False,
    force: bool = False,
) -> Path:  # fmt: skip
    """Write a system as a co-simulation unit of FMI 3, a file that ends in .fmu, and return its path.

    The unit holds the model and runs in a Python that has this package. Its inputs are the base's acceleration, in the
    world frame, and force and moment at every site `force/NAME`, along the site's axes; they are held from one instant to
    the next. Its outputs are what a response samples of bodies, points and mounts, with `every` rates, orientations and
    internal states, too. It begins `initial`: "settled", "relaxed" or "unloaded". `timestep` is the largest between two
    instants [s]; None: a tenth of the largest stable one.

    RecordError if a file stands there that `force` does not replace, its folder does not, or the package pythonfmu3 is
    missing; SimulationError if the step is too large.
    """
    target = Path(path)
    if target.suffix != ".fmu":
        raise RecordError(f"{target}: a functional mock-up unit is a file that ends in .fmu.")
    check_writable(target, force=force)
    try:
        from pythonfmu3.builder import FmuBuilder
    except ModuleNotFoundError:
        raise RecordError("The package pythonfmu3 is missing: install wirerope-mj with its extra `fmu`.") from None
    step = SAFE * stable_step(system) if timestep is None else checked_step(system, timestep, 1.0)
    identifier = re.sub(r"\W", "_", system.path.stem if system.path else "system", flags=re.ASCII)
    with place_named(target), TemporaryDirectory() as scratch:
        here = Path(scratch)
        model = write_model(system, here / "model")
        about = {
            "identifier": f"m_{identifier}" if identifier[:1].isdigit() else identifier,
            "description": f"{identifier} on {len(system.mounts)} mounts, base acceleration and loads held between instants",
            "model": model.name, "timestep": float(step), "initial": initial, "outputs": "all" if every else list(OUTPUTS),
        }  # fmt: skip
        (here / "unit.toml").write_text(tomli_w.dumps(about), encoding="utf-8")
        script = Path(__file__).with_name("fmu_slave.py")
        abilities = ("canHandleVariableCommunicationStepSize", "canGetAndSetFMUState", "canSerializeFMUState")
        built = FmuBuilder.build_FMU(
            script, here / "out", [here / "model", here / "unit.toml"], **dict.fromkeys(abilities, True)
        )
        with atomic_file(target) as temporary:
            shutil.copyfile(built, temporary)
    return target
