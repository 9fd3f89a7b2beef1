"""Orders of a machine's speed held against the resonances of a frequency response."""

from types import SimpleNamespace

import pytest

from wirerope_mj.cli import main
from wirerope_mj.dynamics.frequency_response.summary import order_bands, order_statements


@pytest.mark.quick
def test_orders_are_multiples_of_the_speed():
    half, second = order_bands([0.5, 2.0], [900.0, 600.0])
    assert (half.low, half.high) == (5.0, 7.5)
    assert (second.low, second.high) == (20.0, 30.0)
    (one,) = order_bands([1.0], [1500.0])
    assert one.low == one.high == 25.0


@pytest.mark.quick
def test_a_resonance_is_named_in_the_band_it_lies_in():
    peaks = [
        SimpleNamespace(frequency=6.0, at_edge=False), SimpleNamespace(frequency=25.0, at_edge=False),
        SimpleNamespace(frequency=7.0, at_edge=True),
    ]  # fmt: skip
    findings = [SimpleNamespace(peaks=peaks, level=SimpleNamespace(acceleration=2.0))]
    half, first = order_statements(order_bands([0.5, 1.0], [600.0, 900.0]), findings)
    assert half == "Order 0.5, 5 to 7.5 Hz: resonance at 6.00 Hz at 2 m/s²."
    assert first == "Order 1, 10 to 15 Hz: no resonance."


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--orders", "1"], "belong together"),
        (["--speed-rpm", "600"], "belong together"),
        (["--orders", "1", "--speed-rpm", "1", "2", "3"], "one speed or two"),
        (["--orders", "0", "--speed-rpm", "600"], "--orders"),
        (["--orders", "1", "--speed-rpm", "-600"], "--speed-rpm"),
    ],
)
def test_wrong_orders_are_one_message(arguments, said, capsys):
    assert main(["frf", "sdof_shaker", *arguments]) == 2
    assert said in capsys.readouterr().err


def test_the_command_says_which_orders_meet_a_resonance(tmp_path, capsys):
    arguments = ["--acceleration", "4", "--start", "20", "--stop", "60", "--largest-step", "0.1"]
    orders = ["--orders", "1", "2", "--speed-rpm", "1000", "1200"]
    assert main(["frf", "sdof_shaker", *arguments, *orders, "--out", str(tmp_path / "frf")]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "Order 1, 16.67 to 20 Hz: no resonance." in printed
    assert "Order 2, 33.33 to 40 Hz: resonance at 36" in printed
