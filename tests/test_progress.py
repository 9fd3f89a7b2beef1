import pytest

from wirerope_mj.simulation.progress import share_bar, time_left


@pytest.mark.parametrize(
    ("share", "elapsed", "begun", "left"),
    [
        (0.25, 10.0, 0.0, "0:00:30"),  # three quarters at a quarter in ten seconds
        (0.75, 10.0, 0.5, "0:00:10"),  # what was done before says nothing of the speed
        (0.01, 73.3, 0.0, "2:00:57"),
        (1.0, 5.0, 0.5, "0:00:00"),
        (0.5, 5.0, 0.5, "-:--:--"),  # nobody knows yet
    ],
)
def test_the_time_left_follows_from_the_mean_speed_since_the_beginning(share, elapsed, begun, left):
    assert time_left(share, elapsed, begun=begun) == left


def test_a_bar_that_is_not_shown_spills_nothing(capsys):
    with share_bar("study", "variants/s", enabled=False) as update:
        update(0.5, 3.0)
    assert capsys.readouterr() == ("", "")


def test_a_bar_shows_value_and_time_left(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    with share_bar("study", "variants/s", enabled=True, begun=0.5) as update:
        update(0.999999, 12.34)
    assert "12.34 variants/s" in capsys.readouterr().err
