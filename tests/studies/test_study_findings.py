import math
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest
from scipy.stats import qmc

from wirerope_mj.content.study_statements import exceedance_text, failures, numbered, percent
from wirerope_mj.studies.results.effects import Effect, effects
from wirerope_mj.studies.results.measure import checked_measure, exceedance, exceedance_of, measure_of, quantiles, worst
from wirerope_mj.studies.results.study_summary import StudySummary


def table_of(inputs, values, *, status=None):
    """Return a table as that of a study, with one measure."""
    n = len(values)
    return pa.table(
        {
            "variant": list(range(n)),
            **{name: list(column) for name, column in inputs.items()},
            "acceleration": list(values),
            "status": status or ["done"] * n,
            "message": [""] * n,
        }
    )


def shares(inputs, values):
    return {one.name: one for one in effects(table_of(inputs, values), list(inputs), "acceleration")}


def test_first_order_shares_of_ishigamis_function_are_found_without_special_sampling():
    points = -math.pi + 2.0 * math.pi * qmc.LatinHypercube(3, rng=1).random(8192)
    x1, x2, x3 = points.T
    a, b = 7.0, 0.1
    found = shares({"x1": x1, "x2": x2, "x3": x3}, np.sin(x1) + a * np.sin(x2) ** 2 + b * x3**4 * np.sin(x1))
    # Closed form (Ishigami and Homma 1990): V1 = (1 + b pi^4 / 5)^2 / 2, V2 = a^2 / 8, V13 = 8 b^2 pi^8 / 225.
    v1, v2, v13 = 0.5 * (1.0 + b * math.pi**4 / 5.0) ** 2, a**2 / 8.0, 8.0 * b**2 * math.pi**8 / 225.0
    whole = v1 + v2 + v13
    # 0.02: sampling error of 8192 points, and what 20 classes lose of a curve.
    assert found["x1"].index == pytest.approx(v1 / whole, abs=0.02)
    assert found["x2"].index == pytest.approx(v2 / whole, abs=0.02)
    assert found["x3"].index == pytest.approx(0.0, abs=0.02)
    assert not found["x3"].certain
    assert abs(found["x2"].rank) < 0.05  # it rises and falls: ranks do not see what the share does


def test_shares_of_a_sum_are_those_of_its_variance_and_ranks_have_its_signs():
    x = np.random.default_rng(2).standard_normal((4000, 3))
    found = shares({"up": x[:, 0], "down": x[:, 1], "none": x[:, 2]}, 2.0 * x[:, 0] - x[:, 1])
    # 4 : 1, less the variance inside 16 classes of a normal distribution, about 2 %.
    assert found["up"].index == pytest.approx(0.8, abs=0.03)
    assert found["down"].index == pytest.approx(0.2, abs=0.03)
    assert found["up"].rank > 0.8
    assert found["down"].rank < -0.3
    assert [found[name].certain for name in ("up", "down", "none")] == [True, True, False]


def test_an_input_that_only_goes_along_with_a_strong_one_is_given_little():
    x = np.random.default_rng(3).standard_normal(1000)
    alike = x + 0.7 * np.random.default_rng(4).standard_normal(1000)
    found = shares({"alike": alike, "cause": x}, x)
    assert found["cause"].index > 0.95
    assert found["alike"].index < 0.05  # alone it would explain two thirds


def test_words_and_truth_values_are_classes():
    generator = np.random.default_rng(5)
    words, truth = generator.choice(["a", "b", "c"], 600), generator.choice([True, False], 600)
    found = shares({"word": words.tolist(), "truth": truth.tolist()}, 3.0 * (words == "b") + 1.0 * truth)
    # Variances 9 * 2/9 = 2 and 1/4; 0.05: what 600 draws of them scatter.
    assert found["word"].index == pytest.approx(2.0 / 2.25, abs=0.05)
    assert found["truth"].index == pytest.approx(0.25 / 2.25, abs=0.05)
    assert math.isnan(found["word"].rank)


def test_of_many_inputs_without_effect_hardly_any_is_called_certain():
    generator = np.random.default_rng(6)
    named = sum(
        any(one.certain for one in shares({f"x{k}": generator.random(200) for k in range(20)}, generator.random(200)).values())
        for _ in range(30)
    )
    assert named <= 2  # one in a hundred studies is promised; 3 of 30 have a chance of 0.3 %


def test_nothing_is_said_of_too_few_variants_or_of_what_stands_still():
    assert effects(table_of({"x": range(5)}, range(5)), ["x"], "acceleration") == ()
    assert effects(table_of({"x": range(50)}, [1.0] * 50), ["x"], "acceleration") == ()


def test_the_probability_of_what_never_happened_has_an_upper_bound():
    values = np.linspace(0.0, 0.9, 100)
    found = exceedance(values, 1.0)
    assert (found.count, found.n, found.low) == (0, 100, 0.0)
    assert found.high == pytest.approx(1.0 - 0.025 ** (1.0 / 100.0), rel=1e-9)  # (1 - p)^100 = 0.025


def test_bounds_of_a_probability_are_those_of_the_literature():
    found = exceedance(np.array([2.0] * 10 + [0.0] * 90), 1.0)
    assert (found.low, found.high) == (pytest.approx(0.0490, abs=5e-5), pytest.approx(0.1762, abs=5e-5))  # 10 of 100


def test_failed_variants_are_in_no_figure():
    values = np.array([1.0, 5.0, np.nan, 2.0])
    table = table_of({"x": range(4)}, values, status=["done", "failed", "done", "done"])
    assert worst(table, "acceleration", 4) == [3, 0]


def test_variants_that_failed_are_counted_beside_the_probability_and_not_in_it():
    table = table_of({"x": range(6)}, [1.0, 5.0, 9.0, 2.0, 0.0, 0.0], status=["done"] * 4 + ["failed"] * 2)
    found = exceedance_of(table, "acceleration", 4.0)
    assert (found.count, found.n, found.failed) == (2, 4, 2)
    assert found.ratio == 0.5
    assert found.at_most == pytest.approx(4.0 / 6.0)
    assert exceedance_text(found, found.ratio) == "2 of 4 (50 %), 2 failed"


def test_variants_of_one_message_are_told_together():
    failed = {3: "no rest beyond 0.02 %", 5: "unstable", **{k: f"no rest beyond {k}e-3 %" for k in range(8, 15)}}
    found = failures(failed)
    assert [numbered(numbers) for numbers in found.values()] == ["8 variants (3, 8, 9, 10, 11, 12, ...)", "variant 5"]


def test_a_percentile_is_given_with_exactly_five_variants_beyond_it():
    values = np.arange(50.0)
    assert quantiles(values, (0.9, 0.1)) == pytest.approx([44.1, 4.9])  # 50 (1 - 0.9) is 4.999... in floating point
    assert all(math.isnan(one) for one in quantiles(values, (0.91, 0.09)))


def test_of_inputs_that_may_be_chance_those_of_all_mounts_are_told_first():
    generator = np.random.default_rng(1)
    names = ["mount/m01/axial/alpha", "mount/m02/axial/alpha", "mount/*/shear/alpha", "body/floor/mass", "motion/level"]
    columns = {name: generator.random(20) for name in names}
    table = table_of(columns, generator.random(20))
    found = [Effect(name=name, index=0.1, rank=0.1, certain=name.startswith("mount/m02")) for name in names]
    summary = StudySummary(
        result=SimpleNamespace(columns=table, study=SimpleNamespace(sampling="sobol")),
        by="acceleration",
        effects=tuple(found),
    )
    assert summary.ranked_inputs[:4] == (
        "mount/m02/axial/alpha",
        "mount/*/shear/alpha",
        "body/floor/mass",
        "motion/level",
    )


def test_percentiles_beyond_which_hardly_any_variant_lies_are_not_given():
    middle, high = quantiles(np.arange(100.0), (0.5, 0.99))
    assert middle == 49.5
    assert math.isnan(high)


def test_measures_are_shown_in_the_units_of_engineers_with_their_limits():
    assert measure_of("travel").limit == 1.0
    assert measure_of("acceleration/floor").factor == pytest.approx(1.0 / 9.80665)
    assert measure_of("deflection/m1/compression").label == "largest deflection, m1/compression [mm]"
    assert [percent(value) for value in (0.0, 0.0004, 0.0123, 0.2)] == ["0 %", "0.04 %", "1.2 %", "20 %"]


def test_an_unknown_measure_and_one_without_values_are_named():
    table = table_of({"x": range(3)}, [math.nan] * 3)
    with pytest.raises(ValueError, match="no measure 'speed'; there are acceleration"):
        checked_measure(table, "speed")
    with pytest.raises(ValueError, match="'acceleration' has no value in any variant"):
        checked_measure(table, "acceleration")
