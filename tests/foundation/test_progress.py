import pytest

from wirerope_mj.engine.simulation import progress
from wirerope_mj.engine.simulation.progress import share_bar, time_left, work_after


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


def test_a_bar_counts_what_is_done(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "120")
    with share_bar("study", "variants/s", enabled=True, total=93, parts="variants") as update:
        update(29 / 93, 12.34)  # 93 * (29 / 93) is 28.999999999999996
    assert "29 of 93 variants, 12.34 variants/s" in capsys.readouterr().err


def test_where_nobody_sees_a_bar_lines_are_printed_now_and_then(capsys, monkeypatch):
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    clock = [0.0]
    monkeypatch.setattr(progress, "perf_counter", lambda: clock[0])
    with share_bar("study", "variants/s", enabled=True, total=1000, parts="variants") as update:
        for second in range(0, 121, 10):  # all of it takes 256 s
            clock[0] = float(second)
            update(second / 256, 4.0)
    estimate, *lines = capsys.readouterr().err.splitlines()
    assert estimate.startswith("study: about 4.3 min")
    assert lines == [
        "study: 234 of 1000 variants, 4 variants/s, 0:03:16 left",
        "study: 468 of 1000 variants, 4 variants/s, 0:02:16 left",
    ]


def test_of_a_run_that_takes_days_a_hundred_lines_are_enough(capsys, monkeypatch):
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    clock = [0.0]
    monkeypatch.setattr(progress, "perf_counter", lambda: clock[0])
    with share_bar("study", "variants/s", enabled=True) as update:
        for step in range(10001):
            clock[0] = 60.0 * step
            update(step / 10000, 4.0)
    estimate, *lines = capsys.readouterr().err.splitlines()
    assert estimate.startswith("study: about 170 h")
    assert 90 <= len(lines) <= 100


@pytest.mark.parametrize(("seconds", "estimates"), [(9.0, []), (40.0, ["study: about 40 s"])])
def test_what_takes_long_is_said_once_its_speed_is_known(capsys, monkeypatch, seconds, estimates):
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    clock = [0.0]
    monkeypatch.setattr(progress, "perf_counter", lambda: clock[0])
    with share_bar("study", "variants/s", enabled=True, begun=0.5, disk=3e8) as update:
        for step in range(21):  # the half that is left
            clock[0] = step / 20 * seconds
            update(0.5 + 0.5 * step / 20, 4.0)
    lines = capsys.readouterr().err.splitlines()
    assert [line.partition(", ")[0] for line in lines] == estimates
    assert all(line.endswith(" of memory, 300 MB of disk") for line in lines)


@pytest.mark.parametrize(("bar", "estimate"), [(20.0, "run: about 28 s"), (0.5, "run: about 8.5 s")])
def test_an_estimate_of_a_run_holds_what_comes_after_its_bar(capsys, monkeypatch, bar, estimate):
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    monkeypatch.setattr(progress, "SAID", 8.0)
    clock = [0.0]
    monkeypatch.setattr(progress, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(progress, "process_time", lambda: clock[0] / 2.0)  # another process has the other half of the processor
    with work_after("run", 4.0, memory=0.0, enabled=True), share_bar("simulating", "s", enabled=True) as update:
        for step in range(21):
            clock[0] = step / 20 * bar
            update(step / 20, 4.0)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.partition(",")[0] == estimate


def test_an_estimate_holds_what_its_work_says_comes_after(capsys, monkeypatch):
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    clock = [0.0]
    monkeypatch.setattr(progress, "perf_counter", lambda: clock[0])
    with share_bar("choosing the step", "s", enabled=True) as update:
        for step in range(21):
            clock[0] = float(step)
            update(step / 20, 0.0, 15.0)
    assert capsys.readouterr().err.startswith("choosing the step: about 35 s")


def test_what_comes_after_a_block_without_progress_is_not_said(capsys, monkeypatch):
    monkeypatch.setattr(progress, "SAID", 0.0)
    with work_after("run", 100.0, memory=0.0, enabled=False):
        pass
    assert capsys.readouterr() == ("", "")


def test_a_bar_shows_value_and_time_left(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    with share_bar("study", "variants/s", enabled=True, begun=0.5) as update:
        update(0.999999, 12.34)
    assert "12.34 variants/s" in capsys.readouterr().err
