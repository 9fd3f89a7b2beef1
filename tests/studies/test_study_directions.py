import numpy as np
import pyarrow as pa
import pytest

from wirerope_mj.content.study_charts import directions_chart
from wirerope_mj.studies.results.effects import (
    AZIMUTH,
    ELEVATION,
    directions_text,
    fraction_of_directions,
    sphere_areas,
)


def grid(step, *, repeats):
    """Return azimuths and elevations every `step` [deg]; with `repeats` the seam and the poles stand there many times."""
    up = np.arange(-90.0, 91.0, step)
    around = np.arange(-180.0, 181.0 if repeats else 180.0, step)
    pairs = [(a, e) for e in up for a in (around if repeats or abs(e) < 90.0 else [0.0])]
    return np.array(pairs).T


def table_of(azimuth, elevation, travel):
    n = len(travel)
    columns = {
        "variant": list(range(n)),
        AZIMUTH: azimuth,
        ELEVATION: elevation,
        "acceleration": travel,
        "travel": travel,
    }
    return pa.table({**columns, "status": ["done"] * n, "message": [""] * n})


@pytest.mark.parametrize("repeats", [False, True])
def test_areas_make_the_whole_sphere_and_follow_the_cosine_of_the_elevation(repeats):
    azimuth, elevation = grid(15.0, repeats=repeats)
    areas = sphere_areas(azimuth, elevation)
    assert areas.sum() == pytest.approx(1.0, rel=1e-12)  # rounding
    of = {e: areas[(elevation == e) & (azimuth == 15.0)][0] for e in (-75.0, 0.0, 60.0)}
    # A belt from e - d to e + d has 2 cos(e) sin(d): the cosine exactly, whatever the width.
    assert of[60.0] / of[0.0] == pytest.approx(0.5, rel=1e-12)
    assert of[-75.0] / of[0.0] == pytest.approx(np.cos(np.radians(75.0)), rel=1e-12)


@pytest.mark.parametrize("repeats", [False, True])
def test_the_share_of_a_cap_is_that_of_its_area_and_not_of_its_points(repeats):
    azimuth, elevation = grid(10.0, repeats=repeats)
    values = np.where(elevation > 54.9, 1.5, 0.5)  # 60 degrees and above are beyond: a cap down to 55 degrees
    table = table_of(azimuth, elevation, values)
    share = fraction_of_directions(table, [AZIMUTH, ELEVATION], values, 1.0)
    assert share == pytest.approx((1.0 - np.sin(np.radians(55.0))) / 2.0, rel=1e-12)  # Archimedes; its points are 18 %
    assert np.mean(values > 1.0) > 1.5 * share


def test_shares_of_directions_are_those_of_the_directions_that_are_known():
    azimuth, elevation = grid(30.0, repeats=False)
    values = np.where(elevation > 0.0, 1.5, 0.5)
    table = table_of(azimuth, elevation, values)
    known = np.where(elevation == 0.0, np.nan, values)
    assert fraction_of_directions(table, [AZIMUTH, ELEVATION], known, 1.0) == pytest.approx(0.5, rel=1e-12)  # rounding
    assert fraction_of_directions(table, [AZIMUTH, "motion/level"], values, 1.0) is None


def test_a_map_without_repeats_closes_at_the_seam_and_at_the_poles():
    azimuth, elevation = grid(30.0, repeats=False)
    values = 1.0 + 0.001 * azimuth + 0.0001 * elevation
    field = directions_chart(table_of(azimuth, elevation, values), "travel").rows[0][0].field
    cells = field.values
    assert cells.shape == (7, 13)
    assert cells[1:-1, 0] == pytest.approx(cells[1:-1, -1])  # -180 is 180
    assert cells[0] == pytest.approx(np.full(13, 99.1))  # straight down, under every azimuth
    assert cells[3, 9] == pytest.approx(109.0)  # along y
    # Heights are sines: equal areas.
    assert field.y[[3, 4]] == pytest.approx([-np.sin(np.pi / 12.0), np.sin(np.pi / 12.0)])


def test_what_nobody_looked_at_has_no_area():
    azimuth, elevation = (one.ravel() for one in np.meshgrid(np.arange(0.0, 360.0, 45.0), [0.0, 45.0, 90.0]))
    values = np.where(elevation == 0.0, 1.5, 0.5)
    table = table_of(azimuth, elevation, values)
    share = fraction_of_directions(table, [AZIMUTH, ELEVATION], values, 1.0)
    # The equator stands for its belt up to 22.5 degrees, of the upper half alone; rounding.
    assert share == pytest.approx(np.sin(np.radians(22.5)), rel=1e-12)
    assert directions_text(table) == "the directions looked at"


def test_the_ends_of_a_fan_stand_for_half_as_much_as_what_lies_between():
    azimuth, elevation = (one.ravel() for one in np.meshgrid([0.0, 30.0, 60.0, 90.0], [-15.0, 15.0]))
    areas = sphere_areas(azimuth, elevation)
    assert areas == pytest.approx(np.tile([1.0, 2.0, 2.0, 1.0], 2) / 12.0, rel=1e-12)  # rounding
    with_pole = sphere_areas(np.append(azimuth, 0.0), np.append(elevation, 90.0))
    # Of the fan's part of the sphere the pole has what lies above 52.5 degrees, as of the whole.
    upper, lower = np.sin(np.radians(52.5)), np.sin(np.radians(-15.0))
    assert with_pole[-1] == pytest.approx((1.0 - upper) / (1.0 - lower), rel=1e-12)


def test_only_a_grid_around_the_sphere_and_from_pole_to_pole_is_all_directions():
    whole = grid(30.0, repeats=False)
    assert directions_text(table_of(*whole, np.ones(whole.shape[1]))) == "all directions"
    belt = whole[:, np.abs(whole[1]) < 90.0]
    assert directions_text(table_of(*belt, np.ones(belt.shape[1]))) == "the directions looked at"
    half = whole[:, (whole[0] >= 0.0) | (np.abs(whole[1]) == 90.0)]
    assert directions_text(table_of(*half, np.ones(half.shape[1]))) == "the directions looked at"
