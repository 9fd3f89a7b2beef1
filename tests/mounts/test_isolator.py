"""Isolator files: what they hold, how they are found, and what is said about a wrong one."""

import copy
import math
import os
import tomllib
from dataclasses import replace

import pytest
import tomli_w

from wirerope_mj.foundation import resources
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.mounts.isolator import (
    AXES,
    Geometry,
    Isolator,
    Limits,
    Provenance,
    Spread,
    Travel,
)
from wirerope_mj.mounts.laws import (
    LAWS,
    AsymmetricBoucWen,
    BoucWen,
    KelvinVoigt,
    Ozdemir,
    Parallel,
    Stop,
    SymmetricBoucWen,
)
from wirerope_mj.mounts.vendor_parts import find_isolator, load_isolator

pytestmark = pytest.mark.quick

EVERY_LAW = [
    BoucWen(alpha=1e5, beta=2.0, gamma=-0.5, n=0.7, k=3e4),
    Ozdemir(alpha=1e5, beta=0.01, n=2),
    AsymmetricBoucWen(alpha=1e5, beta=150.0, gamma=30.0, n=1.0, k1=8e4, k2=1e5, k3=2e7, b=math.e, c=6.0),
    SymmetricBoucWen(alpha=1e5, beta=150.0, gamma=30.0, n=1.0, k1=8e4, k2=1e5, k3=2e7),
    KelvinVoigt(k=1e5, c=300.0),
]


def full() -> dict:
    """Content of a file with every table, all right."""
    return {
        "name": "Test",
        "axial": {"law": "bouc-wen", "alpha": 1e5, "beta": 150.0, "gamma": 30.0, "n": 1, "k": 2e4},
        "shear": {"law": "kelvin-voigt", "k": 1e5, "c": 100.0},
        "limits": {"static_load": 1000, "travel": {"compression": 0.04, "shear": 0.03}},
        "geometry": {"height": 0.1, "width": 0.12},
        "provenance": {"kind": "published", "source": "somewhere", "assumed": ["all of it"]},
        "spread": {"parameters": ["axial.alpha", "axial.k"], "covariance": [[1, 0.5], [0.5, 2]]},
    }


def changed(path: str, value: object) -> dict:
    """The full content with one entry set, or taken out if the value is None."""
    content = copy.deepcopy(full())
    *tables, key = path.split("/")
    table = content
    for name in tables:
        table = table.setdefault(name, {})
    if value is None:
        del table[key]
    else:
        table[key] = value
    return content


@pytest.mark.parametrize("law", EVERY_LAW, ids=lambda law: law.name)
def test_every_law_comes_back_bit_exact_from_a_saved_file(tmp_path, law):
    isolator = Isolator(
        name="Ünïcode 1/3",
        axial=law,
        roll=law,
        limits=Limits(static_load=1.0 / 3.0, travel=Travel(compression=0.1, tension=0.2, roll=0.3)),
        geometry=Geometry(height=0.1),
        provenance=Provenance(kind="identified", source="a test", assumed=("one", "two"), check_45={"x": 0.1}),
        spread=Spread(parameters=("axial.alpha",), covariance=((1.0 / 3.0,),)),
    )
    isolator.save(tmp_path / "a.toml")
    assert load_isolator(tmp_path / "a.toml") == isolator


def test_every_law_has_been_tried():
    assert {law.name for law in EVERY_LAW} <= set(LAWS)


def test_axes_come_in_the_order_of_the_mount_frame():
    isolator = Isolator.from_dict(full())
    assert tuple(isolator.axes) == AXES == ("roll", "shear", "axial")
    assert isolator.roll is None
    assert isinstance(isolator.shear, KelvinVoigt)
    assert isinstance(isolator.axial, BoucWen)


def test_whole_numbers_are_taken_as_floats():
    isolator = Isolator.from_dict(full())
    assert isinstance(isolator.axial, BoucWen)
    assert type(isolator.axial.n) is float
    assert type(isolator.limits.static_load) is float


def test_rated_travel_is_given_below_and_above_zero():
    limits = Limits(travel=Travel(compression=0.04, shear=0.03))
    isolator = Isolator(name="a", axial=KelvinVoigt(k=1, c=0), limits=limits)
    assert isolator.rated_travel("axial") == (0.04, None)
    assert isolator.rated_travel("shear") == (0.03, 0.03)
    assert isolator.rated_travel("roll") == (None, None)
    with pytest.raises(ValueError, match="`axis` must be one of 'roll', 'shear', 'axial'"):
        isolator.rated_travel("z")


WRONG = [
    ("name", None, r"f\.toml: `name` is missing"),
    ("name", 3, r"f\.toml: `name` must be a text that is not empty"),
    ("colour", "red", r"f\.toml: `colour` is unknown; known: name, roll, shear, axial, coupling, free"),
    ("axial", 3, r"f\.toml: \[axial\] it must be a table, got 3"),
    ("axial/law", None, r"\[axial\] `law` is missing; the laws are .*bouc-wen, .*kelvin-voigt, .*ozdemir"),
    ("axial/law", "hooke", r"\[axial\] there is no `law` 'hooke'; the laws are asymmetric-bouc-wen, bouc-wen"),
    ("axial/law", 1, r"\[axial\] there is no `law` 1; the laws are"),
    ("axial/beta", None, r"\[axial\] `beta` is missing; needed: alpha, beta, gamma, n"),
    ("axial/delta", 1.0, r"\[axial\] `delta` is unknown; known: alpha, beta, gamma, n, k. Did you mean `beta`"),
    ("axial/beta", "1", r"\[axial\] `beta` must be a finite number \[N\^\(1-n\)/m\], got '1'"),
    ("axial/beta", True, r"\[axial\] `beta` must be a finite number \[N\^\(1-n\)/m\], got True"),
    ("axial/beta", [1.0], r"\[axial\] `beta` must be a finite number \[N\^\(1-n\)/m\], got \[1\.0\]"),
    ("axial/beta", math.nan, r"\[axial\] `beta` must be a finite number \[N\^\(1-n\)/m\], got nan"),
    ("axial/beta", math.inf, r"\[axial\] `beta` must be a finite number \[N\^\(1-n\)/m\], got inf"),
    ("axial/beta", 10**400, r"\[axial\] `beta` must be a finite number \[N\^\(1-n\)/m\], got 1000"),
    ("axial/beta", -1.0, r"\[axial\] `beta` must be > 0, got -1\.0: the law would not be passive"),
    ("axial/alpha", 0, r"\[axial\] `alpha` must be > 0, got 0\.0: the law would not be passive"),
    ("shear/c", -1, r"\[shear\] `c` must be a finite number >= 0 \[N s/m\], got -1"),
    ("limits/load", 1.0, r"\[limits\] `load` is unknown; known: static_load, travel"),
    ("limits/static_load", "heavy", r"\[limits\] `static_load` must be a finite number > 0 \[N\], got 'heavy'"),
    ("limits/static_load", True, r"\[limits\] `static_load` must be a finite number > 0 \[N\], got True"),
    ("limits/travel", 0.1, r"\[limits\] `travel` must be a table, got 0\.1"),
    ("limits/travel/axial", 0.1, r"\[limits\.travel\] `axial` is unknown; known: compression, tension"),
    ("limits/travel/shear", -0.1, r"\[limits\.travel\] `shear` must be a finite number > 0 and <= 2 \[m\], got -0\.1"),
    ("geometry/depth", 0.1, r"\[geometry\] `depth` is unknown"),
    ("geometry/height", math.nan, r"\[geometry\] `height` must be a finite number"),
    ("provenance/kind", None, r"\[provenance\] `kind` is missing"),
    (
        "provenance/kind",
        "guess",
        r"\[provenance\] `kind` must be one of 'catalogue', 'identified', 'published', 'estimated', 'illustrative'",
    ),
    ("provenance/source", 1, r"\[provenance\] `source` must be a text"),
    ("provenance/assumed", "all", r"\[provenance\] `assumed` must be a list of texts"),
    ("provenance/check_45", {"x": "y"}, r"\[provenance\.check_45\] `x` must be a finite number, got 'y'"),
    ("spread/covariance", [[1.0]], r"\[spread\] `covariance` must have 2 rows of 2 numbers"),
    ("spread/parameters", 3, r"\[spread\] `parameters` must be a list of texts"),
]


@pytest.mark.parametrize(("path", "value", "message"), WRONG)
def test_wrong_entry_is_named_with_table_key_and_rule(path, value, message):
    with pytest.raises(ModelError, match=message) as caught:
        Isolator.from_dict(changed(path, value), where="f.toml")
    assert str(caught.value).startswith("f.toml: ")


MILLIMETRES = [
    ("limits/travel/compression", 55, r"\[limits\.travel\] `compression` must be .* <= 2 \[m\], got 55\. .*write 0\.055"),
    ("limits/travel/roll", 45.2, r"\[limits\.travel\] `roll` must be .* <= 2 \[m\], got 45\.2\. .*write 0\.0452"),
    ("geometry/height", 120, r"\[geometry\] `height` must be .* <= 2 \[m\], got 120\. .*write 0\.12"),
]


@pytest.mark.parametrize(("path", "value", "message"), MILLIMETRES)
def test_millimetres_taken_for_metres_are_refused_with_the_number_to_write(path, value, message):
    with pytest.raises(ModelError, match=message):
        Isolator.from_dict(changed(path, value), where="f.toml")


STOP = {"law": "stop", "gap_below": 0.03, "k": 1e6}


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ({**STOP, "gap_below": 36}, r"\[axial\] stop: `gap_below` must be in metres .*got 36\. .*write 0\.036"),
        ({**STOP, "rounding": 1e300}, r"\[axial\] stop: `rounding` must be in metres"),
        ({"laws": [STOP, {**STOP, "gap_above": 5.0}]}, r"\[axial\] stop: `gap_above` must be in metres .*got 5\."),
        (
            {"law": "tabulated", "deflection": [-36, 36], "force": [-8e3, 8e3], "curve": "mid"},
            r"\[axial\] tabulated: `deflection` must be in metres .*got 36\. .*write 0\.036",
        ),
    ],
)
def test_millimetres_in_a_stop_or_a_table_are_refused(law, message):
    with pytest.raises(ModelError, match=message):
        Isolator.from_dict({"name": "a", "axial": law})


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"laws": []}, r"\[axial\] `laws` must be a list of one law or more"),
        ({"laws": STOP}, r"\[axial\] `laws` must be a list of tables, got {'law': 'stop'"),
        ({"laws": [STOP, {"laws": [STOP]}]}, r"\[\[axial\.laws\]\] 2 it holds `laws` itself: put all of them into one list"),
        ({**STOP, "laws": [STOP]}, r"\[axial\] `law` is unknown; known: laws"),
        ({"laws": [STOP, {**STOP, "gap_below": -1}]}, r"2 `gap_below` must be a finite number >= 0 \[m\], got -1"),
    ],
)
def test_laws_in_parallel_that_cannot_be_are_refused(table, message):
    with pytest.raises(ModelError, match=message):
        Isolator.from_dict({"name": "a", "axial": table})


@pytest.mark.parametrize(("travel", "largest"), [("compression", 0.12), ("shear", 1.2)])
def test_travel_is_held_against_the_height_of_the_isolator(travel, largest):
    """A mount 0.12 m high is not compressed by 0.13 m, and does not move sideways by ten times its height."""
    Isolator.from_dict(_high(travel, largest))
    with pytest.raises(ModelError, match=rf"f\.toml: .*`{travel}` of .* m is more than .* `height` of 0\.12 m"):
        Isolator.from_dict(_high(travel, 1.01 * largest), where="f.toml")


def test_travel_and_bars_are_held_against_each_other():
    table = _high("compression", 0.08) | {"geometry": {"height": 0.12, "bar": 0.02}}
    assert Isolator.from_dict(table).geometry.solid_compression == pytest.approx(0.08, rel=1e-12)
    with pytest.raises(ModelError, match="more than the 0.08 m between the bars"):
        Isolator.from_dict(table | _limits("compression", 0.081))
    with pytest.raises(ModelError, match="`bar`, the thickness of one bar, must be less than half the `height`"):
        Isolator.from_dict(table | {"geometry": {"height": 0.12, "bar": 0.06}})


def _limits(travel, value):
    return {"limits": {"travel": {travel: value}}}


def _high(travel, value):
    spring = {"law": "kelvin-voigt", "k": 1e5, "c": 0.0}
    return {"name": "a", "axial": spring, "limits": {"travel": {travel: value}}, "geometry": {"height": 0.12}}


def test_file_without_an_axis_is_refused():
    with pytest.raises(ModelError, match="must have a law on at least one axis of roll, shear, axial"):
        Isolator.from_dict({"name": "a"})


def test_law_that_blows_up_within_the_rated_travel_is_refused():
    # beta + gamma < 0 and n = 2: infinite at pi / (2 sqrt(alpha B)) = 1.57 m for alpha = B = 1.
    axial = {"law": "bouc-wen", "alpha": 1, "beta": 0.8, "gamma": -1.8, "n": 2}
    content = {"name": "a", "axial": axial, "limits": {"travel": {"compression": 1.5, "tension": 1.6}}}
    with pytest.raises(
        ModelError, match=r"\[axial\] bouc-wen holds up to a deflection of 1\.5708 m.*infinite.*rated travel of 1\.6 m"
    ):
        Isolator.from_dict(content, where="f.toml")
    content["limits"]["travel"]["tension"] = 1.5
    assert Isolator.from_dict(content).axial.finite_travel == pytest.approx(math.pi / 2.0)
    del content["limits"]["travel"]["tension"]
    with pytest.raises(ModelError, match=r"up to a deflection of 1\.5708 m.*needs a rated travel on both sides"):
        Isolator.from_dict(content)


COUPLED = BoucWen(alpha=2e4, beta=70.0, gamma=30.0, n=1.0, k=5e3)


def test_coupling_is_saved_and_loaded(tmp_path):
    isolator = Isolator(name="a", roll=COUPLED, shear=COUPLED, coupling="biaxial")
    isolator.save(tmp_path / "a.toml")
    assert load_isolator(tmp_path / "a.toml") == isolator
    assert isolator.coupled.roll == COUPLED
    assert Isolator(name="a", roll=COUPLED, shear=COUPLED).coupled is None


@pytest.mark.parametrize(
    ("laws", "coupling", "words"),
    [
        ({"axial": KelvinVoigt(k=1, c=0)}, {"roll": "shear"}, r"`coupling` must be one of 'biaxial', 'loop', got"),
        ({"roll": COUPLED}, "biaxial", "needs a law on both axes"),
        ({"roll": COUPLED, "shear": KelvinVoigt(k=1, c=0)}, "biaxial", "`shear` must be a Bouc-Wen law"),
        (
            {"roll": COUPLED, "shear": replace(COUPLED, n=2.0)},
            "biaxial",
            "must have the same n to be coupled, got 1 and 2",
        ),
        (
            {"roll": COUPLED, "shear": replace(COUPLED, beta=80.0)},
            "biaxial",
            r"must have the same sigma .*got 0\.7 and",
        ),
        (
            {"roll": COUPLED, "shear": replace(COUPLED, gamma=-70.0)},
            "biaxial",
            r"`shear` must have `beta` \+ `gamma` > 0",
        ),
        (
            {"roll": replace(COUPLED, beta=30.0, gamma=70.0), "shear": replace(COUPLED, beta=60.0, gamma=140.0)},
            "biaxial",
            "must have the same z_max.* not be passive",
        ),
        (
            {"roll": COUPLED, "shear": Parallel(laws=[COUPLED, Stop(gap_below=0.03, k=1e6)])},
            "biaxial",
            "`shear` must be a Bouc-Wen law .*, got parallel. Beside a coupled isolator a stop is a mount of its own",
        ),
    ],
)
def test_coupling_that_cannot_be_is_refused(laws, coupling, words):
    with pytest.raises(ValueError, match=words):
        Isolator(name="a", coupling=coupling, **laws)


def test_what_is_not_a_law_is_refused():
    with pytest.raises(ValueError, match="`axial` must be a Law, got 100000"):
        Isolator(name="a", axial=1e5)


def test_syntax_error_is_named_with_its_line(tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text('name = "a"\n[axial]\nlaw = bouc-wen\n')
    with pytest.raises(ModelError, match=r"broken\.toml: not valid TOML: .*line 3"):
        load_isolator(path)


def test_missing_file_is_named(tmp_path):
    with pytest.raises(ModelError, match=r"nowhere\.toml: cannot read this isolator file: there is no such file"):
        load_isolator(tmp_path / "nowhere.toml")


def test_file_that_is_not_text_is_refused(tmp_path):
    (tmp_path / "a.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ModelError, match="not a text file"):
        load_isolator(tmp_path / "a.toml")


def test_failed_save_leaves_the_old_file_and_nothing_beside(tmp_path, monkeypatch):
    path = tmp_path / "a.toml"
    old = Isolator(name="old", axial=KelvinVoigt(k=1, c=0))
    old.save(path)

    def fail(*_):
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="disk full"):
        Isolator(name="new", axial=KelvinVoigt(k=2, c=0)).save(path)
    assert load_isolator(path) == old
    assert [item.name for item in tmp_path.iterdir()] == ["a.toml"]


def test_isolator_beside_the_model_wins_over_the_catalogue(tmp_path):
    (tmp_path / "isolators").mkdir()
    mine = tmp_path / "isolators" / "enidine_wr16_400.toml"
    mine.write_text(tomli_w.dumps(full()))
    assert find_isolator("isolators/enidine_wr16_400.toml", tmp_path) == mine
    assert find_isolator("isolators/enidine_wr12_400.toml", tmp_path).parent == resources.catalogue_folder()
    assert find_isolator("enidine_wr12_400").parent == resources.catalogue_folder()


def test_unknown_isolator_lists_those_that_exist():
    with pytest.raises(ModelError, match=r"there is no isolator 'wr99': looked for .*enidine_wr16_400.*rubber_horizontal"):
        find_isolator("wr99")


def test_shipped_folders_are_found_in_this_checkout():
    assert (resources.models_folder() / "isolators").samefile(resources.catalogue_folder())
    assert resources.scenarios_folder().is_dir()


def test_shipped_folders_are_found_in_an_installed_package(tmp_path, monkeypatch):
    package = tmp_path / "wirerope_mj"
    (tmp_path / "models").mkdir()  # somebody else's: there is no pyproject.toml beside it
    monkeypatch.setattr(resources, "_PACKAGE", package)
    assert resources.models_folder() == package / "_data" / "models"
    assert resources.catalogue_folder() == package / "_data" / "models" / "isolators"


def test_file_on_disk_is_plain_toml_with_the_tables_of_the_house(tmp_path):
    Isolator.from_dict(full()).save(tmp_path / "a.toml")
    content = tomllib.loads((tmp_path / "a.toml").read_text())
    assert content["axial"]["law"] == "bouc-wen"
    assert content["limits"]["travel"] == {"compression": 0.04, "shear": 0.03}
    assert content["provenance"]["assumed"] == ["all of it"]


def test_lists_in_lists_without_end_are_no_toml(tmp_path):
    path = tmp_path / "deep.toml"
    path.write_text("a = " + "[" * 20_000)
    with pytest.raises(ModelError, match=r"deep\.toml: not valid TOML: .*too deeply"):
        load_isolator(path)
