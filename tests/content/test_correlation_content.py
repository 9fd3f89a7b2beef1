"""What a run says of tests: the same blocks for page, terminal and recording, and measured channels as ghosts."""

import numpy as np
import pytest
from made_up_floor import floor_response

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import judge
from wirerope_mj.content.blocks import MEASURED, Chart, Statement
from wirerope_mj.content.correlation import correlation_content, with_ghosts
from wirerope_mj.content.histories import run_histories
from wirerope_mj.content.selection import select

pytestmark = pytest.mark.quick

CHANNELS = {"B": "base z m/s^2", "T": "point/rack_top z m/s^2", "D": "mount/m01 axial m", "F": "mount/m01 axial N"}


@pytest.fixture(scope="module")
def floor():
    return floor_response(mounts=2, equipment=1, rows=801)


@pytest.fixture(scope="module")
def tests(floor, tmp_path_factory):
    """Returns the run against its own histories, once as they are and once a third larger at the payload."""
    found = []
    for name, factor in (("same", 1.0), ("larger", 4.0 / 3.0)):
        path = tmp_path_factory.mktemp(name) / f"{name}.csv"
        mount = floor.mounts["m01"]
        columns = [floor.time, floor.base.acceleration[:, 2], factor * floor.points["rack_top"].acceleration[:, 2]]
        columns += [mount.deflection[:, 2], mount.force[:, 2]]
        np.savetxt(path, np.column_stack(columns), delimiter=",", header="time [s],B,T,D,F", comments="", fmt="%.15g")
        found.append(wr.correlate(floor, wr.load_measured(path, channels=CHANNELS)))
    return found


def test_the_verdict_is_that_of_the_worst_test(tests):
    content = correlation_content("floor", tests)
    assert content.title == "floor against same and larger"
    assert content.verdict.id == "agreement-larger"
    assert content.verdict.text.startswith("larger: Model 25 % low between 2.6 and 99 Hz (point rack_top, z); lowest ISO")
    assert content.verdict.values["deviation"] == pytest.approx(-0.25, abs=1e-6)
    first = next(section for section in content.sections if section.id == "tests")
    assert [block.id for block in first.blocks] == ["agreement-same", "agreement-larger"]
    assert first.blocks[0].tone == "within"


def test_one_test_says_its_agreement_once(tests):
    content = correlation_content("floor", tests[:1])
    assert "tests" not in content.sections_of("headline", "summary", "full")
    assert not [block for block in content.blocks() if isinstance(block, Statement)]  # nothing is doubtful


def test_all_curves_lie_over_each_other(tests):
    content = correlation_content("floor", tests[1:])
    charts = {block.id: block for block in content.blocks() if isinstance(block, Chart)}
    assert list(charts) == ["histories-larger", "spectra-larger", "transmissibility-larger", "loops-larger"]
    (panel,) = charts["histories-larger"].rows[1]
    assert [curve.name for curve in panel.curves] == ["model", "measured"]
    model, measured = (curve.peak[1] for curve in panel.curves)
    assert measured == pytest.approx(4.0 / 3.0 * model, rel=1e-9)
    spectrum, ratio = charts["spectra-larger"].rows[0]
    assert spectrum.title == "point rack_top, z: SRS"
    np.testing.assert_allclose(ratio.curves[0].y, 20.0 * np.log10(0.75), atol=1e-6)
    assert [level for _, level in ratio.limits] == pytest.approx([3.0, -3.0])
    ((loop,),) = charts["loops-larger"].rows
    assert (loop.xunit, loop.unit) == ("mm", "kN")


def test_measured_channels_are_ghosts_among_the_curves_of_a_run(floor, tests):
    panels = run_histories(floor, select(floor, judge(floor)))
    laid = with_ghosts(panels, tests[1:])
    added = laid["acceleration", "z"].curves[len(panels["acceleration", "z"].curves) :]
    assert [(curve.name, curve.kind) for curve in added] == [("rack_top measured", MEASURED)]
    assert [curve.kind for curve in laid["deflection", "axial"].curves].count(MEASURED) == 1
    alone = [key for key in laid if key[0] == "measured"]
    assert [key[3] for key in alone] == [one.label for one in tests[1].channels]
    assert len(panels) + len(alone) == len(laid)
