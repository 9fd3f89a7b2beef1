from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest

from wirerope_mj.content.blocks import OTHERS
from wirerope_mj.content.study_charts import (
    choices_chart,
    directions_chart,
    distribution_chart,
    scatter_chart,
    sensitivity_chart,
    study_charts,
)
from wirerope_mj.studies.results.effects import Effect, effects
from wirerope_mj.studies.results.study_summary import StudySummary
from wirerope_mj.studies.vary.sampling import LISTED
from wirerope_mj.views.pictures import save_pictures
from wirerope_mj.views.plots.svg_chart import chart_svg


def table_of(inputs, travel):
    n = len(travel)
    return pa.table(
        {
            "variant": list(range(n)),
            **{name: list(column) for name, column in inputs.items()},
            "acceleration": [10.0 * one for one in travel],
            "travel": [float(one) for one in travel],
            "fragility": [float("nan")] * n,
            "status": ["done"] * n,
            "message": [""] * n,
        }
    )


def summary_of(table, sampling="random", inputs=(), found=None, labels=()):
    labelled = [SimpleNamespace(columns=[SimpleNamespace(name=name, label=label)]) for name, label in dict(labels).items()]
    study = SimpleNamespace(sampling=sampling, quantities=labelled)
    result = SimpleNamespace(columns=table, independent=table, is_sampled=sampling not in LISTED, study=study)
    found = effects(table, inputs, "travel") if found is None else tuple(found)
    return StudySummary(result=result, by="travel", effects=found)


def charts(table, sampling, inputs):
    return {one.id: one for one in study_charts(summary_of(table, sampling, inputs))}


def only_panel(chart):
    ((panel,),) = chart.rows
    return panel


def test_the_distribution_rises_to_all_variants_and_marks_limit_and_percentiles():
    travel = np.linspace(0.205, 1.2, 200)  # 0.005 apart, so that 40 are beyond 1
    table = table_of({"x": travel}, travel)
    panel = only_panel(distribution_chart(summary_of(table), table, ["travel"]))
    (line,) = panel.curves
    assert line.y[[0, -1]].tolist() == [0.0, 100.0]
    assert line.x[[0, -1]].tolist() == pytest.approx([20.5, 120.0])
    assert list(panel.xlimits) == [("limit", 100.0)]
    assert "40 of 200" in panel.title
    assert [text.split(":")[0] for *_, text, _ in panel.notes] == [
        "50 %",
        "90 %",
        "95 %",
    ]  # two are beyond 99 %: not known


def test_bars_of_inputs_go_from_the_strongest_down_and_pale_ones_say_so():
    found = [
        Effect(name="motion/level", index=0.7, rank=0.9, certain=True),
        Effect(name="mount/m1/axial/alpha", index=0.1, rank=-0.3, certain=True),
        Effect(name="body/floor/centre_shift/x", index=-0.01, rank=0.0, certain=False),
    ]
    labels = {"body/floor/centre_shift/x": "body/floor/centre_shift/x [m]", "motion/level": "motion/level [factor]"}
    table = table_of({"motion/level": [1.0]}, [0.5])
    panel = only_panel(sensitivity_chart(summary_of(table, found=found, labels=labels)))
    assert [text for _, text in panel.yticks] == [
        "motion/level [factor]", "mount/m1/axial/alpha", "body/floor/centre_shift/x [m]"
    ]  # fmt: skip
    places = [(curve.kind, curve.x.tolist(), curve.y.tolist()) for curve in panel.curves]
    assert places == [(0, [70.0], [0.0]), (1, [10.0], [-1.0]), (OTHERS, [0.0], [-2.0])]  # one rises, one falls
    assert panel.notes[2][2] == "0 % (not significant), rank correlation +0.00"
    assert panel.notes[0][2] == "70 %, rank correlation +0.90"


def test_the_map_of_directions_puts_every_value_where_it_belongs():
    azimuth, elevation = (one.ravel() for one in np.meshgrid([-90.0, 0.0, 90.0, 180.0], [-90.0, 0.0, 90.0]))
    travel = 1.0 + 0.001 * azimuth + 0.0001 * elevation
    table = table_of({"motion/azimuth": azimuth, "motion/elevation": elevation}, travel)
    panel = only_panel(directions_chart(table, "travel"))
    grid = panel.field.values
    assert grid.shape == (3, 4)  # a row for each elevation
    assert grid[0, 0] == pytest.approx(100.0 * (1.0 - 0.09 - 0.009))
    assert grid[2, 0] == pytest.approx(100.0 * (1.0 - 0.09 + 0.009))
    assert panel.field.limit == 100.0
    assert panel.title.endswith("at elevation 90°")  # a pole has no azimuth


def test_directions_that_are_no_grid_are_dots_in_classes():
    azimuth, elevation = np.array([0.0, 10.0, 50.0, -30.0]), np.array([3.0, 20.0, 80.0, 41.0])
    table = table_of({"motion/azimuth": azimuth, "motion/elevation": elevation}, [0.1, 0.2, 0.9, 0.5])
    panel = only_panel(directions_chart(table, "travel"))
    assert panel.field is None
    assert [curve.x.tolist() for curve in panel.curves] == [[0.0, 10.0], [-30.0], [50.0]]


def test_choices_are_sorted_and_the_one_without_a_failure_is_called_none():
    table = table_of({"mount/*/failed": ["", "m1", "m2"]}, [0.5, 1.2, 0.8])
    panel = only_panel(choices_chart(table, "mount/*/failed", ["travel"]))
    assert [text for _, text in panel.yticks] == ["m1", "m2", "none"]
    sizes = {-row: size for curve in panel.curves for row, size in zip(curve.y, curve.x, strict=True)}
    assert [sizes[row] for row in range(3)] == pytest.approx([120.0, 80.0, 50.0])


def test_choices_may_be_truth_values():
    table = table_of({"mount/m1/fitted": [False, True]}, [0.5, 0.8])
    panel = only_panel(choices_chart(table, "mount/m1/fitted", ["travel"]))
    assert [text for _, text in panel.yticks] == ["True", "False"]


def test_the_distribution_says_how_many_variants_failed_and_one_variant_has_none():
    table = table_of({"x": [1.0] * 5}, [0.5, 0.6, 1.2, 0.0, 0.0])
    table = table.set_column(table.column_names.index("status"), "status", [["done"] * 3 + ["failed"] * 2])
    panel = only_panel(distribution_chart(summary_of(table), table, ["travel"]))
    assert panel.title == "beyond the limit: 1 of 3 (33 %), 2 failed"
    assert charts(table_of({"x": [1.0]}, [0.5]), "random", ["x"]) == {}


def test_means_over_a_grid_are_those_at_its_values():
    level, mass = (one.ravel() for one in np.meshgrid([1.0, 2.0, 3.0], np.arange(4.0)))
    table = table_of({"motion/level": level, "mass": mass}, level + mass)
    means, marks = only_panel(scatter_chart(summary_of(table, found=()), table, ["motion/level"])).curves
    assert means.x.tolist() == [1.0, 2.0, 3.0]
    assert means.y.tolist() == pytest.approx([250.0, 350.0, 450.0])  # 1.5 is the mean of the masses
    assert marks.x.size == 12


def test_drawn_variants_get_their_distribution_and_their_inputs(tmp_path):
    x = np.random.default_rng(1).random((200, 2))
    table = table_of({"motion/level": x[:, 0], "mount/m$1/axial/alpha": x[:, 1]}, x[:, 0])
    found = charts(table, "random", ["motion/level", "mount/m$1/axial/alpha"])
    assert list(found) == ["distribution", "sensitivity", "scatter"]
    save_pictures(list(found.values()), tmp_path / "charts.png")  # a dollar in a name begins no formula
    assert all(chart_svg(one).startswith("<svg") for one in found.values())


@pytest.mark.parametrize(
    ("inputs", "name"),
    [
        ({"motion/level": np.arange(12.0)}, "curve"),
        ({"mount/*/failed": ["", *(f"m{k}" for k in range(11))]}, "choices"),
        (
            {"motion/azimuth": np.tile([0.0, 90.0, 180.0, 270.0], 3), "motion/elevation": np.repeat([0, 45, 90], 4)},
            "directions",
        ),
    ],
)
def test_a_grid_gets_the_one_picture_that_suits_it_and_no_probabilities(inputs, name):
    assert list(charts(table_of(inputs, np.linspace(0.5, 1.5, 12)), "grid", list(inputs))) == [name]
