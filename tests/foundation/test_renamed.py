"""Earlier names work for one more version, and say what the name is now."""

import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main

EARLIER = {
    "EN1998_TYPE_1": "motions.EN1998_TYPE_1", "banded_lines": "motions.banded_lines", "psd_from_g": "motions.psd_from_g",
    "psd_level": "motions.psd_level", "psd_rms": "motions.psd_rms", "read_cycles": "load_cycles",
    "write_cyclic_test": "save_cyclic_test",
}  # fmt: skip


@pytest.mark.parametrize("name", EARLIER)
def test_earlier_names_of_the_front_door_lead_to_todays(name):
    with pytest.warns(DeprecationWarning, match=f"wirerope_mj.{name} is called wirerope_mj.{EARLIER[name]}") as seen:
        found = getattr(wr, name)
    assert seen[0].filename == __file__
    now = wr
    for part in EARLIER[name].split("."):
        now = getattr(now, part)
    assert found is now
    assert name not in dir(wr)


def test_a_name_that_never_was_is_an_attribute_error():
    with pytest.raises(AttributeError, match="nothing_of_the_kind"):
        wr.nothing_of_the_kind  # noqa: B018


def test_earlier_names_of_commands_lead_to_todays(capsys):
    assert main(["explore", "--port", "-1"]) == 2  # as the board says it
    said = capsys.readouterr().err
    assert "`wirerope explore` is called `wirerope board`" in said
    assert "`--port` must be from 0 to 65535" in said
