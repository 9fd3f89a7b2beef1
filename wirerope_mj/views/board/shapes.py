"""Items of a board as SVG in its three views, in mm, with the words that stand beside them where there is room."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache

import numpy as np
from markupsafe import Markup, escape

from wirerope_mj.assessment.criteria.verdict import used_text
from wirerope_mj.foundation.arrays import Array, Entries

_VIEWS = {"plan": (0, 1), "elevation": (0, 2), "end": (1, 2)}  # axes to the right and up
_ORDER = ("deck", "envelope", "mass", "mount", "stop", "point", "centre")  # from behind
_RANKS = ("centre", "mount", "point", "stop", "mass", "envelope", "deck")  # of words, where there is little room
_LEAST = 50.0  # length that is fitted into a view, at least [mm]
_GROWS = (0.35, 0.65)  # share of the height that a view takes, at least and at most
# Of a mount in halves of its space across its bars, along them and along its axis; its edges in turn
_HEXAGON = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1], [-1, -1, 1]])
_ANGLES = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
_LOOP = np.stack([np.cos(_ANGLES), 0.0 * _ANGLES, np.sin(_ANGLES)], axis=1)
_BARS = np.array([[[0, -1, side], [0, 1, side]] for side in (-1, 1)])


def drawn(
    items: Sequence[Entries], *, movable: bool = True, names: Sequence[str] = (), by: Sequence[float] = (0, 0, 0)
) -> Entries:
    """Draw items into all views; those called `names` are being dragged: their positions contain the shift `by` [mm].

    Each has its `kind`, `label` and `position`; boxes their `size`; mounts `axial`, `bars`, `height`, `width` and what is
    `used`; centres their `mark`; and what can be selected a `name`, and `movable`.
    """
    items = [{**item, "words": _words(item)} for item in items]
    solid = [item for item in items if item["kind"] not in ("deck", "centre")]
    halves = [0.5 * np.array(item.get("size") or [item.get("height") or 0.0] * 3) for item in solid]
    ends = np.array([np.add(item["position"], [-half, half]) for item, half in zip(solid, halves, strict=True)]).reshape(-1, 3)
    low, high = (ends.min(axis=0), ends.max(axis=0)) if len(ends) else (np.full(3, -500.0), np.full(3, 500.0))
    lengths = np.maximum(high - low, _LEAST)
    views = {}
    for name, axes in _VIEWS.items():
        shown = sorted(items, key=lambda item: (_ORDER.index(item["kind"]), item.get("used") or 0.0))
        centres = {item["mark"]: _seen(item["position"], axes) for item in items if item["kind"] == "centre"}
        grows = float(np.clip(lengths[axes[1]] / (lengths[1] + lengths[2]), *_GROWS))
        views[name] = {
            "shapes": Markup("").join(_group(item, axes, centres) for item in shown),
            "labels": [*_labels(shown, centres)], "size": lengths[[*axes]].tolist(), "grows": grows,
        }  # fmt: skip
    middle = (0.5 * (low + high)).tolist()
    return {"items": items, "movable": movable, "names": [*names], "by": [*by], "middle": middle, "views": views}


def _group(item: Entries, axes: tuple[int, int], centres: Mapping[str, Array]) -> Markup:
    movable = item.get("movable", bool(item.get("name")))
    kinds = [item["kind"], item.get("tone"), not movable and "still", item.get("collides") and "collides"]
    name = Markup(' data-name="{}"').format(item["name"]) if movable else ""
    around = Markup('<g class="{0}"{1} role="img" aria-label="{2}"><title>{2}</title>{3}</g>')
    shape = _box if "size" in item else _mount if item["kind"] == "mount" else _mark
    return around.format(" ".join(filter(None, kinds)), name, item["words"], shape(item, axes, centres))


def _box(item: Entries, axes: tuple[int, int], centres: Mapping[str, Array]) -> Markup:
    half = 0.5 * np.array(item["size"])[[*axes]]
    corners = _seen(item["position"], axes) + half * [[-1, -1], [1, -1], [1, 1], [-1, 1]]
    return _path([corners], "shape", Markup(' fill="url(#hatch)"') if item["kind"] == "deck" and axes[1] == 2 else Markup(""))


def _mount(item: Entries, axes: tuple[int, int], centres: Mapping[str, Array]) -> Markup:
    sizes = item.get("width") or 0.0, item.get("length") or item.get("width") or 0.0, item.get("height") or 0.0
    x, y = _seen(item["position"], axes)
    device = _device(tuple(item["axial"]), tuple(item["bars"]), sizes, axes)
    return Markup(f'<g transform="translate({x:.1f} {y:.1f})">{device}</g>')


@lru_cache(maxsize=1024)
def _device(axial: tuple[float, ...], bars: tuple[float, ...], sizes: tuple[float, ...], axes: tuple[int, int]) -> Markup:
    """Draw a mount about its middle: its space, a loop of its rope, its two bars; sizes across bars, along them, axial [mm]."""
    edges = np.array([np.cross(bars, axial), bars, axial]) * np.array(sizes)[:, None]
    halves = np.array([0.5 * _seen(edge, axes) for edge in edges])
    halves_up = [-half if tuple(half[::-1]) < (0.0, 0.0) else half for half in halves]
    turning = np.array(sorted(halves_up, key=lambda half: math.atan2(half[1], half[0])))
    return _path([_HEXAGON @ turning], "shape") + _path([_LOOP @ halves], "rope") + _path(_BARS @ halves, "bar")


def _mark(item: Entries, axes: tuple[int, int], centres: Mapping[str, Array]) -> Markup:
    """Draw a stop, a point or a centre with its mark, which the page has in pixels, and lines between centres."""
    mark = item.get("mark", item["kind"])
    x, y = _seen(item["position"], axes)
    between = _path([[*centres.values()]], "between") if mark == "mass" and len(centres) > 1 else Markup("")
    return between + Markup('<use href="#mark-{}" class="shape" style="translate:{:.1f}px {:.1f}px"/>').format(mark, x, y)


def _labels(shown: Sequence[Entries], centres: Mapping[str, Array]) -> Iterator[Entries]:
    """Yield labels of items as HTML, in forms from long to short, the most important first, with the item's index `of`."""
    for of in sorted(range(len(shown)), key=lambda of: (_RANKS.index(shown[of]["kind"]), -of)):
        item, label = shown[of], str(escape(shown[of]["label"]))
        if item["kind"] == "mount":
            choices = [f"{label} {_percent(item)}".strip(), label]
            yield {"of": of, "choices": choices, "kind": item.get("tone", "")}
        elif item["kind"] != "centre":
            yield {"of": of, "choices": [label], "kind": "quiet", "inside": "size" in item}
        elif item["mark"] == "mass" and len(centres) > 1 and (apart := _length(math.dist(*centres.values()))) != "0":
            length = f"{apart} mm"
            choices = [f"stiffness off the centre of mass by {length}", f"off by {length}", length]
            yield {"of": of, "choices": choices, "kind": "distance"}


def _words(item: Entries) -> str:
    """Describe an item: kind, label, part, position [mm], and utilisation."""
    place = " ".join(f"{axis} {_length(value)}" for axis, value in zip("xyz", item["position"], strict=True))
    used = _percent(item) and f"{_percent(item)} used"
    return ", ".join(filter(None, [f"{item['kind']} {item['label']}", item.get("part"), f"{place} mm", used]))


def _percent(item: Entries) -> str:
    return "" if item.get("used") is None else used_text(item["used"])


def _length(value: float) -> str:
    return f"{round(value, 1) + 0.0:.9g}".replace("-", "\N{MINUS SIGN}")


def _seen(vector: Sequence[float] | Array, axes: tuple[int, int]) -> Array:
    """Return the components of a vector in a view, to the right and down, as SVG has them, (2,)."""
    return np.array([vector[axes[0]], -vector[axes[1]]])


def _path(lines: Iterable[Iterable[Array]], kind: str, more: Markup = Markup("")) -> Markup:  # noqa: B008  # no list
    """Draw closed lines through points."""
    d = "".join("M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + "Z" for points in lines)
    return Markup(f'<path class="{kind}" d="{d}"{more}/>')
