"""The page of the gallery."""

from collections.abc import Sequence

from figures.figure import Figure

_HEAD = """\
# Gallery: chapter 3 of the thesis, and two questions of shock, computed with wirerope_mj

The figures of chapter 3 of W. Schwanen, *Modelling and identification of the dynamic behavior of a wire rope spring*, TU
Eindhoven DCT 2004/28, redrawn with this library. Below each stands what the thesis says with it, what our figure shows of
that, with numbers, and which parameters it was drawn with: the thesis' own where they are known, else ours.

`python docs/gallery/build.py` draws all of it again. The numbers in the text are computed, and the tests hold them against
closed forms and solutions by other means; they also fail where this page is no longer what the command writes.

x is the deflection, positive in tension; z the hysteretic force; α, β, γ and n are the parameters of the Bouc-Wen law (3.7),
`dz/dx = α − [γ + β sgn(dx/dt) sgn(z)] |z|ⁿ`. "Loading" moves away from zero force, "unloading" back to it. Loops are closed:
they are cycles that repeat themselves. The area of a loop is the energy dissipated in a cycle. Responses over frequency are
periodic motions found by shooting and followed over frequency, the largest absolute acceleration of the mass in each; thin
curves are sweeps as the thesis ran them, upwards by two octaves per minute from rest.

Behind them stand two figures of shock that the thesis has not: how near isolators come to what is possible at all, and what a
flexible frame below the isolator does, to which the thesis puts down what its shock simulations miss.
"""

_TAIL = """\
## Not here

- Figure 3.11 is a sketch of one mass on an isolator, without numbers.
"""

_CHAPTERS = {
    "3.2.1": "Static behaviour: β and γ (section 3.2.1)",
    "3.2.2": "Static behaviour: α and n (section 3.2.2)",
    "3.3.1": "Dynamic behaviour: β and γ (section 3.3.1)",
    "3.3.2": "Dynamic behaviour: α and n (section 3.3.2)",
    "3.4.1": "The modified law (section 3.4.1)",
    "3.4.2": "The modified law in dynamics (section 3.4.2)",
    "shock": "Shock",
}


def page(figures: Sequence[Figure]) -> str:
    """Return the text of the page in Markdown."""
    parts = [_HEAD]
    section = ""
    for figure in figures:
        if figure.section != section:
            section = figure.section
            parts.append(f"## {_CHAPTERS[section]}\n")
        parts.append(entry(figure))
    return "\n".join([*parts, _TAIL])


def entry(figure: Figure) -> str:
    """Return heading, picture and caption of one figure."""
    asked = "Asked" if figure.section == "shock" else f"The thesis, section {figure.section}"
    return (
        f"### Figure {figure.number}: {figure.title}\n\n"
        f"![Figure {figure.number}: {figure.title}]({figure.file})\n\n"
        f"**{asked}:** {figure.statement}\n\n"
        f"**Here:** {figure.shown}\n\n"
        f"**Drawn with:** {figure.parameters}\n"
    )
