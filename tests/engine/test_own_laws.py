"""Laws that a program brings along act as the package's own, and wrong ones are refused in one message."""

from dataclasses import dataclass

import numba
import numpy as np
import pytest
from house import sdof

import wirerope_mj as wr
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import monodromy, shot

VALUES = {"alpha": 2e5, "beta": 300.0, "gamma": 100.0, "n": 1.0, "k1": 8e4, "k2": 1e5, "k3": 2e7, "b": 2.0, "c": 10.0}
SAME = 1e-9  # of the largest value: a static path is integrated to 1e-9 a step where the package has a closed form


@dataclass(frozen=True, kw_only=True)
class Ni(wr.OwnLaw):
    """Ni's law as a program would write it."""

    name = "ni"
    state_names = ("z",)
    alpha: float
    beta: float
    gamma: float
    n: float
    k1: float
    k2: float
    k3: float
    b: float
    c: float

    @staticmethod
    @numba.njit
    def force(p, x, v, z, zdot):
        alpha, beta, gamma, n, k1, k2, k3, b, c = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8]
        zdot[0] = (alpha - (gamma + beta * np.sign(v * z[0])) * abs(z[0]) ** n) * v
        return b ** (c * x) * (z[0] + x * (k1 + k2 * abs(x) + k3 * x * x))


@dataclass(frozen=True, kw_only=True)
class Interpreted(Ni):
    """The same, not compiled."""

    force = staticmethod(Ni.force.py_func)


def mounted(model, law):
    """Return a shipped model whose isolators have one law on all axes; bump stops stay."""
    shipped = wr.load_system(model)
    ropes = [name for name, isolator in shipped.isolators.items() if not isolator.is_stop]
    device = wr.Isolator(name="rope", roll=law, shear=law, axial=law)
    return wr.load_system(model, isolators=dict.fromkeys(ropes, device))


def shaken(system, *, duration=0.06, timestep=2.5e-4, **options):
    """Return the response to a shock on three axes, by MuJoCo's steps."""
    direction = (0.5, 0.4, 1.0) if len(system.assembly.driven_dofs) == 3 else "z"
    shock = wr.HalfSine(peak=100.0, duration=0.011, direction=direction, start=0.005)
    return wr.simulate(system, shock, duration=duration, timestep=timestep, engine="mujoco", **options)


def apart(one, other):
    """Return the largest difference relative to the largest value."""
    return float(np.abs(one - other).max() / np.abs(one).max())


@pytest.mark.parametrize("model", ["floating_floor", "cabinet"])
def test_own_law_is_the_built_in_one_in_statics_and_shock(model):
    built_in, own = mounted(model, wr.AsymmetricBoucWen(**VALUES)), mounted(model, Ni(**VALUES))
    rests = [wr.equilibrium(system) for system in (built_in, own)]
    ropes = [name for name, mount in built_in.mounts.items() if not mount.isolator.is_stop]
    for mount in ropes:
        one, other = (rest.mounts[mount] for rest in rests)
        assert apart(one.deflection, other.deflection) < SAME
        assert apart(one.force, other.force) < SAME
    runs = [shaken(system) for system in (built_in, own)]
    for mount in ropes:
        one, other = (run.mounts[mount] for run in runs)
        assert apart(one.deflection, other.deflection) < SAME
        assert apart(one.force, other.force) < SAME
        assert apart(one.hysteretic_state, other.hysteretic_state) < SAME


def test_law_in_the_interpreter_is_the_compiled_one():
    runs = [shaken(mounted("sdof_shaker", law), duration=0.02) for law in (Ni(**VALUES), Interpreted(**VALUES))]
    np.testing.assert_array_equal(runs[0].mounts["m1"].force, runs[1].mounts["m1"].force)


def test_both_callbacks_call_it():
    system = mounted("sdof_shaker", Ni(**VALUES))
    native, python = (shaken(system, duration=0.02, callback=kind) for kind in ("native", "python"))
    assert apart(native.mounts["m1"].force, python.mounts["m1"].force) < 1e-12  # rounding of another order of sums


def test_kernel_leaves_it_to_mujoco_and_says_so():
    system = mounted("sdof_shaker", Ni(**VALUES))
    run = wr.simulate(system, wr.HalfSine(peak=50.0, duration=0.011, direction="z"), duration=0.02)
    assert run.numerics.engine == "mujoco"
    assert "laws that a program brings along" in run.numerics.why


def test_beside_a_damper_in_parallel():
    damper = wr.KelvinVoigt(k=0.0, c=300.0)
    pairs = [wr.Parallel(laws=[law, damper]) for law in (wr.AsymmetricBoucWen(**VALUES), Ni(**VALUES))]
    one, other = (shaken(mounted("sdof_shaker", pair), duration=0.02) for pair in pairs)
    assert apart(one.mounts["m1"].force, other.mounts["m1"].force) < SAME


def test_cyclic_test_and_modes():
    laws = wr.AsymmetricBoucWen(**VALUES), Ni(**VALUES)
    loops = [wr.cyclic_test(law, [1e-3, 5e-3])[-1] for law in laws]
    assert loops[1].dissipated_energy == pytest.approx(loops[0].dissipated_energy, rel=SAME)
    frequencies = [wr.modes(mounted("sdof_shaker", law)).frequencies for law in laws]
    np.testing.assert_allclose(frequencies[1], frequencies[0], rtol=1e-6)  # tangents are differences


# ------------------------------------------------------------------------------------------------------- wrong laws


def wrong(force, **attributes):
    """Return a law with a force function and class attributes."""
    body = {"__annotations__": {"k": float}, "name": "wrong", "state_names": ("z",), "force": staticmethod(force)}
    kind = type("Wrong", (wr.OwnLaw,), body | attributes)
    return lambda: dataclass(frozen=True, kw_only=True)(kind)(k=1e5)


def right(p, x, v, z, zdot):
    """Return the force of a law that is right."""
    zdot[0] = 1e5 * v - 300.0 * abs(v) * z[0]
    return p[0] * x + z[0]


def too_few(p, x, v, z):
    return p[0] * x


def shape(p, x, v, z, zdot):
    zdot[0] = v
    return np.array([p[0] * x, 0.0])


def nan(p, x, v, z, zdot):
    zdot[0] = v
    return p[0] * x + np.sqrt(-1.0 - x * x) if x else 0.0


def no_rates(p, x, v, z, zdot):
    return p[0] * x


def beyond(p, x, v, z, zdot):
    zdot[0] = zdot[1] = v
    return p[0] * x


def source(p, x, v, z, zdot):
    zdot[0] = 1e5 * v + 300.0 * abs(v) * z[0]
    return p[0] * x + z[0]


def creeping(p, x, v, z, zdot):
    zdot[0] = 1e5 * v - 10.0
    return p[0] * x + z[0]


def viscous(p, x, v, z, zdot):
    zdot[0] = 1e5 * v
    return p[0] * x + z[0] + 5.0 * v


def preloaded(p, x, v, z, zdot):
    zdot[0] = 1e5 * v - 300.0 * abs(v) * z[0]
    return p[0] * x + z[0] + 7.0


def soft(p, x, v, z, zdot):
    zdot[0] = 0.0 * v
    return -p[0] * x


calls = []


def remembering(p, x, v, z, zdot):
    calls.append(x)
    zdot[0] = v
    return p[0] * x + float(len(calls)) if x else 0.0


def exploding(p, x, v, z, zdot):
    zdot[0] = 1e5 * v * (1.0 + (z[0] / 50.0) ** 2)
    return p[0] * x + z[0]


WRONG = {
    r"failed at x = 0 m, .*: TypeError: .*4 positional arguments": wrong(too_few),
    r"`force` must return one finite number, got array": wrong(shape),
    r"`force` must return one finite number, got .*nan.* at x = 0\.01 m": wrong(nan),
    r"`force` must write 1 finite rates to `zdot`, got \[nan\]": wrong(no_rates),
    r"failed .*: IndexError: index 1 is out of bounds": wrong(beyond),
    r"a closed cycle of 0\.0001 m must not generate energy, got .* J": wrong(source),
    r"`zdot` must be proportional to it": wrong(creeping),
    r"`force` must not depend on the rate v": wrong(viscous),
    r"the force of the unloaded mount must be 0, got 7 N": wrong(preloaded),
    r"the tangent of the unloaded mount must be > 0, got -100000 N/m": wrong(soft),
    r"`force` must depend on its arguments alone": wrong(remembering),
    r"the force must be finite up to `travel` = 0\.01 m, got none at": wrong(exploding),
    r"`state_names` must name at least one state": wrong(right, state_names=()),
}


@pytest.mark.filterwarnings("ignore:invalid value encountered in sqrt")
@pytest.mark.parametrize(("message", "make"), WRONG.items(), ids=range(len(WRONG)))
def test_wrong_law_is_refused_in_one_message(message, make):
    with pytest.raises(ValueError, match=rf"^law 'wrong': .*{message}") as caught:
        make()
    assert "\n" not in str(caught.value)


def test_right_law_is_taken():
    assert wrong(right)().initial_stiffness == pytest.approx(2e5, rel=1e-6)


def test_files_do_not_hold_it(tmp_path):
    with pytest.raises(ValueError, match=r"law 'ni' is a program's own and is not written to a file"):
        wr.Isolator(name="rope", axial=Ni(**VALUES)).save(tmp_path / "rope.toml")


def test_scaled_needs_powers_of_force():
    with pytest.raises(ValueError, match=r"`force_powers` must state"):
        Ni(**VALUES).scaled(2.0)


@dataclass(frozen=True, kw_only=True)
class Normalised(wr.OwnLaw):
    """Bouc-Wen's law of n = 2 and gamma = 0, its state w a ratio to the bound [N]."""

    name = "normalised"
    state_names = ("w",)
    bound: float
    over: float

    @staticmethod
    @numba.njit
    def force(p, x, v, z, zdot):
        zdot[0] = (v - abs(v) * z[0] * abs(z[0])) / p[1]
        return p[0] * z[0]


def test_a_state_that_is_no_force_has_differences_in_its_own_unit():
    """Beside 300 kN of friction a step of 1e-5 of these forces was three times what the state of the other law is at most."""
    bound, over, found = 3e3, 0.1, []
    friction = wr.BoucWen(alpha=3e8, beta=1e3, gamma=0.0, n=1.0, k=2e6)
    force = wr.BoucWen(alpha=bound / over, beta=1.0 / (bound * over), gamma=0.0, n=2.0)
    for law in (force, Normalised(bound=bound, over=over)):
        search = OrbitSearch(sdof(wr.Parallel(laws=(friction, law)), mass=1e4), direction="z", history="relaxed", accuracy=1e-4)
        with search.flow.ready():
            drive = search.drive(5.0, 40.0)
            motion = shot(search.flow, search.settled(search.coordinates.rest(), drive, 5), drive)
            found.append(np.linalg.eigvals(monodromy(search.flow, motion)))
    assert 0.1 < np.abs(found[0]).max() < 0.9
    # of both states the steps are 1e-3 of their bounds, or less: by so much differences may differ
    np.testing.assert_allclose(np.sort_complex(found[1]), np.sort_complex(found[0]), rtol=0, atol=1e-3)
