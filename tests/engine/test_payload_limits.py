"""Limits of the payload stated in a model: read, named, carried into the response, and refused when they say nothing."""

import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.payload_limits import KINDS, LimitKind, PayloadLimit, limit_from_text
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.foundation.units import VELOCITY_UNITS


def table_with(numerics):
    """Return the shock table's model with numerics added."""
    text = (models_folder() / "shock_table.xml").read_text(encoding="utf-8")
    return text.replace("<custom>", f"<custom>{numerics}", 1)


def limits_of(numerics):
    return wr.load_system(table_with(numerics)).limits


def test_limits_are_read_with_their_axes():
    found = limits_of(
        '<numeric name="limit/acceleration/block" data="98.1"/>'
        '<numeric name="limit/acceleration/block_top" data="0 0 150"/>'
        '<numeric name="limit/clearance/block_top" data="0.01 0.02 0 0 0.03 0.04"/>'
    )
    assert [(limit.kind, limit.name) for limit in found] == [
        ("acceleration", "block"), ("acceleration", "block_top"), ("clearance", "block_top"),
    ]  # fmt: skip
    assert found[0].judged == {"": 98.1}
    assert found[1].judged == {"z": 150.0}
    assert found[2].judged == {"-x": 0.01, "+x": 0.02, "-z": 0.03, "+z": 0.04}


def test_a_prefix_of_attached_models_belongs_to_the_name():
    text = table_with('<numeric name="A-limit/acceleration/block" data="98.1"/>')
    text = text.replace('<body name="block"', '<body name="A-block"')
    assert [limit.name for limit in wr.load_system(text).limits] == ["A-block"]


def test_limits_travel_with_the_response(tmp_path):
    system = wr.load_system(table_with('<numeric name="limit/clearance/block_top" data="0.01 0.01 0.04"/>'))
    motion = wr.VelocityStep(velocity=0.1, direction="z")
    response = wr.simulate(system, motion, duration=0.01)
    assert response.scene.limits == system.limits
    response.save(tmp_path)
    assert wr.load_response(tmp_path).scene.limits == system.limits


def test_the_cabinet_states_the_limit_of_its_vendor():
    limit, *others = wr.load_system(models_folder() / "cabinet.xml").limits
    assert (limit.kind, limit.name) == ("acceleration", "rack")
    assert not others
    assert limit.judged == {"": pytest.approx(10 * wr.STANDARD_GRAVITY, rel=1e-12)}


@pytest.mark.parametrize(
    ("numeric", "message"),
    [
        (
            '<numeric name="limit/acceleration/blok" data="98"/>',
            "no point 'blok' that has this.*There are .*block",
        ),
        ('<numeric name="limit/acceleration/table" data="98"/>', "no body of the payload .* 'table'"),
        ('<numeric name="limit/speed/block" data="98"/>', "KIND one of acceleration, clearance"),
        ('<numeric name="limit/acceleration/block" data="1 2"/>', "must be 1 or 3 numbers, got 2"),
        ('<numeric name="limit/acceleration/block" data="-98"/>', "finite and >= 0"),
        ('<numeric name="limit/acceleration/block" data="0"/>', "one of them > 0"),
        (
            '<numeric name="limit/acceleration/block" data="1"/><numeric name="A-limit/acceleration/block" data="1"/>',
            "no point 'A-block'",
        ),
    ],
)
def test_a_limit_that_says_nothing_is_refused(numeric, message):
    with pytest.raises(wr.ModelError, match=message):
        limits_of(numeric)


def test_a_kind_that_joins_the_list_is_read_and_known_of_every_body_and_point(monkeypatch):
    monkeypatch.setitem(KINDS, "velocity", LimitKind((1, 3), "m/s", VELOCITY_UNITS, 1e-6, 1e4))
    limits = limits_of('<numeric name="limit/velocity/block" data="2"/><numeric name="limit/velocity/block_top" data="0 0 3"/>')
    assert [(limit.kind, limit.name, limit.judged) for limit in limits] == [
        ("velocity", "block", {"": 2.0}), ("velocity", "block_top", {"z": 3.0}),
    ]  # fmt: skip
    assert limit_from_text("velocity/block = 2 m/s") == limits[0]


def test_a_limit_of_an_unknown_kind_is_refused():
    with pytest.raises(ValueError, match="`kind` must be one of 'acceleration', 'clearance'"):
        PayloadLimit(kind="speed", name="block", values=(1.0,))


@pytest.mark.quick
def test_one_number_of_a_clearance_holds_all_around():
    assert limit_from_text("clearance/rack = 50 mm") == limit_from_text("clearance/rack = 50 50 50 mm")
    assert set(limit_from_text("clearance/rack = 50 mm").ways.values()) == {0.05}
    with pytest.raises(ValueError, match="must be 1, 3 or 6 numbers, got 2"):
        limit_from_text("clearance/rack = 50 20 mm")
