"""All kernels, called once each by short computations, so that they are compiled in advance."""

import shutil
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from signal import SIGTERM, default_int_handler, signal

import numpy as np

from wirerope_mj.dynamics.modes import modes
from wirerope_mj.dynamics.periodic import follow_branch
from wirerope_mj.dynamics.single_mass import equivalent_linear, harmonic_balance
from wirerope_mj.dynamics.sweep import frequency_sweep
from wirerope_mj.engine.control.native import native_callbacks
from wirerope_mj.engine.kernel.equations import equations
from wirerope_mj.engine.kernel.variants import NOTHING, group_of
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.in_lanes import moving_indices
from wirerope_mj.engine.statics.loading import Loading
from wirerope_mj.engine.system import load_system
from wirerope_mj.foundation.kernel_files import LOADED, cache_folder
from wirerope_mj.foundation.kernel_proof import proof_name
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import HalfSine, Sweep
from wirerope_mj.motions.spectra import shock_response_spectrum
from wirerope_mj.mounts.identification.identify import identify
from wirerope_mj.mounts.laws import BoucWen, Law, Stop, Tabulated, VaianaRosati, Zener
from wirerope_mj.mounts.test_rig import steady_loops
from wirerope_mj.mounts.vendor_parts import load_isolator


def use_all_kernels() -> None:
    """Call every kernel that Python calls in computations as brief as possible, which compiles the missing ones."""
    law, plane = _law(), load_isolator("enidine_wr16_400").coupled
    assert plane is not None
    deflection = np.repeat([0.005, 0.01], 800) * np.sin(np.linspace(0.0, 8.0 * np.pi, 1600))
    identify(steady_loops(deflection, law.trace(deflection).force), law=BoucWen)
    plane.trace([[0.0, 0.0], [0.001, 0.001]])
    replace(plane, brackets=(1e6, 1e6)).own_deflection(np.zeros(2), np.zeros(4))
    for axial_law in (law, Zener(k0=2e4, k1=4e4, c=50.0)):
        equivalent_linear(axial_law, mass=100.0, frequencies=[5.0], acceleration=1.0)
        harmonic_balance(axial_law, mass=100.0, frequency=5.0, acceleration=1.0)
    Stop(gap_below=0.005, k=5e5, loss=0.3, reversal=5e-4).pressed(0.01)
    VaianaRosati(kb=0.2, f0=0.4, alpha=2.0).kernel_parameters()
    Tabulated(
        deflection=[0.0, 0.01], force=[0.0, 1000.0], symmetric=True, amplitudes=[0.01], areas=[5.0], yield_deflection=0.001,
    ).kernel_parameters()  # fmt: skip
    system = load_system("sdof_shaker")
    shock = HalfSine(peak=STANDARD_GRAVITY, duration=0.011, direction="z")
    for engine in ("mujoco", "kernel"):
        response = simulate(system, shock, duration=0.02, timestep=1e-3, engine=engine)
    acceleration = response.bodies["mass"].acceleration[:, 2]
    shock_response_spectrum(response.time, acceleration, frequencies=[5.0, 10.0])
    modes(system, amplitude=0.001)
    upwards = Sweep(start=20.0, stop=20.5, rate=10.0, direction="z", acceleration=1.0)
    frequency_sweep(system, upwards, payload="mass", timestep=1e-3)
    with system.assembly.scratch.data(system.model) as data:
        Loading(system, "virgin", data).solve()  # as where the kernel finds no rest
    cabinet = load_system("cabinet")  # of enough unknowns for the variational equation
    follow_branch(cabinet, start=60.0, stop=60.5, acceleration=0.01, direction="z", payload="rack")


def compile_beside_a_command() -> None:
    """Call every kernel, first those that a command calls last, see `wirerope_mj.foundation.processes`."""
    signal(SIGTERM, default_int_handler)  # no half-written file is left behind
    with suppress(KeyboardInterrupt):
        native_callbacks()
        _law().trace([0.0, 0.001])
        # what steps, and all that it calls, without a position of rest to begin at
        system = load_system("sdof_shaker")
        group = group_of([equations(system)], np.zeros((1, moving_indices(system).size)), [0])
        drive = np.zeros((1, 1, len(system.assembly.tables.drive)))
        group.step(np.zeros((5, 0)), drive[:, :0], drive[:, :0], np.zeros((1, 0, 3)), np.zeros(0, dtype=np.int64), NOTHING)
        use_all_kernels()


def _law() -> Law:
    law = load_isolator("enidine_wr16_400").axial
    assert law is not None
    return law


def copy_kernels(folder: Path) -> None:
    """Copy the files of all kernels that Python calls into `folder`; they contain the kernels that these call.

    RuntimeError if one was not at hand, so that this process compiled it with others that are not called from Python.
    """
    before = set(cache_folder().iterdir())
    use_all_kernels()
    if set(cache_folder().iterdir()) != before:
        text = f"kernels were compiled: call `use_all_kernels` in another process first, with {cache_folder()}"
        raise RuntimeError(text)
    folder.mkdir(parents=True, exist_ok=True)
    for path in (*LOADED, cache_folder() / proof_name()):
        shutil.copyfile(path, folder / path.name)


if __name__ == "__main__":
    compile_beside_a_command()
