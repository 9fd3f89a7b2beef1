"""Values of a system that are computed once: each system has its own, and they go with it."""

import gc
import weakref

import pytest
from house import sdof

import wirerope_mj as wr
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.system import once_per_system

pytestmark = pytest.mark.quick


def spring_mass():
    return sdof(wr.KelvinVoigt(k=2e4, c=10.0))


def test_a_value_is_computed_once_for_each_system_and_goes_with_it():
    class Figure:
        pass

    asked = []

    @once_per_system
    def figure(system):
        asked.append(id(system))
        return Figure()

    one, other = spring_mass(), spring_mass()
    assert figure(one) is figure(one)
    assert figure(other) is not figure(one)
    assert asked == [id(one), id(other)]
    left = weakref.ref(figure(one))
    del one
    gc.collect()
    assert left() is None


def test_a_variant_has_its_own_stable_step():
    """Four times the mass on the same spring and damper: slower in every mode, so that a longer step is stable."""
    system = spring_mass()
    assert stable_step(wr.varied(system, masses={"mass": 4.0})) > 1.5 * stable_step(system)
