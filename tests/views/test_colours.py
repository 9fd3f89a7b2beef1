"""The table of colours by meaning: read by everybody on both grounds, one meaning a colour, and the only source of colours."""

import ast
import itertools
import re
from pathlib import Path

import pytest

from wirerope_mj import views
from wirerope_mj.content.blocks import BASE, EXCEEDED, LIMIT, MEASURED, MODEL, MOUNTS, PAYLOADS
from wirerope_mj.content.selection import assigned
from wirerope_mj.views.colours import DARK, KINDS, LIGHT, RUNS, Colours, class_of, hexadecimal, style_sheet, used_colour

coloraide = pytest.importorskip("coloraide")
pytestmark = pytest.mark.quick

FILTERS = (None, "protan", "deutan", "tritan")
SCHEMES = pytest.mark.parametrize("scheme", [DARK, LIGHT], ids=["dark", "light"])
VIEWS = Path(views.__file__).parent


def color(rgb, kind=None):
    plain = coloraide.Color("srgb", [part / 255.0 for part in rgb])
    return plain.filter(kind) if kind else plain


def apart(one, other) -> float:
    """Return the least CIEDE2000 difference, for who sees all colours and for who lacks one kind of cones."""
    return min(color(one, kind).delta_e(color(other, kind), method="2000") for kind in FILTERS)


@SCHEMES
def test_texts_in_every_colour_can_be_read(scheme: Colours):
    # Lines without a name are no texts.
    curves = [scheme.of(kind) for kind in KINDS if scheme.of(kind) != scheme.faint]
    pairs = [(rgb, scheme.ground) for rgb in (*curves, scheme.others, scheme.heading, scheme.quiet, scheme.accent)]
    pairs += [(scheme.text, scheme.box), (scheme.within, scheme.ground), (scheme.text, scheme.within_box)]
    pairs += [(scheme.unjudged, scheme.ground), (scheme.unjudged, scheme.unjudged_box), (scheme.exceeded, scheme.exceeded_box)]
    for rgb, ground in pairs:
        assert color(rgb).contrast(color(ground), method="wcag21") >= 4.5, (rgb, ground)


@SCHEMES
def test_what_is_drawn_together_is_told_apart_whatever_cones_are_missing(scheme: Colours):
    together = [(*PAYLOADS, BASE, LIMIT, EXCEEDED), (*MOUNTS, LIMIT, EXCEEDED), (MODEL, MEASURED, EXCEEDED)]
    for group in together:
        for one, other in itertools.combinations(group, 2):
            assert apart(scheme.of(one), scheme.of(other)) >= 8.0, (one, other)
    for one, other in itertools.pairwise(scheme.compared):
        assert apart(one, other) >= 8.0, (one, other)
    # Of many the first three have names, with the limit and the grey of the others.
    for one, other in itertools.combinations((*scheme.compared[:3], scheme.limit, scheme.others), 2):
        assert apart(one, other) >= 8.0, (one, other)


@SCHEMES
def test_a_colour_of_a_run_means_one_thing(scheme: Colours):
    meanings = {kind: scheme.of(kind) for kind in (BASE, *PAYLOADS, *MOUNTS, MEASURED, EXCEEDED, LIMIT)}
    assert len(set(meanings.values())) == len(meanings)
    assert scheme.of(MODEL) == scheme.of(PAYLOADS[0])  # what is calculated of the payload
    for kind in KINDS:
        red, green, blue = scheme.of(kind)
        assert (red - max(green, blue) > 100) == (kind == EXCEEDED), kind


def test_runs_over_each_other_are_told_apart():
    for one, other in itertools.pairwise(RUNS):
        assert apart(one, other) >= 8.0, (one, other)


def test_a_name_has_one_kind_and_those_of_one_group_differ():
    kinds = assigned([["a", "b", "c"], ["c", "d", "a"], ["a", "e", "b"]], MOUNTS)
    assert [kinds[name] for name in "abc"] == list(MOUNTS)
    for group in ("abc", "cda", "aeb"):
        assert len({kinds[name] for name in group}) == 3


def test_utilisations_are_blue_up_to_their_limit_and_red_beyond():
    colours = [used_colour(value) for value in (0.0, 0.5, 1.0, 1.001, 7.0)]
    assert len(set(colours)) == 4
    assert colours[3] == colours[4] == hexadecimal(LIGHT.exceeded)


def test_a_page_has_the_colours_of_the_table_in_both_schemes():
    css = style_sheet()
    light, dark = css.split("@media screen and (prefers-color-scheme: dark)")
    for scheme, part in ((LIGHT, light), (DARK, dark)):
        assert all(f"--{name}: {colour};" in part for name, colour in scheme.named.items())
    assert all(f".chart .{class_of(kind)} {{ stroke: {hexadecimal(DARK.of(kind))}; }}" in dark for kind in KINDS)
    sheets = [VIEWS / "report" / "report.css", VIEWS / "report" / "blocks.css", VIEWS / "board" / "board.css"]
    used = re.findall(r"var\(--([a-z-]+)\)", "".join(sheet.read_text(encoding="utf-8") for sheet in sheets))
    assert set(used) <= {*LIGHT.named, "used", "scale"}


def test_every_renderer_takes_its_colours_from_the_table():
    """No colour stands anywhere else: neither as hexadecimal digits nor as three numbers from 0 to 255."""
    # The shared viewer's frame has a style sheet of its own.
    others = [path for path in VIEWS.rglob("*") if path.suffix in (".py", ".css", ".typ", ".jinja")]
    for path in others:
        if path.name == "colours.py" or "share" in path.parts:
            continue
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"#[0-9a-fA-F]{6}\b|#[0-9a-fA-F]{3}\b(?!.)", text), path
        if path.suffix == ".py":
            assert not list(_literal_colours(ast.parse(text))), path


def _literal_colours(tree: ast.AST):
    for node in ast.walk(tree):
        parts = [part.value for part in getattr(node, "elts", []) if isinstance(part, ast.Constant)]
        whole = isinstance(node, ast.Tuple) and len(node.elts) in (3, 4) and len(parts) == len(node.elts)
        if whole and all(type(part) is int and 0 <= part <= 255 for part in parts) and max(parts) > 20:
            yield ast.unparse(node)
