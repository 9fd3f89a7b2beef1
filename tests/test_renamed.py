"""Earlier names work for one more version, and say what the name is now."""

import pkgutil
from importlib import import_module

import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.renamed import Renamed

EARLIER = {
    "EN1998_TYPE_1": "motions.EN1998_TYPE_1", "banded_lines": "motions.banded_lines", "psd_from_g": "motions.psd_from_g",
    "psd_level": "motions.psd_level", "psd_rms": "motions.psd_rms", "read_cycles": "load_cycles",
    "write_cyclic_test": "save_cyclic_test",
}  # fmt: skip


def classes():
    """Return every class of the package."""
    found = set()
    for module in pkgutil.walk_packages(wr.__path__, "wirerope_mj."):
        if ".__main__" not in module.name:
            found |= {one for one in vars(import_module(module.name)).values() if isinstance(one, type)}
    return {one for one in found if one.__module__.startswith("wirerope_mj.")}


def renamed():
    """Return what has an earlier name: class, earlier name, and how it is called now."""
    return [
        (owner, name, value._now)
        for owner in sorted(classes(), key=lambda one: one.__qualname__)
        for name, value in vars(owner).items()
        if isinstance(value, Renamed)
    ]


def test_every_earlier_name_of_a_result_leads_to_one_that_is_there():
    rows = renamed()
    assert len(rows) == 13
    for owner, name, now in rows:
        fields = getattr(owner, "__dataclass_fields__", {})
        assert hasattr(owner, now) or now in fields, f"{owner.__name__}.{name}"
        assert name not in fields


def test_an_earlier_name_warns_where_it_is_used_and_answers():
    verdict = wr.Verdict(criterion="travel", subject="m1", value=1.0, limit=4.0, unit="m")
    with pytest.warns(
        DeprecationWarning, match=r"Verdict\.share is called Verdict\.utilisation since version 0\.2"
    ) as seen:
        assert verdict.share == 0.25
    assert seen[0].filename == __file__


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
