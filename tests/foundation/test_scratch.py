"""Data that are lent: as new each time, to several at once, and never after an error."""

import copy
import pickle

import mujoco
import numpy as np
import pytest
from house import sdof_text

import wirerope_mj as wr
from wirerope_mj.engine.system.assembly import Scratch

STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@pytest.fixture(scope="module")
def system():
    law = wr.BoucWen(alpha=2e4, beta=30.0, gamma=10.0, n=1.0, k=5e3)
    return wr.load_system(sdof_text(), isolators={"a": wr.Isolator(name="a", axial=law)})


def state(model, data):
    values = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, values, STATE)
    return values


def test_what_is_lent_again_is_as_new(system):
    scratch, model = Scratch(), system.model
    with scratch.data(model) as data:
        data.qpos[:], data.qvel[:], data.userdata[:], data.time = 0.3, 2.0, 7.0, 5.0
        mujoco.mj_forward(model, data)
        with scratch.data(model) as other:
            assert other is not data
    with scratch.data(model) as again:
        assert again is data or again is other
        np.testing.assert_array_equal(state(model, again), state(model, mujoco.MjData(model)))


def test_what_was_lent_when_an_error_came_is_not_lent_again(system):
    scratch = Scratch()
    with pytest.raises(RuntimeError), scratch.data(system.model) as data:
        raise RuntimeError
    with scratch.data(system.model) as other:
        assert other is not data


def test_variants_share_what_is_lent_and_a_copy_in_another_process_has_its_own(system):
    variant = wr.varied(system, masses={"mass": 1.1})
    assert variant.assembly.scratch is system.assembly.scratch
    for elsewhere in (pickle.loads(pickle.dumps(variant)), copy.deepcopy(variant.assembly.scratch)):
        own = elsewhere if isinstance(elsewhere, Scratch) else elsewhere.assembly.scratch
        assert own is not variant.assembly.scratch


def test_a_variant_rests_where_a_model_rests_that_is_written_so(system):
    """Nothing of one system's rest may stand in the data when the next one borrows them."""
    variants = [wr.varied(system, masses={"mass": factor}) for factor in (0.7, 1.4)]
    first = [wr.equilibrium(variant).state.values for variant in variants]
    alone = [wr.equilibrium(pickle.loads(pickle.dumps(variant))).state.values for variant in variants[::-1]]
    np.testing.assert_array_equal(first, alone[::-1])
