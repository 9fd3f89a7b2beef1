"""Mass properties as SolidWorks prints them, made of bodies with known tensors: languages, units, notations, parts."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.from_tables.layout import MassProperties, combine
from wirerope_mj.engine.from_tables.mass_text import read_mass_text
from wirerope_mj.engine.from_tables.read import read_masses
from wirerope_mj.foundation.errors import RecordError, RecordWarning

pytestmark = pytest.mark.quick

WORDS = {
    "en": ("Mass properties of {}", "Mass", "Center of mass", "Moments of inertia", "Principal axes of inertia",
           "Taken at the center of mass and aligned with the output coordinate system.",
           "Taken at the output coordinate system.", "Coordinate system"),
    "de": ("Masseneigenschaften von {}", "Masse", "Massenmittelpunkt", "Tr\u00e4gheitsmomente", "Haupttr\u00e4gheitsachsen",
           "Bezogen auf den Massenmittelpunkt, ausgerichtet auf das Ausgabekoordinatensystem.",
           "Bezogen auf das Ausgabekoordinatensystem.", "Koordinatensystem"),
    "fr": ("Propri\u00e9t\u00e9s de masse de {}", "Masse", "Centre de gravit\u00e9", "Moments d'inertie", "Axes principaux",
           "Pris au centre de gravit\u00e9 et align\u00e9s sur le syst\u00e8me de coordonn\u00e9es de sortie.",
           "Pris au syst\u00e8me de coordonn\u00e9es de sortie.", "Syst\u00e8me de coordonn\u00e9es"),
    "it": ("Propriet\u00e0 di massa di {}", "Massa", "Centro di massa", "Momenti d'inerzia", "Assi principali",
           "Calcolati nel centro di massa e allineati con il sistema di coordinate di output.",
           "Calcolati nel sistema di coordinate di output.", "Sistema di coordinate"),
    "es": ("Propiedades de masa de {}", "Masa", "Centro de masa", "Momentos de inercia", "Ejes principales",
           "Medido en el centro de masa y alineado con el sistema de coordenadas de salida.",
           "Medido desde el sistema de coordenadas de salida.", "Sistema de coordenadas"),
}  # fmt: skip
UNITS = {
    "grams": ("grams", 1e-3, "millimeters", 1e-3, "grams *  square millimeters"),
    "kg m": ("kilograms", 1.0, "meters", 1.0, "kilograms * square meters"),
    "lb in": ("pounds", 0.45359237, "inches", 0.0254, "pounds * square inches"),
    "lb ft": ("pounds", 0.45359237, "feet", 0.3048, "pounds * square feet"),
    "Gramm": ("Gramm", 1e-3, "Millimeter", 1e-3, "Gramm * QuadratMillimeter"),
    "Kilogramm": ("Kilogramm", 1.0, "Zentimeter", 1e-2, "Kilogramm * Quadratzentimeter"),
    "grammes": ("grammes", 1e-3, "millim\u00e8tres", 1e-3, "grammes * millim\u00e8tres carr\u00e9s"),
    "grammi": ("grammi", 1e-3, "millimetri", 1e-3, "grammi * millimetri quadrati"),
    "gramos": ("gramos", 1e-3, "mil\u00edmetros", 1e-3, "gramos * mil\u00edmetros cuadrados"),
    "tonnes": ("tonnes", 1e3, "mm", 1e-3, "tonnes * mm^2"),
}  # fmt: skip
NOTES = {"positive": "(Using positive tensor notation.)", "tensor": "(Using negative tensor notation.)", "": ""}


def body(mass, centre, turned=0.4):
    """Return a box that is turned about two axes, so that all its products of inertia differ."""
    c, s = np.cos(turned), np.sin(turned)
    axes = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])
    return MassProperties(mass, np.array(centre), axes.T @ np.diag(mass * np.array([0.02, 0.06, 0.07])) @ axes)


def printed(
    part, name="a", *, language="en", units="grams", notation="positive", stated="positive", blocks="lip",
    system="-- default --", digits=2, comma=False,
):  # fmt: skip
    """Return the text of a part, its products in a notation and perhaps another stated; `blocks`: which tensors it has."""
    heading, mass, centre, moments, principal, central, outer, coordinates = WORDS[language]
    kilogram, kg, metre, m, square = UNITS[units]
    shift = part.mass * (part.centre @ part.centre * np.eye(3) - np.outer(part.centre, part.centre))
    signs = np.where(np.eye(3), 1.0, -1.0 if notation == "positive" else 1.0)
    lines = [heading.format(name), f"     {coordinates}: {system}", "", f"{mass} = {part.mass / kg:.{digits}f} {kilogram}", ""]
    lines += [
        f"{centre}: ( {metre} )",
        *(f"\t{axis} = {x / m:.{digits}f}" for axis, x in zip("XYZ", part.centre, strict=True)),
        "",
    ]
    values, axes = np.linalg.eigh(part.inertia / (kg * m**2))
    if "p" in blocks:
        lines += [f"{principal}: ( {square} )"]
        rows = zip("xyz", axes.T, values, strict=True)
        lines += [f"\t I{k} = ({x:5.2f}, {y:5.2f}, {z:5.2f})   \tP{k} = {p:.{digits}f}" for k, (x, y, z), p in rows]
    for letter, text, tensor in (("L", central, part.inertia), ("I", outer, part.inertia + shift)):
        if letter.lower() in blocks:
            shown = signs * tensor / (kg * m**2)
            lines += ["", f"{moments}: ( {square} )", f"{text} {NOTES[stated]}"]
            for i, row in enumerate("xyz"):
                lines += ["\t".join(f"\t{letter}{row}{c} = {shown[i, j]:.{digits}f}" for j, c in enumerate("xyz"))]
    text = "\n".join(lines) + "\n\n"
    return text.replace(".", ",").replace("),", ").") if comma else text


PART = body(30.0, [0.1, -0.2, 0.35])


def read(text, **options):
    Path("part.txt").write_text(text, encoding="utf-8")
    return read_mass_text(Path("part.txt"), **options)


def same(found, part, rtol=1e-4):
    """Hold a part against another: the printed digits are those of a gram, a hundredth of a millimetre."""
    assert found.mass == pytest.approx(part.mass, rel=rtol)
    np.testing.assert_allclose(found.centre, part.centre, atol=1e-4)
    np.testing.assert_allclose(found.inertia, part.inertia, atol=rtol * part.inertia.trace())


@pytest.mark.parametrize(("language", "units"), [
    ("en", "grams"), ("en", "kg m"), ("en", "lb in"), ("en", "lb ft"), ("en", "tonnes"), ("de", "Gramm"), ("de", "Kilogramm"),
    ("fr", "grammes"), ("it", "grammi"), ("es", "gramos"),
])  # fmt: skip
@pytest.mark.parametrize("comma", [False, True])
def test_a_part_is_the_same_in_every_language_and_unit(language, units, comma, here):
    ((_, found),) = read(printed(PART, language=language, units=units, digits=8, comma=comma))
    same(found, PART)


@pytest.mark.parametrize("notation", ["positive", "tensor"])
@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("blocks", ["l", "li", "lp", "lip", "i", "ip", "p"])
def test_the_sign_of_products_is_what_the_text_says_or_shows(notation, stated, blocks, here):
    text = printed(PART, notation=notation, stated=notation if stated else "", blocks=blocks, digits=6)
    # of Ixx to Izz at the origin the other sign makes a tensor that no body has
    shown = stated or blocks != "l"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ((_, found),) = read(text)
    assert bool(caught) == (not shown)
    assert all("does not say the sign of its products" in str(one.message) for one in caught)
    # axes of two digits leave a few per cent of the moments' range
    if shown or notation == "positive":
        same(found, PART, rtol=0.01 if blocks == "p" else 1e-4)
    if not shown:
        ((_, found),) = read(text, products=notation)
        same(found, PART)


@pytest.mark.parametrize("change", [
    {"notation": "positive", "stated": "tensor"}, {"notation": "tensor", "stated": "positive"},
])  # fmt: skip
def test_words_against_figures_are_refused_and_so_is_an_option_against_either(change, here):
    with pytest.raises(RecordError, match="the notation of products of inertia is .* by its figures"):
        read(printed(PART, **change))
    with pytest.raises(RecordError, match="tensor by --products"):
        read(printed(PART), products="tensor")


def test_several_parts_are_added_up_where_they_stand(here):
    parts = [body(30.0, [0.1, -0.2, 0.35]), body(20.0, [-0.3, 0.1, 0.05], 0.9), body(7.5, [0.0, 0.0, 0.8], 1.3)]
    text = "".join(printed(part, name, digits=6) for part, name in zip(parts, ("Rahmen \u00fc", "pump 2", "b"), strict=True))
    found = read(text)
    assert [name for name, _ in found] == ["Rahmen \u00fc", "pump 2", "b"]
    for (_, one), part in zip(found, parts, strict=True):
        same(one, part)
    same(combine([one for _, one in found]), combine(parts))
    with pytest.raises(RecordError, match="in several coordinate systems, -- default --, cs2"):
        read(printed(parts[0]) + printed(parts[1], "b", system="CS2"))
    Path("all.txt").write_text(text + printed(combine(parts), "cabinet"), encoding="utf-8")
    with pytest.warns(RecordWarning, match="weighs what all others weigh together"):
        read_masses(Path("all.txt"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("30000.00 grams", "30,000.00 grams", "a comma: of thousands, or of decimals"),
        ("30000.00 grams", "30000.00 stones", 'the unit "stones" is unknown'),
        ("Mass = 30000.00 grams", "MASS: 30 kg", "the mass is not found"),
        ("X = 100.00", "X = 900.00", "are they of one part, in one coordinate system"),
        ("Mass = 30000.00", "Mass = 60000.00", "are they of one part, in one coordinate system"),
        (
            "the center of mass and aligned with the output coordinate system.",
            "the centroid.",
            "the text says 'taken at the centroid",
        ),
        ("aligned with the output coordinate system", "aligned with the principal axes", "and aligned with that"),
        ("Center of mass:", "Centroid", "the centre of mass is not found"),
    ],
)
def test_what_a_text_gets_wrong_is_named(old, new, message, here):
    text = printed(PART)
    assert old in text
    blocks = "li" if "coordinate system?" not in message else "lip"
    with pytest.raises(RecordError, match=message):
        read(printed(PART, blocks=blocks).replace(old, new) if "Taken" not in old else text.replace(old, new))


@pytest.mark.parametrize(("text", "program"), [
    ("MASS = 1.0e-02 TONNE\nCENTER OF GRAVITY with respect to _A coordinate frame:\nX Y Z 1 2 3 MM\n", "Creo"),
    ("Physical Properties for a\nMass: 12.3 kg\nMass Moments of Inertia with respect to Center of Gravity(Calculated using "
     "negative integral)\n", "Inventor"),
    ("Mass = 30 kg\nIoxG = 3 kgxm2\n", "CATIA"), ("Mass = 12 kg\nProducts of Inertia (Centroidal)\n", "NX"),
])  # fmt: skip
def test_texts_of_other_programs_are_named(text, program, here):
    with pytest.raises(RecordError, match=f"this is a text of {program}, which is not read"):
        read(text)


ROWS = "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]\n"
PARTS = "pump, 400, -300, 0, 450, 500, 400, 600\nframe, 200, 0, 0, 120, 900, 600, 100\n"


@pytest.mark.parametrize("name", [
    "Total", "TOTAL:", "Sum", "Summe", "Gesamt", "Gesamtmasse", "total mass (kg)", "Grand total", "\u03a3", "\u2211",
    "Totale", "Somme", "Zwischensumme", "Sub-total", "Sum of all masses", "Gesamtgewicht", "Total weight",
])  # fmt: skip
@pytest.mark.parametrize("rest", ["600, , , , , , ", "600.4, -200, 0, 340, 0, 0, 0", ", , , , , , "])
def test_a_row_of_totals_is_no_mass(name, rest, here):
    Path("masses.csv").write_text(f"{ROWS}{PARTS}{name}, {rest}\n", encoding="utf-8")
    with pytest.warns(RecordWarning, match="adds up other rows and is left out"):
        masses = read_masses(Path("masses.csv"))
    assert [mass.name for mass in masses] == ["pump", "frame"]


def test_subtotals_and_a_total_of_everything_are_left_out(here):
    text = f"{ROWS}{PARTS}Subtotal, 600, , , , , , \nmotor, 50, 0, 0, 900, 200, 200, 300\nfan, 25, 0, 0, 990, 200, 200, 300\n"
    Path("masses.csv").write_text(f"{text}Subtotal 2, 75, , , , , , \nTotal, 675, , , , , , \n".replace("Subtotal 2", "Summe"))
    with pytest.warns(RecordWarning):
        assert sum(mass.properties.mass for mass in read_masses(Path("masses.csv"))) == 675.0


def test_a_total_that_adds_up_to_something_else_is_refused_and_a_sum_by_another_name_is_said(here):
    Path("masses.csv").write_text(f"{ROWS}{PARTS}Total, 610, 0, 0, 300, 900, 600, 700\n")
    with pytest.raises(RecordError, match=r'"Total" is 610 kg, and the other rows add up to 600 kg'):
        read_masses(Path("masses.csv"))
    Path("masses.csv").write_text(f"{ROWS}{PARTS}cabinet, 600, 0, 0, 300, 900, 600, 700\n")
    with pytest.warns(RecordWarning, match='"cabinet" weighs what all others weigh together, 600 kg'):
        assert len(read_masses(Path("masses.csv"))) == 3


def test_two_parts_of_30_and_20_kg_make_a_payload_of_50(here):
    (here / "parts.txt").write_text(
        printed(body(30.0, [0, 0, 0.05])) + printed(body(20.0, [0.1, 0, 0.0]), "b"), encoding="utf-16"
    )
    places = "".join(f"m{i}{j}, {200 * i}, {200 * j}, -100, enidine_wr16_400\n" for i in (-1, 1) for j in (-1, 1))
    (here / "mounts.csv").write_text(f"name, x [mm], y [mm], z [mm], isolator\n{places}")
    main(["new", "cabinet", "--mounts", "mounts.csv", "--masses", "parts.txt"])
    assert wr.load_system("cabinet/cabinet.xml").model.body("cabinet").mass[0] == pytest.approx(
        50.0, rel=1e-6
    )  # printed digits
