"""What ships passes as it ships: every check of a scenario's default has a margin, and a level that its help names fails."""

import pytest

import wirerope_mj as wr
from wirerope_mj.runs.scenario import load_scenario

MARGIN = 0.85
"""Of a limit that may be used: what the models are dimensioned for."""

LONG = {"cabinet_random", "floating_floor_sweep"}


def used(name, **options):
    """Return the largest utilisation in a scenario."""
    scenario = load_scenario(name).make(**options)
    response = wr.simulate(wr.load_system(scenario.model), scenario.motion, **scenario.simulate)
    return max(verdict.utilisation for verdict in wr.judge(response) if verdict.utilisation is not None)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] if name in LONG else [])
        for name in (
            "cabinet_random", "cabinet_shock", "floating_floor_double_pulse", "floating_floor_shock", "floating_floor_sweep",
            "shock_table", "shock_table_frame",
        )
    ],
)  # fmt: skip
def test_the_default_of_a_scenario_passes_with_a_margin(name):
    assert 0.1 < used(name) <= MARGIN


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "options"),
    [("floating_floor_shock", {"level_g": 15.0}), ("floating_floor_double_pulse", {"displacement_mm": 45.0})],
)
def test_the_level_that_the_help_names_fails(name, options):
    assert used(name, **options) > 1.0
