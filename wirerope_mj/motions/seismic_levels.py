"""Files of levels of earthquakes: the required spectra of AC156 and EN 1998-1 for the numbers of a site, three axes at once."""

from collections.abc import Callable

import numpy as np

from wirerope_mj.foundation.arguments import one_of
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.target_spectra import AC156_FREQUENCIES, EN1998_TYPE_1, LONGEST_PERIOD, ac156_spectrum, en1998_spectrum

HIGHEST = 50.0  # frequency [Hz] up to which the rigid plateau goes on, so that the motion holds it
PER_OCTAVE = 12  # points of a table where a spectrum is curved
# vertical over horizontal ground acceleration, and corner periods TB, TC, TD [s] of EN 1998-1, 3.2.2.3, type 1, from memory
VERTICAL, VERTICAL_CORNERS = 0.9, (0.05, 0.15, 1.0)
LEVELS = {"ac156": "ICC-ES AC156", "en1998": "EN 1998-1, type 1"}


def ac156_levels(*, sds: float, z_h: float) -> dict[str, str]:
    """Write the file of levels of AC156 and its two tables, by file name, for S_DS [g] and z/h."""
    frequencies = np.array([*AC156_FREQUENCIES, HIGHEST])
    spectra = [ac156_spectrum(frequencies, s_ds=sds, height_ratio=z_h, vertical=vertical) for vertical in (False, True)]
    (flexible, _, _, rigid), (vertical, _, _, vertical_rigid) = spectra
    formulas = f"""\
S_DS = {sds:g} g, z/h = {z_h:g}, 5 % damping; written from the formulas:
horizontal A_flx = S_DS (1 + 2 z/h) <= 1.6 S_DS = {flexible:.4g} g, A_rig = 0.4 S_DS (1 + 2 z/h) <= 1.2 S_DS = {rigid:.4g} g;
vertical 0.67 S_DS = {vertical:.4g} g and 0.27 S_DS = {vertical_rigid:.4g} g; from 1.3 to 8.3 Hz and from 33.3 Hz on.
30 s with 20 s of strong motion: check lengths against your edition."""
    return _files("ac156", formulas, "30 s", " rise 5 s fall 5 s", frequencies, spectra)


def en1998_levels(*, ag: float, ground: str) -> dict[str, str]:
    """Write the file of levels of EN 1998-1 and its two tables, by file name, for ag [g] and a type of ground."""
    one_of("ground", ground, tuple(EN1998_TYPE_1))
    lowest = 1.0 / LONGEST_PERIOD
    frequencies = np.geomspace(lowest, HIGHEST, int(np.ceil(PER_OCTAVE * np.log2(HIGHEST / lowest))) + 1)
    site = EN1998_TYPE_1[ground]
    horizontal = en1998_spectrum(frequencies, ground_acceleration=ag, **site)  # type: ignore[arg-type]
    vertical = en1998_spectrum(
        frequencies, ground_acceleration=VERTICAL * ag, soil_factor=1.0, corner_periods=VERTICAL_CORNERS, plateau=3.0
    )
    formulas = f"""\
ag = {ag:g} g, ground {ground}: S = {site["soil_factor"]:g}, TB, TC, TD = {site["corner_periods"]} s; 5 % damping:
horizontal plateau 2.5 ag S = {horizontal.max():.4g} g (3.2.2.2),
vertical 3 x {VERTICAL:g} ag = {vertical.max():.4g} g (3.2.2.3).
Of the ground: equipment in a building needs its floor's spectrum. A national annex may have other numbers."""
    return _files("en1998", formulas, "25 s", "", frequencies, [horizontal, vertical])


def _files(name: str, formulas: str, length: str, ramps: str, frequencies: Array, spectra: list[Array]) -> dict[str, str]:
    """Write the tables, and the motions along x, y and z, whose seeds make them independent."""
    lines = [f"# {line}" for line in (f"{LEVELS[name]}, required response spectra", *formulas.splitlines())]
    lines.append(f'standard = "{LEVELS[name]}"')
    for seed, (axis, kind) in enumerate((("x", "horizontal"), ("y", "horizontal"), ("z", "vertical")), start=1):
        phrase = f"{name}_{kind}.csv {length} {axis} damping 5 % seed {seed}{ramps}"
        lines.append(f'\n[[motion]]\nrequired-spectrum = "{phrase}"')
    tables = {
        f"{name}_{kind}.csv": "".join(
            ["frequency [Hz],acceleration [g]\n", *(f"{f:.6g},{a:.6g}\n" for f, a in zip(frequencies, levels, strict=True))]
        )
        for kind, levels in zip(("horizontal", "vertical"), spectra, strict=True)
    }
    return {f"{name}.toml": "\n".join(lines) + "\n", **tables}


WRITERS: dict[str, Callable[..., dict[str, str]]] = {"ac156": ac156_levels, "en1998": en1998_levels}
