"""The registry of laws: every law stands there, with a number of its own, and is computed by its own kernel."""

from dataclasses import dataclass
from enum import IntEnum, unique

import numpy as np
import pytest

import wirerope_mj.mounts.laws as laws
from wirerope_mj.mounts.laws.law import Law
from wirerope_mj.mounts.laws.registry import LAWS, REGISTERED, Kernel, evaluate, evaluate_single

COMPOSED = {"parallel", "smoothed", "on-bracket", "own"}  # made of other laws or of a program's own function


def classes(kind=Law):
    return {kind}.union(*map(classes, kind.__subclasses__()))


def test_every_law_of_the_package_is_registered():
    written = {law for law in classes() if law.__module__.startswith(laws.__name__) and "name" in vars(law)}
    assert {law.name for law in written} - COMPOSED == set(LAWS)
    assert len(LAWS) == len(REGISTERED)


def test_a_number_is_that_of_one_kernel():
    numbers = {}
    for law, kernel in REGISTERED:
        assert Kernel(law.kernel).name == kernel.__name__.upper()
        numbers.setdefault(kernel, set()).add(law.kernel)
    assert all(len(own) == 1 for own in numbers.values())
    assert len(Kernel) == len({int(number) for number in Kernel})


def test_a_number_that_is_taken_is_refused_by_name():
    taken = {number.name: number.value for number in Kernel} | {"NEW": Kernel.ON_BRACKETS.value}
    with pytest.raises(ValueError, match="NEW -> ON_BRACKETS"):
        unique(IntEnum("Kernel", taken))


@pytest.mark.parametrize(("law", "kernel"), REGISTERED, ids=lambda value: getattr(value, "name", ""))
def test_a_law_is_computed_by_its_own_kernel(law, kernel):
    example = law(**law.example)
    p, n = example.kernel_parameters(), max(example.n_states, 1)
    states = np.linspace(0.3, 0.6, n)
    for choice in (evaluate, evaluate_single):
        rates, own = np.full((2, n), np.nan)
        force = choice(law.kernel, p, 0, 6e-3, 0.2, states, 0, rates, 0)
        assert force == kernel(p, 0, 6e-3, 0.2, states, 0, own, 0) != 0.0
        np.testing.assert_array_equal(rates, own)


def test_no_force_is_made_up_for_a_number_without_a_kernel():
    for number in (max(Kernel) + 1, Kernel.BIAXIAL, Kernel.LOOP, Kernel.ON_BRACKETS):
        assert np.isnan(evaluate(int(number), np.ones(40), 0, 1e-3, 0.1, np.zeros(4), 0, np.zeros(4), 0))


@pytest.mark.parametrize("law", LAWS.values(), ids=lambda law: law.name)
def test_a_law_answers_every_question(law):
    example = law(**law.example)
    assert example.faint().n_states == example.n_states
    assert (
        example.faint().initial_stiffness <= 1e-8
    )  # exponential springs of 1e-12 N grow by 1e3 over a metre; ropes have 1e4 N/m
    assert example.same_structure(law(**law.example))
    assert not example.same_structure(None)
    assert example.unchecked({}) == example
    assert example.behind_bracket is example
    assert (example.normal_form is None) or example.normal_form.z_max == pytest.approx(example.z_max)  # a power and its root


@dataclass(frozen=True, kw_only=True)
class Friction(laws.OwnLaw):
    name = "friction"
    state_names = ("z",)
    alpha: float
    beta: float

    @staticmethod
    def force(p, x, v, z, zdot):
        zdot[0] = p[0] * v - p[1] * abs(v) * z[0]
        return z[0]


def test_a_law_of_a_program_can_fail_without_stating_its_powers_of_force():
    friction = Friction(alpha=1e5, beta=200.0)
    assert friction.faint().n_states == 1
    assert friction.faint().initial_stiffness <= 1e-8  # as above
    assert friction.same_structure(Friction(alpha=1e5, beta=200.0))
    assert not friction.same_structure(Friction(alpha=2e5, beta=200.0))
