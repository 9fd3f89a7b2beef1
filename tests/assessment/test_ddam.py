"""Design values of DDAM: the stated example, limits of large and small weights, the least value, and the command's table."""

import math
import re

import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.ddam import KIP, ddam_design_values
from wirerope_mj.cli import main

G, INCH = wr.STANDARD_GRAVITY, 0.0254


@pytest.mark.quick
def test_a_kip_on_a_deck_has_the_values_that_are_quoted():
    values = ddam_design_values(KIP, 100.0, location="deck", direction="vertical")
    assert values.reference_acceleration / G == pytest.approx(102.0, abs=0.5)
    assert values.reference_velocity / INCH == pytest.approx(55.7, abs=0.05)


@pytest.mark.quick
def test_limits_for_weights_that_vanish_and_grow():
    light, heavy = (ddam_design_values(w * KIP, 1e4, location="hull", direction="vertical") for w in (1e-9, 1e9))
    assert light.reference_acceleration / G == pytest.approx(20 * 37.5 * 12 / 36)
    assert light.reference_velocity / INCH == pytest.approx(120.0)
    assert heavy.reference_acceleration / G == pytest.approx(20.0)
    assert heavy.reference_velocity / INCH == pytest.approx(60.0)
    submarine = ddam_design_values(1e-9, 1e4, location="hull", direction="vertical", ship="submarine")
    assert submarine.reference_acceleration / G == pytest.approx(10.4 * 24)
    assert submarine.reference_velocity / INCH == pytest.approx(96.0)


@pytest.mark.quick
def test_the_smaller_branch_counts_and_never_less_than_six_g():
    slow = ddam_design_values(5 * KIP, 8.0, location="deck", direction="vertical")
    assert slow.acceleration == pytest.approx(slow.reference_velocity * 2 * math.pi * 8.0)
    fast = ddam_design_values(5 * KIP, 200.0, location="deck", direction="vertical")
    assert fast.acceleration == fast.reference_acceleration
    assert ddam_design_values(5 * KIP, 1.0, location="deck", direction="fore-and-aft").acceleration == 6.0 * G


@pytest.mark.quick
def test_what_bends_takes_half_the_velocity():
    one, half = (
        ddam_design_values(KIP, 10.0, location="hull", direction="athwartship", deformation=kind)
        for kind in ("elastic", "elastic-plastic")
    )
    assert half.reference_velocity == 0.5 * one.reference_velocity
    assert half.reference_acceleration == one.reference_acceleration
    with pytest.raises(ValueError, match="shell plating"):
        ddam_design_values(KIP, 10.0, location="shell", direction="vertical", deformation="elastic-plastic")


@pytest.mark.quick
@pytest.mark.parametrize("wrong", [{"location": "mast"}, {"direction": "up"}, {"ship": "boat"}, {"deformation": "soft"}])
def test_what_there_is_not_is_refused(wrong):
    with pytest.raises(ValueError, match="must be one of"):
        ddam_design_values(KIP, 10.0, **{"location": "hull", "direction": "vertical", **wrong})


def test_the_command_gives_every_mode_its_design_acceleration(tmp_path, capsys):
    assert main(["modes", "shock_table", "--ddam", "deck", "--out", str(tmp_path / "modes")]) == 0
    printed = capsys.readouterr().out
    found = wr.modes(wr.load_system("shock_table"))
    mode = int(found.participation[:, 2].argmax())
    frequency = float(found.frequencies[mode])
    weight = 50.0 * G  # the block, all of which takes part along z
    value = ddam_design_values(weight, frequency, location="deck", direction="vertical").acceleration / G
    assert re.search(rf"^{mode + 1} .*{frequency:.3f} .*{weight:.1f} .*{value:.1f}", printed, re.MULTILINE)
    assert "interim values" in printed
