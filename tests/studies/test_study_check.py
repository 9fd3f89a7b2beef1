"""Columns of inputs are checked at once: never less strictly than one by one, and with the same words."""

import dataclasses
import math
import re

import numpy as np
import pytest
from house import sdof_text
from laws_for_tests import PARAMETERS, example
from one_scale import one_scale
from test_study import PULSE, table_study

import wirerope_mj as wr
from wirerope_mj.mounts.laws import LAWS
from wirerope_mj.studies.vary import variants as making

pytestmark = pytest.mark.quick

ONE_BY_ONE = {"vaiana-rosati", "tabulated"}
"""Laws whose rules are about curves, not parameters."""

FACTORS = (-1.0, 0.0, 0.4, 0.97, 1.03, 2.5)


def holds(law, **values):
    """Return whether a law with these values can be made and holds at any deflection."""
    try:
        return dataclasses.replace(law, **values).finite_travel == math.inf
    except ValueError:
        return False


def scaled(nominal, factor):
    return tuple(factor * one for one in nominal) if isinstance(nominal, tuple | list) else factor * nominal


def parameters(name):
    law = example(name)
    return [one.name for one in dataclasses.fields(law) if isinstance(getattr(law, one.name), float | tuple | list)]


@pytest.mark.parametrize("name", LAWS)
def test_columns_hold_only_if_every_entry_does(name):
    law = dataclasses.replace(example(name), **{k: tuple(v) for k, v in PARAMETERS[name].items() if isinstance(v, list)})
    keys = parameters(name)
    pairs = [(key,) for key in keys] + [(one, other) for one in keys for other in keys if one < other]
    agreed = 0
    for pair in pairs:
        for factors in [(1.0, 1.0, factor) for factor in FACTORS] + [(1.0, 0.97, 1.03)]:
            column = np.array(factors)
            sure = law.certainly_valid({key: scaled(getattr(law, key), column) for key in pair})
            if sure or name not in ONE_BY_ONE:
                each = all(holds(law, **{k: scaled(getattr(law, k), factor) for k in pair}) for factor in factors)
                assert each or not sure, (pair, factors)
                agreed += sure == each
    # What cannot be said of columns is asked one by one; of nearly all laws that is never needed.
    assert name in ONE_BY_ONE or agreed == len(pairs) * (len(FACTORS) + 1)


def test_columns_that_are_not_finite_do_not_hold():
    law = example("bouc-wen")
    assert law.certainly_valid({"alpha": np.array([1e5, 2e5])})
    for wrong in (math.nan, math.inf):
        assert not law.certainly_valid({"alpha": np.array([1e5, wrong])})


def pinched_study(**others):
    """Vary the two parameters of a law that are only right or wrong together: beta + gamma must be > 0."""
    law = example("bouc-wen-baber-noori", beta=100.0, gamma=-50.0)
    vary = {f"mount/m1/axial/{key}": wr.Normal(1.0, 0.25, relative=True, low=0.2) for key in ("beta", "gamma")}
    isolator = wr.Isolator(name="pinched", roll=law, shear=law, axial=law)
    return table_study(vary, isolators={"wr12_400": isolator}, sampling="random", **others)


def refused(study):
    with pytest.raises(wr.ModelError) as caught:
        study.table()
    return str(caught.value)


def test_a_rule_about_two_parameters_is_kept_and_names_the_first_variant(monkeypatch):
    study = pinched_study(variants=4000)
    beta, gamma = (np.asarray(study.rows(0, study.size)[f"mount/m1/axial/{key}"]) for key in ("beta", "gamma"))
    total = 100.0 * beta - 50.0 * gamma
    first = int(np.argmax(total <= 0.0))
    assert first > 0
    monkeypatch.setattr(making, "BLOCK", max(first // 2, 1))  # so that blocks before it pass
    message = refused(study)
    assert re.match(
        rf"variant {first} of study 'study' cannot be: mount 'm1': \[axial\] `beta` \+ `gamma` must be > 0, got -",
        message,
    )
    monkeypatch.setattr(making, "systems_valid", lambda *_: False)
    assert refused(pinched_study(variants=4000)) == message


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        (
            {"body/block/mass": wr.Choice(1.0, 0.0, relative=True)},
            "variant 1 .*: body/block/mass must be finite and > 0, got 0",
        ),
        (
            {"body/block/mass": wr.Choice(50.0, -0.5)},
            "variant 1 .*: body/block/mass must be finite and > 0 kg, got -0.5 kg",
        ),
        (
            {"body/block/centre_shift/z": wr.Choice(0.0, np.inf)},
            "variant 1 .*: body/block/centre_shift/z must be finite, got inf",
        ),
        ({"motion/level": wr.Choice(1.0, 2.0, 0.0)}, "variant 2 .*: motion/level must be finite and not zero, got 0.0"),
    ],
)
def test_masses_and_levels_are_checked_at_once_and_refused_one_by_one(vary, message):
    study = table_study(vary, sampling="grid", variants=None, motion=dataclasses.replace(PULSE, direction="x"))
    assert re.match(message, refused(study))


def test_only_what_columns_cannot_say_is_asked_one_by_one(monkeypatch):
    asked = []
    changes = making.Maker.changes
    monkeypatch.setattr(making.Maker, "changes", lambda self, row: (asked.append(row), changes(self, row))[1])
    vary = {
        "mount/m1/axial/alpha": wr.Normal(1.0, 0.1, relative=True, low=0.5),
        "mount/m1/failed": wr.Choice(True, False),
        "motion/level": wr.Uniform(0.5, 1.5),
    }
    assert table_study(vary, isolators=one_scale("wr12_400"), variants=64).table().num_rows == 64
    assert len(asked) == 1  # one system is made, to see that there is room for it
    law = example("bouc-wen")
    coupled = wr.Isolator(name="plane", roll=law, shear=law, axial=law, coupling="biaxial")
    shared = {"isolators": {"wr12_400": coupled}, "variants": 16}
    asked.clear()
    table_study({"mount/*/axial/alpha": wr.Normal(1.0, 0.1, relative=True, low=0.5)}, **shared).table()
    assert len(asked) == 1
    asked.clear()
    with pytest.raises(wr.ModelError, match="variant 0 .*same sigma"):
        table_study({"mount/m1/roll/beta": wr.Normal(1.0, 0.1, relative=True, low=0.5)}, **shared).table()


@pytest.mark.parametrize("gammas", [(-0.7, -0.65), (-0.7, -0.2)])
def test_a_law_that_ends_in_some_rows_alone_is_no_raw_error(gammas):
    # beta 0.6, n 2: with gamma < -0.6 the force is infinite at a finite deflection, and n stays one number for all rows.
    law = example("symmetric-bouc-wen")
    assert not law.certainly_valid({"gamma": np.array(gammas)})
    assert law.certainly_valid({"gamma": np.array([-0.5, -0.2])})


LIMIT_CURVES = {"kb": 3e4, "f0": 150.0, "alpha": 300.0, "b1": 20.0, "b2": 60.0}


@pytest.mark.parametrize("parameter", LIMIT_CURVES)
@pytest.mark.parametrize("relative", [True, False])
def test_a_varied_limit_curve_is_the_one_whose_file_was_edited(parameter, relative):
    law = LAWS["vaiana-rosati"](**LIMIT_CURVES)
    isolators = {"wr12_400": wr.Isolator(name="curves", axial=law, roll=law, shear=law)}
    value = 1.1 if relative else 1.1 * LIMIT_CURVES[parameter]
    study = table_study(
        {f"mount/m1/axial/{parameter}": wr.Choice(value, relative=relative)},
        isolators=isolators, sampling="grid", variants=None,
    )  # fmt: skip
    assert study.table().num_rows == 1
    by_hand = LAWS["vaiana-rosati"](**{**LIMIT_CURVES, parameter: 1.1 * LIMIT_CURVES[parameter]})
    assert study.system(0).mounts["m1"].isolator.axial == by_hand


def test_what_a_law_states_itself_does_not_follow():
    law = LAWS["vaiana-rosati"](**LIMIT_CURVES, f0_minus=100.0)
    assert law.completed({"f0": 165.0}) == {"f0": 165.0}
    assert law.completed({"alpha": 1.0, "alpha_minus": 2.0}) == {"alpha": 1.0, "alpha_minus": 2.0}
    assert law.completed({"f0_minus": 90.0}) == {"f0_minus": 90.0}


def test_columns_of_equal_limit_curves_are_checked_at_once():
    law = LAWS["vaiana-rosati"](**LIMIT_CURVES)
    column = np.array([0.9, 1.1])
    assert law.certainly_valid(law.completed({"kb": 3e4 * column, "f0": 150.0 * column}))
    assert not law.certainly_valid(law.completed({"f0": 150.0 * np.array([1.0, -0.1])}))
    assert not law.certainly_valid({"kb": 3e4 * column})  # other slopes downwards: the curves cross


def test_where_limit_curves_cross_is_where_the_force_of_both_is_one():
    law = LAWS["vaiana-rosati"](**LIMIT_CURVES, kb_minus=2.9e4)
    # 3e4 x + f0 = 2.9e4 x - f0
    assert law.finite_travel == pytest.approx(300.0 / 1e3, rel=1e-12)


def test_a_shift_for_which_the_model_has_no_room_is_refused_though_the_first_is_none():
    # MuJoCo compiles the mass of this model as simple, on its slide alone.
    law = example("bouc-wen")
    shared = {"model": sdof_text(), "isolators": {"a": wr.Isolator(name="a", axial=law)}}
    vary = {"motion/level": wr.Choice(1.0, 2.0), "body/mass/centre_shift/z": wr.Choice(0.0, 0.01, 0.02)}
    study = table_study(vary, sampling="grid", variants=None, **shared)
    assert 'simple="false"' in refused(study)
    vary["body/mass/centre_shift/z"] = wr.Choice(0.0)
    assert table_study(vary, sampling="grid", variants=None, **shared).table().num_rows == 2


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        (
            {"mount/m1/axial/alpha": wr.Normal(1.0, 0.1)},
            r"mount/m1/axial/alpha is from 0\.8\d* to 1\.\d* in the study and \d+.* in the model; .* say `relative`",
        ),
        (
            {"body/block/mass": wr.Uniform(5e3, 6e3)},
            "body/block/mass is from 5.*e.03 to 5.*e.03 in the study and .* in the model",
        ),
    ],
)
def test_values_that_were_perhaps_meant_as_factors_are_doubted(vary, message):
    with pytest.warns(wr.StudyWarning, match=message):
        table_study(vary, isolators=one_scale("wr12_400"), variants=16).table()


def test_values_near_the_models_and_factors_are_not_doubted():
    vary = {
        "mount/m1/axial/alpha": wr.Uniform(1e3, 2e5),
        "mount/m1/shear/alpha": wr.Normal(1.0, 0.1, relative=True),
        "mount/m1/axial/k2": wr.Uniform(1e3, 2e3),
        "body/block/mass": wr.Uniform(6.0, 80.0),
    }
    study = table_study(vary, isolators=one_scale("wr12_400"), variants=16)
    assert study.table().num_rows == 16  # a warning would be an error here


def test_an_ellipse_without_size_is_refused_in_words():
    law = example("equivalent-viscous")
    study = table_study(
        {"mount/m1/axial/amplitude": wr.Choice(0.01, 1e-200)},
        isolators={"wr12_400": wr.Isolator(name="ellipse", axial=law, roll=law, shear=law)}, sampling="grid", variants=None,
    )  # fmt: skip
    with pytest.raises(wr.ModelError, match="variant 1 .*`amplitude` must not"):
        study.table()
