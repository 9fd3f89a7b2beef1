"""Tables made into classes: what is taken, what is refused with file, line, key, unit and remedy, and the schemas."""

import math
from dataclasses import dataclass, field
from datetime import date
from typing import Annotated, Literal

import jsonschema
import numpy as np
import pytest

from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.schema import schema
from wirerope_mj.foundation.structure import DATE, NEEDED, Among, In, Key, Place, bounds, check, structure
from wirerope_mj.foundation.toml_file import read_toml

pytestmark = pytest.mark.quick


@dataclass(frozen=True, kw_only=True)
class Rope:
    """A rope."""

    diameter: Annotated[float, bounds("m", gt=0.0, le=0.1)]  #: of the rope
    lay: Literal["left", "right"] = "right"
    strands: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Part:
    """A part of a catalogue."""

    name: Annotated[str, bounds(min_length=1)]
    ropes: tuple[Rope, ...] = ()
    issued: Annotated[str, DATE] = ""
    kind: Annotated[str, NEEDED] = "new"
    #: rated, of any
    #: direction
    travel: Annotated[float, In({"mm": 1e-3, "in": 0.0254})]
    points: Annotated[tuple[tuple[float, float], ...], In({"mm_N": (1e-3, 1.0)})] = ()
    load_case: Annotated[bool, Key("load-case")] = False
    tests: Annotated[dict[str, str | tuple[str, ...]], Among(("half-sine", "sweep"))] = field(default_factory=dict)
    by_axis: dict[str, Rope] = field(default_factory=dict)
    finish: str | None = None

    def __post_init__(self) -> None:
        check(self)
        if self.name == "none":
            raise ValueError("`name` must name something.")


RIGHT = """\
name = "a" # of the maker
kind = "used"
issued = 2026-11-01
travel_in = 2
points_mm_N = [
    [1, 2],
    [3, 4.5],
]
load-case = true
half-sine = ["15 g", "20 g"]
finish = '''
none'''

[[ropes]]
diameter = 0.01
strands = [6, 1]

[[ropes]]
diameter = 0.02
lay = "left"

[by_axis]
roll = { diameter = 0.03 }
"""


def test_a_table_becomes_its_class(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(RIGHT)
    part = structure(Part, read_toml(path, "part"), Place(path))
    assert part == Part(
        name="a", kind="used", issued="2026-11-01", travel=0.0508, points=((0.001, 2.0), (0.003, 4.5)), load_case=True,
        tests={"half-sine": ("15 g", "20 g")}, finish="none", by_axis={"roll": Rope(diameter=0.03)},
        ropes=(Rope(diameter=0.01, strands=(6, 1)), Rope(diameter=0.02, lay="left")),
    )  # fmt: skip
    assert type(structure(Rope, {"diameter": 1e-2}, Place("a")).diameter) is float


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("load-case = true", "load_case = true", "line 9: `load_case` is unknown; known: .*Did you mean `load-case`?"),
        (
            'lay = "left"',
            'lye = "left"',
            r"line 20: \[\[ropes\]\] 2 `lye` is unknown; known: diameter, lay, strands. Did you mean",
        ),
        ("diameter = 0.02", "", r"line 18: \[\[ropes\]\] 2 `diameter` is missing; needed: diameter\."),
        (
            "diameter = 0.02",
            "diameter = 20",
            r"line 19: .*`diameter` must be a finite number > 0 and <= 0\.1 \[m\], got 20\. If",
        ),
        ("diameter = 0.03", "diameter = inf", r"line 23: \[by_axis\.roll\] `diameter` must be a finite number"),
        ("[6, 1]", "[6,\n1.5]", r"line 16: \[\[ropes\]\] 1 `strands` must be a list of integers, got \[6, 1\.5\]"),
        ('"left"', '"up"', "line 20: .*`lay` must be one of 'left', 'right', got 'up'"),
        ("[3, 4.5]", "[3, 4.5, 6]", "line 5: `points_mm_N` must be a list of lists of 2 finite numbers, got"),
        ('name = "a"', "name = true", "line 1: `name` must be a text that is not empty, got True"),
        ('name = "a"', 'name = "none"', "line 1: `name` must name something"),
        ('kind = "used"', "", "a.toml: `kind` is missing; needed: name, kind, travel_mm"),
        ("travel_in = 2", "", "a.toml: `travel_mm` or `travel_in` is missing"),
        ("travel_in = 2", "travel_in = 2\ntravel_mm = 50", "line [45]: `travel` is stated twice"),
        ("travel_in = 2", "travel_in = 1_000_e", "line 4"),
        ("[[ropes]]\ndiameter = 0.01", "[ropes]\ndiameter = 0.01", None),
        ("2026-11-01", "1", "line 3: `issued` must be a text, got 1"),
        ('["15 g", "20 g"]', "15", "line 10: `half-sine` must be a text or a list of texts, got 15"),
        ("{ diameter = 0.03 }", "3", r"line 23: \[by_axis\] `roll` must be a table, got 3"),
    ],
)
def test_a_fault_is_named_with_line_key_and_remedy(tmp_path, old, new, message):
    path = tmp_path / "a.toml"
    path.write_text(RIGHT.replace(old, new, 1))
    with pytest.raises(ModelError, match=message) as caught:
        structure(Part, read_toml(path, "part"), Place(path))
    assert str(caught.value).startswith(str(path))


def test_the_error_is_that_of_the_place():
    with pytest.raises(RecordError, match=r"^row 3: it must be a table, got 3\.$"):
        structure(Rope, 3, Place("row 3", error=RecordError))
    with pytest.raises(ModelError, match="got '1000000000000000000"):
        structure(Rope, {"diameter": "1" + "0" * 400}, Place("a"))
    with pytest.raises(ModelError, match="`diameter` must be a finite number"):
        structure(Rope, {"diameter": 10**400}, Place("a"))


def test_numbers_of_numpy_are_numbers_and_others_are_refused():
    part = Part(name="a", travel=np.float32(0.5), points=np.ones((2, 2)), ropes=[Rope(diameter=np.float64(0.01))])
    assert (part.travel, part.points) == (0.5, ((1.0, 1.0), (1.0, 1.0)))
    assert type(part.travel) is float
    for wrong in (True, math.nan, "1", None, object()):
        with pytest.raises(ValueError, match="`travel` must be a finite number, got"):
            Part(name="a", travel=wrong)


def test_a_schema_says_what_the_class_says():
    described = schema(Part)
    assert described["required"] == ["name", "kind"]
    assert described["properties"]["travel_mm"]["description"] == "rated, of any direction"
    assert described["properties"]["ropes"]["items"]["properties"]["diameter"] == {
        "description": "of the rope", "type": "number", "exclusiveMinimum": 0.0, "maximum": 0.1, "unit": "m",
    }  # fmt: skip
    right = {"name": "a", "kind": "b", "travel_mm": 1, "half-sine": "x", "ropes": [{"diameter": 0.01}], "by_axis": {}}
    jsonschema.validate(right, described)
    for wrong in ({"travel_in": 2}, {"ropes": [{"diameter": 1}]}, {"nme": "a"}, {"half-sine": 3}, {"load-case": 1}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(right | wrong, described)


def test_date_is_text():
    assert (
        structure(Part, {"name": "a", "kind": "b", "travel_mm": 1, "issued": date(2026, 1, 2)}, Place("a")).issued
        == "2026-01-02"
    )
