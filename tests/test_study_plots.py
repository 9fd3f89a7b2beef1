from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest

from wirerope_mj.studies.inputs.sampling import LISTED
from wirerope_mj.studies.results.effects import Effect, effects
from wirerope_mj.studies.results.study_summary import StudySummary
from wirerope_mj.views.plots.directions import directions_figure
from wirerope_mj.views.plots.study import choices_figure, distribution_figure, scatter_figure, sensitivity_figure
from wirerope_mj.views.plots.study_pictures import study_pictures


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


def pictures(table, sampling, inputs):
    study = SimpleNamespace(sampling=sampling, quantities=())
    result = SimpleNamespace(table=table, independent=table, is_sampled=sampling not in LISTED, study=study)
    answer = StudySummary(result=result, by="travel", effects=effects(table, inputs, "travel"))
    return {one.name: one for one in study_pictures(answer)}


def texts(panel):
    return [text.get_text() for text in panel.texts]


def test_the_distribution_rises_to_all_variants_and_marks_limit_and_percentiles():
    travel = np.linspace(0.205, 1.2, 200)  # 0.005 apart, so that 40 are beyond 1
    (panel,) = distribution_figure(table_of({"x": travel}, travel), ["travel"]).axes
    line = panel.lines[0]
    assert line.get_ydata()[-1] == 100.0
    assert line.get_xdata()[[0, -1]].tolist() == pytest.approx([20.5, 120.0])
    assert [one.get_xdata()[0] for one in panel.lines if one.get_linestyle() == "--"] == [100.0]
    assert "40 of 200 variants" in panel.get_title(loc="left")
    assert [text.split(":")[0] for text in texts(panel)] == ["50 %", "90 %", "95 %"]  # two are beyond 99 %: not known


def test_bars_of_inputs_go_from_the_strongest_down_and_pale_ones_say_so():
    found = [
        Effect(name="motion/level", index=0.7, rank=0.9, certain=True),
        Effect(name="mount/m1/axial/alpha", index=0.1, rank=-0.3, certain=True),
        Effect(name="body/floor/centre_shift/x", index=-0.01, rank=0.0, certain=False),
    ]
    labels = {"body/floor/centre_shift/x": "body/floor/centre_shift/x [m]", "motion/level": "motion/level [factor]"}
    (panel,) = sensitivity_figure(found, "travel", labels).axes
    assert [bar.get_width() for bar in panel.patches] == pytest.approx([0.0, 10.0, 70.0])
    shown = [label.get_text() for label in panel.get_yticklabels()]
    assert shown == ["body/floor/centre_shift/x [m]", "mount/m1/axial/alpha", "motion/level [factor]"]
    assert "not surely above chance" in texts(panel)[0]
    assert panel.patches[0].get_alpha() < 0.5 < panel.patches[1].get_alpha()
    assert panel.patches[1].get_facecolor() != panel.patches[2].get_facecolor()  # one falls, one rises


def test_the_map_of_directions_puts_every_value_where_it_belongs():
    azimuth, elevation = (one.ravel() for one in np.meshgrid([-90.0, 0.0, 90.0, 180.0], [-90.0, 0.0, 90.0]))
    travel = 1.0 + 0.001 * azimuth + 0.0001 * elevation
    table = table_of({"motion/azimuth": azimuth, "motion/elevation": elevation}, travel)
    panel = directions_figure(table, "travel").axes[0]
    grid = panel.collections[0].get_array().reshape(3, 4)  # a row for each elevation
    assert grid[0, 0] == pytest.approx(100.0 * (1.0 - 0.09 - 0.009))
    assert grid[2, 0] == pytest.approx(100.0 * (1.0 - 0.09 + 0.009))
    assert panel.get_title(loc="left").endswith("at elevation 90°")  # a pole has no azimuth


def test_choices_are_sorted_and_the_one_without_a_failure_is_called_none():
    table = table_of({"mount/*/failed": ["", "m1", "m2"]}, [0.5, 1.2, 0.8])
    panel = choices_figure(table, "mount/*/failed", ["travel"]).axes[0]
    assert [label.get_text() for label in panel.get_yticklabels()] == ["none", "m2", "m1"]
    assert [bar.get_width() for bar in panel.patches] == pytest.approx([50.0, 80.0, 120.0])


def test_choices_may_be_truth_values():
    panel = choices_figure(
        table_of({"mount/m1/fitted": [False, True]}, [0.5, 0.8]), "mount/m1/fitted", ["travel"]
    ).axes[0]
    assert [label.get_text() for label in panel.get_yticklabels()] == ["False", "True"]


def test_the_word_of_chance_stands_beside_the_share_and_every_label_within_the_picture():
    found = [Effect(name="motion/level", index=share, rank=0.83, certain=False) for share in (0.6, 0.55)]
    figure = sensitivity_figure(found, "travel", {})
    figure.canvas.draw()
    (panel,) = figure.axes
    assert texts(panel)[1] == "60 % (not surely above chance), rank correlation +0.83"
    assert all(text.get_window_extent().x1 < panel.get_window_extent().x1 for text in panel.texts)


def test_the_distribution_says_how_many_variants_failed_and_one_variant_has_none():
    table = table_of({"x": [1.0] * 5}, [0.5, 0.6, 1.2, 0.0, 0.0])
    table = table.set_column(table.column_names.index("status"), "status", [["done"] * 3 + ["failed"] * 2])
    (panel,) = distribution_figure(table, ["travel"]).axes
    assert "1 of 3 variants; 2 more failed" in panel.get_title(loc="left")
    assert not panel.patches  # nothing whose scale the axis does not say
    assert pictures(table_of({"x": [1.0]}, [0.5]), "random", ["x"]) == {}


def test_means_over_a_grid_are_those_at_its_values():
    level, mass = (one.ravel() for one in np.meshgrid([1.0, 2.0, 3.0], np.arange(4.0)))
    panel = scatter_figure(
        table_of({"motion/level": level, "mass": mass}, level + mass), ["motion/level"], "travel", {}
    ).axes[0]
    line = panel.lines[1]
    assert line.get_xdata().tolist() == [1.0, 2.0, 3.0]
    assert line.get_ydata().tolist() == pytest.approx([250.0, 350.0, 450.0])  # 1.5 is the mean of the masses


def test_drawn_variants_get_their_distribution_and_their_inputs():
    x = np.random.default_rng(1).random((200, 2))
    table = table_of({"motion/level": x[:, 0], "mount/m$1/axial/alpha": x[:, 1]}, x[:, 0])
    found = pictures(table, "random", ["motion/level", "mount/m$1/axial/alpha"])
    assert list(found) == ["distribution", "sensitivity", "scatter"]
    found["scatter"].figure.canvas.draw()  # a dollar in a name begins no formula


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
    assert list(pictures(table_of(inputs, np.linspace(0.5, 1.5, 12)), "grid", list(inputs))) == [name]
