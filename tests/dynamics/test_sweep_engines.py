"""Cycles of sweeps by the kernel and by MuJoCo: the same extremes, and one that goes on where the other gives up."""

import numpy as np
import pytest
from house import sdof_text
from shaken_mass import MASS, hysteretic, linear, up

import wirerope_mj as wr
from wirerope_mj.dynamics.sweep import cycles
from wirerope_mj.dynamics.sweep.cycles import ByKernel, ByMujoco, at_start, cycle_grid, stepping
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.control import layout as at

pytestmark = pytest.mark.quick

SAME = 1e-9  # of the peaks: rounding alone parts the two, 1e-14 a step, and a sweep of some thousand steps forgets most of it


@pytest.fixture
def mujoco_only(monkeypatch):
    """Return a function after which MuJoCo steps all cycles."""
    return lambda: monkeypatch.setattr(cycles, "unsupported_run", lambda system, motion: "MuJoCo is wanted")


def extremes(system, sweep, *, chunk, timestep):
    """Return extremes of all channels in all cycles, state at the end, numbers of steps, and who was not the kernel and why."""
    instants = sweep.course.whole_cycles()
    start = at_start(system, sweep, wr.equilibrium(system, history="relaxed").state)
    with stepping(system, sweep, start, timestep) as stepped:
        parts = [stepped.run(instants[first : first + chunk + 1]) for first in range(0, instants.size - 1, chunk)]
        final = stepped.finish()
    rows = np.concatenate([np.stack([part.minimum, part.maximum], axis=1) for part in parts])
    n_q = system.model.nq + system.model.nv  # behind the instant: what comes further back is the solver's
    return rows, final.values[: 1 + n_q], (stepped.steps, stepped.largest_step), stepped.why


def apart(system, one, other):
    """Return the largest difference of channels, (n, 2, n_channels, 3), relative to the largest of their kind."""
    subjects, n_mounts = system.assembly.subjects, len(system.mounts)
    kinds = ["acceleration"] * len(subjects.body_names) + ["acceleration", "way"] * len(subjects.point_names)
    kinds = np.array(kinds + ["deflection", "force"] * n_mounts)
    return max(np.abs((one - other)[:, :, kinds == k]).max() / np.abs(one[:, :, kinds == k]).max() for k in set(kinds))


@pytest.mark.parametrize(
    ("system", "sweep", "timestep"),
    [
        pytest.param(hysteretic, up(60.0, 6.0, 18.0), 2e-3, id="one mass"),
        pytest.param(
            lambda: wr.load_system("floating_floor"),
            wr.Sweep(start=9.0, stop=12.0, rate=60.0, velocity=0.1, direction=(1.0, 0.0, 1.0)), 1e-3, id="floor",
        ),
    ],
)  # fmt: skip
def test_kernel_and_mujoco_see_the_same_extremes_in_every_cycle(system, sweep, timestep, mujoco_only):
    system = system()
    rows, final, steps, why = extremes(system, sweep, chunk=3, timestep=timestep)
    assert why == ""
    mujoco_only()
    others, other_final, other_steps, why = extremes(system, sweep, chunk=64, timestep=timestep)
    assert why == "MuJoCo is wanted"
    assert rows.shape[0] >= 4
    assert steps == other_steps
    assert apart(system, rows, others) < SAME
    np.testing.assert_allclose(final, other_final, rtol=0.0, atol=SAME * np.abs(other_final[1:]).max())


STOP = 1.5e-3  # m, which the mass does not reach in the first cycles, but in resonance, where it goes 5 times 0.5 mm


@pytest.mark.parametrize("chunk", [4, 64])
def test_mujoco_goes_on_where_the_kernel_gives_up(chunk, mujoco_only):
    """In the middle of the sweep or from its start; what a joint's limit does is MuJoCo's."""
    text = sdof_text(mass=MASS).replace('name="mass_z"', f'name="mass_z" limited="true" range="-1 {STOP}"')
    system = wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=linear(damping=0.1))})
    sweep = up(60.0, 5.0, 12.0, displacement=5e-4)
    rows, final, steps, why = extremes(system, sweep, chunk=chunk, timestep=1e-3)
    assert why == "a joint came to its limit"
    mujoco_only()
    others, other_final, other_steps, _ = extremes(system, sweep, chunk=chunk, timestep=1e-3)
    assert steps == other_steps
    assert apart(system, rows, others) < SAME
    np.testing.assert_allclose(final, other_final, rtol=0.0, atol=SAME * np.abs(other_final[1:]).max())
    free = wr.load_system(sdof_text(mass=MASS), isolators={"a": wr.Isolator(name="a", axial=linear(damping=0.1))})
    without = extremes(free, sweep, chunk=chunk, timestep=1e-3)[0]
    parted = np.abs(without - others).max(axis=(1, 2, 3)) > 1e-3 * np.abs(others).max()
    assert 4 < np.argmax(parted) < parted.size - 1  # the limit acts, and not before some cycles went well


def test_what_is_handed_over_is_what_mujoco_itself_would_know():
    """Recent vectors and their instants: an extreme in the last half step of a cycle is found from them by the next step."""
    system, sweep = hysteretic(), up(60.0, 6.0, 18.0)
    start = at_start(system, sweep, wr.equilibrium(system, history="relaxed").state)
    grids = [cycle_grid(sweep.course.whole_cycles()[first : first + 4], 1e-3) for first in (0, 3)]
    room = np.empty((2, 3, system.assembly.tables.channels.size, 3))
    kernel, known = ByKernel(system, sweep, start), ByMujoco(system, sweep, start)
    for grid, ends in grids:
        assert kernel.step_cycles(grid, ends, *room)
    taken = kernel.handed_over()
    with installed(known.stepper.model, known.stepper.data):
        known.step_cycles(*grids[0], *room)
    clock = [at.TIME_1, at.TIME_2, at.HISTORY, at.OBSERVING]
    np.testing.assert_allclose(taken.stepper.user[clock], known.stepper.user[clock], rtol=1e-14)
    assert known.stepper.user[at.HISTORY] == 2.0
    rows, expected = (system.assembly.tables.user.channel_rows(one.stepper.user)[:, : at.HIGH + 3] for one in (taken, known))
    recent = slice(at.BEFORE, at.LAST + 3)
    scale = np.abs(expected[:, recent]).max(axis=1, keepdims=True)
    assert np.all(np.abs(rows[:, recent] - expected[:, recent]) <= SAME * scale)
    assert np.count_nonzero(scale) >= 4  # acceleration of mass and base, deflection and force
    for part in (at.LOW, at.HIGH):
        np.testing.assert_array_equal(rows[:, part : part + 3], expected[:, part : part + 3])
