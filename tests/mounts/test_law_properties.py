"""What every law keeps on every path: rate, symmetry, bounds, energy, finite numbers, and one answer however it is asked."""

import json
import math
import os
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from examples_drawn import examples
from hypothesis import given
from hypothesis import strategies as st
from laws_for_tests import (
    MIRRORED,
    PARAMETERS,
    SLOWED,
    STRATEGIES,
    example,
    passive,
    path_through,
    smooth_path,
    turning_points,
)

from wirerope_mj.mounts.laws import LAWS
from wirerope_mj.mounts.laws.registry import BOUC_WEN_LAWS, has_closed_form

NAMES = sorted(LAWS)
FRESH_INTERPRETER = 120  # seconds for one that runs the kernels as plain Python on a busy machine
every_law = pytest.mark.parametrize("name", NAMES)
few = examples(25)


def test_every_law_is_tested():
    assert set(STRATEGIES) == set(PARAMETERS) == set(LAWS)
    assert {name for name in NAMES if not example(name).rate_independent} == set(SLOWED)
    for name in NAMES:
        assert example(name).name == name


def size(law, force):
    """Return what errors of a force are measured by: its own largest value, at least one thousandth of a unit.

    Near zero a table's force is what cancels of cubics from the knot before it, of the size of the table and of z_max; that of
    Vaiana and Rosati's law is what cancels of its limit curves.
    """
    parts = [*law.upper, *law.lower, *law.force, law.z_max] if law.name == "tabulated" else []
    parts += [law.f0, law.f0_minus, 2.0 * law.g1, 2.0 * law.g1_minus] if law.name == "vaiana-rosati" else []
    return float(np.abs([*force, *parts, 1e-3]).max())


@every_law
@given(data=st.data(), points=turning_points, slower=st.floats(0.01, 100.0))
@few
def test_the_rate_matters_as_stated(name, data, points, slower):
    law = data.draw(STRATEGIES[name])
    x, time, rate = smooth_path(points, per_segment=8)
    loop = law.trace(x, time=time, rate=rate)
    if law.rate_independent:
        other = law.trace(x, time=slower * np.cumsum(1.0 + np.sin(time) ** 2))
        np.testing.assert_array_equal(other.force, loop.force)
        np.testing.assert_array_equal(law.trace(x).work, loop.work)
        return
    same = SLOWED[name](law, slower).trace(x, time=slower * time, rate=rate / slower)
    # Powers and quotients of the scale: some hundred roundings, and the adaptive steps' 1e-11.
    np.testing.assert_allclose(same.force, loop.force, rtol=0, atol=1e-9 * size(law, loop.force))
    with pytest.raises(ValueError, match="`time` must be given"):
        law.trace(x)


@every_law
@given(data=st.data(), points=turning_points)
@few
def test_mirrored_path_gives_the_mirrored_force(name, data, points):
    law = data.draw(STRATEGIES[name])
    other = MIRRORED[name](law) if name in MIRRORED else law
    x, time, rate = smooth_path(points, per_segment=8)
    loop, mirrored = law.trace(x, time=time, rate=rate), other.trace(-x, time=time, rate=-rate)
    # exp(-y) and 1 / exp(y) differ by rounding, as do sums in another order.
    np.testing.assert_allclose(mirrored.force, -loop.force, rtol=0, atol=1e-11 * size(law, loop.force))
    np.testing.assert_allclose(mirrored.work, loop.work, rtol=0, atol=1e-11 * size(law, loop.work))


@every_law
@given(data=st.data(), points=turning_points)
@few
def test_hysteretic_force_stays_within_its_bound(name, data, points):
    law = data.draw(STRATEGIES[name])
    bound = getattr(law, "z_max", math.inf)
    x, time, rate = smooth_path(points, per_segment=8)
    loop = law.trace(x, time=time, rate=rate)
    if name == "masing":
        for states, slip in zip(loop.internal_states.T, law.slip_force, strict=True):
            assert np.abs(states).max() <= slip
    if bound < math.inf:
        # The bound is approached as close as rounding, and once by 1e-11 of an adaptive step.
        assert np.abs(loop.hysteretic_state).max() <= bound * (1.0 + 1e-9)


@every_law
@given(data=st.data(), points=turning_points)
@examples(60)
def test_no_path_from_the_unloaded_state_gains_work(name, data, points):
    law = data.draw(STRATEGIES[name].filter(passive))
    x, time, rate = smooth_path(points, per_segment=12)
    work = law.trace(x, time=time, rate=rate).work
    # What is below zero by more than the integration's error would be made from nothing.
    assert work.min() >= -1e-9 * max(1.0, np.abs(work).max())


@every_law
@given(
    data=st.data(),
    points=st.lists(
        st.one_of(st.floats(-1e3, 1e3), st.sampled_from([0.0, 1e-300, -1e-300, 1.0, 1.0, -1e-12])),
        min_size=1,
        max_size=8,
    ),
)
@few
def test_a_finite_path_gives_finite_numbers_or_is_refused(name, data, points):
    law = data.draw(STRATEGIES[name])
    path = np.array([0.0, *points])
    try:
        loop = law.trace(path, time=np.arange(path.size))
    except ValueError as error:
        # Exponentials of a thousand units leave the numbers; that is said, with the deflection.
        assert "deflection of" in str(error)  # noqa: PT017
        assert np.abs(path).max() > 3.0
        return
    for values in (loop.force, loop.hysteretic_state, loop.work, loop.internal_states):
        assert np.isfinite(values).all()


@every_law
@given(data=st.data(), points=turning_points)
@few
def test_a_path_step_by_step_is_the_path_at_once(name, data, points):
    law = data.draw(STRATEGIES[name])
    x, time, rate = smooth_path(points, per_segment=5)
    loop = law.trace(x, time=time, rate=rate)
    states, work = np.zeros(law.n_states), 0.0
    for i in range(x.size - 1):
        two = slice(i, i + 2)
        step = law.trace(x[two], time=time[two], rate=rate[two], initial_states=states)
        states, work = step.internal_states[-1], work + step.work[-1]
        # The same operations on the same numbers.
        assert step.force[-1] == loop.force[i + 1]
    np.testing.assert_array_equal(states, loop.internal_states[-1])
    assert work == pytest.approx(loop.work[-1], rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("name", [name for name in NAMES if example(name).rate_independent])
@given(data=st.data(), points=turning_points)
@few
def test_path_does_not_depend_on_how_finely_it_is_sampled(name, data, points):
    law = data.draw(STRATEGIES[name])
    fine, coarse = law.trace(path_through(points, per_segment=7)), law.trace([0.0, *points])
    integrated = law.kernel not in BOUC_WEN_LAWS and not has_closed_form(law.kernel, law.kernel_parameters(), 0)
    # Closed forms and series differ by rounding, and their work by the 3e-10 of four points; adaptive steps by 1e-11 each.
    tolerance = 1e-8 if integrated else 1e-12
    np.testing.assert_allclose(fine.force[::7], coarse.force, rtol=0, atol=tolerance * size(law, coarse.force))
    np.testing.assert_allclose(fine.work[::7], coarse.work, rtol=0, atol=max(tolerance, 1e-9) * size(law, coarse.work))


PLAIN = """
import json, sys
import numpy as np
sys.path.insert(0, sys.argv[1])
from laws_for_tests import example, smooth_path
from wirerope_mj.mounts.laws import LAWS, registry
assert not hasattr(registry.evaluate, "py_func")
x, time, rate = smooth_path([1.0, -0.7, 0.9, -1.0], per_segment=6)
loops = {}
for name in LAWS:
    loop = example(name).trace(0.01 * x, time=0.01 * time, rate=rate)
    loops[name] = [loop.force.tolist(), loop.work.tolist(), loop.hysteretic_state.tolist()]
print(json.dumps(loops))
"""


@pytest.mark.slow
def test_compiled_traces_are_those_of_plain_python():
    folder = str(Path(__file__).parents[1])
    run = subprocess.run(
        [sys.executable, "-c", PLAIN, folder],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True, text=True, timeout=FRESH_INTERPRETER, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    plain = json.loads(run.stdout)
    assert set(plain) == set(LAWS)
    x, time, rate = smooth_path([1.0, -0.7, 0.9, -1.0], per_segment=6)
    for name, (force, work, z) in plain.items():
        loop = example(name).trace(0.01 * x, time=0.01 * time, rate=rate)
        # pow(), exp() and tanh() of the compiler's library may differ in the last digit, and adaptive steps then by 1e-11.
        for values, expected in ((loop.force, force), (loop.work, work), (loop.hysteretic_state, z)):
            np.testing.assert_allclose(values, expected, rtol=0, atol=1e-10 * max(np.abs(expected).max(), 1e-3))


@every_law
def test_a_law_is_written_and_read_by_its_parameters(name):
    law = example(name)
    content = law.to_dict()
    assert content.pop("law") == name
    assert LAWS[name](**json.loads(json.dumps(content))) == law
    assert asdict(LAWS[name](**content)) == asdict(law)
