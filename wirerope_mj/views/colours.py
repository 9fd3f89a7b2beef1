"""The one table of colours: of series, limits and what stands behind, on a dark and on a light ground.

Texts in these colours have a contrast of 4.5 at least. Neighbours in the order of the table are 8 dE (CIEDE2000) apart for who
sees all colours and for who lacks one kind of cones. Red is for limits alone.
"""

from dataclasses import dataclass

from wirerope_mj.content.selection import Selection

Color = tuple[int, int, int]


@dataclass(frozen=True, kw_only=True)
class Colours:
    """Colours on one ground.

    Attributes:
        ground: on which they are read.
        series: of lines that are told apart, the most important first: blue, orange, violet, teal, pink, green.
        limit: of what must not be exceeded, and of what exceeds it.
        base: of the base, which everything is compared with.
        others: of lines that are not named.
    """

    ground: Color
    series: tuple[Color, ...]
    limit: Color
    base: Color
    others: Color


DARK = Colours(
    ground=(24, 27, 31),
    series=((63, 167, 245), (254, 182, 74), (165, 128, 186), (122, 236, 228), (214, 155, 206), (124, 188, 141)),
    limit=(255, 90, 90),
    base=(150, 156, 164),
    others=(138, 144, 153),
)
LIGHT = Colours(
    ground=(255, 255, 255),
    series=((18, 100, 200), (176, 90, 0), (74, 20, 134), (10, 125, 110), (176, 48, 144), (77, 92, 0)),
    limit=(210, 0, 80),
    base=(64, 68, 74),
    others=(112, 117, 124),
)


def colour_of(selection: Selection, name: str, ground: Colours = DARK) -> Color:
    """Return the colour of a mount, a body or a point: grey if it is not among those that are named."""
    if selection.run_color is not None and ground is DARK:
        return selection.run_color
    return ground.series[selection.numbers[name]] if name in selection.numbers else ground.others
