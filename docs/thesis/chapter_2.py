"""Chapter 2: the laws of the review on one record, memory and interior loops, and coefficients over amplitude."""

from collections.abc import Callable
from functools import cache
from io import BytesIO

import numpy as np
import numpy.typing as npt
from figures.drawing import BLUES, COLOURS, GUIDE, INK, canvas, explain, inscribe
from matplotlib.figure import Figure as Picture
from PIL import Image

import wirerope_mj as wr
from docs.thesis import FOLDER
from docs.thesis.rope import AMPLITUDES, MM, G, record, spring
from wirerope_mj.mounts.estimate import estimate_loop

Array = npt.NDArray[np.float64]
LAWS = {
    "tno": wr.EnhancedDryFriction, "bouc_wen": wr.BoucWen, "masing": wr.Masing, "vaiana": wr.VaianaRosati,
    "symmetric": wr.SymmetricBoucWen, "asymmetric": wr.AsymmetricBoucWen,
}  # fmt: skip
LABELS = {
    "tno": "TNO", "bouc_wen": "Bouc-Wen", "masing": "Masing", "vaiana": "Vaiana-Rosati", "symmetric": "Ni, symmetric",
    "asymmetric": "Ni, asymmetric",
}  # fmt: skip
TURNS = (0.0, 10.0, -10.0, 6.0, -2.0, 4.0, -6.0, 3.0, -10.0)  # [mm]
FRAMES = 40
POLYCAL = ((9.5, 109.0, 102.0), (11.0, 111.0, 104.0), (12.7, 113.0, 106.0))
"""Rope, height and width [mm] of four arcs of 46.5 mm about their centre lines."""


@cache
def fits() -> dict[str, wr.Identification]:
    """Return the fit of every law to the record."""
    more = {"masing": {"elements": 4}}
    return {name: wr.identify(record(spring()), law=law, profiles=False, **more.get(name, {})) for name, law in LAWS.items()}


def tinker_cutchins() -> tuple[Array, float]:
    """Return k1, k2, k3, f0, f1, f2 of Tinker and Cutchins' springs and friction by least squares, and the error [-].

    Without its damper: a slow test has none.
    """
    rows, values = [], []
    for loop in record(spring()):
        x, force = loop.deflection[:-1], loop.force[:-1]
        sign = np.sign(np.roll(x, -1) - np.roll(x, 1))
        terms = np.stack([x, x**2, x**3, sign, sign * np.abs(x), sign * x**2], axis=1)
        scale = 0.5 * np.ptp(force) * np.sqrt(x.size)
        rows.append((terms - terms.mean(axis=0)) / scale)
        values.append((force - force.mean()) / scale)
    matrix, right = np.concatenate(rows), np.concatenate(values)
    best = np.linalg.lstsq(matrix / np.abs(matrix).max(axis=0), right, rcond=None)[0] / np.abs(matrix).max(axis=0)
    return best, float(np.sqrt(np.sum((matrix @ best - right) ** 2) / len(rows)))


def ko(loop: wr.Loop) -> tuple[Array, Array, float]:
    """Return Ko's decomposition of a loop: deflections, mid-line [N], half height of the ellipse of its area [N]."""
    (x_up, up), (x_down, down) = loop.branch(rising=True), loop.branch(rising=False)
    x = np.linspace(-0.999, 0.999, 101) * loop.amplitude
    middle = 0.5 * (np.interp(x, *_ascending(x_up, up)) + np.interp(x, *_ascending(x_down, down)))
    return x, middle, loop.dissipated_energy / (np.pi * loop.amplitude)


def _ascending(x: Array, force: Array) -> tuple[Array, Array]:
    order = np.argsort(x)
    return x[order], force[order]


def numbers() -> dict[str, float]:
    """Return errors of all laws, what is estimated of a polycal, Ko's coefficients over amplitude, TNO's two fits."""
    found: dict[str, float] = {}
    for name, fit in fits().items():
        found |= {
            f"{name}_error": 100.0 * fit.residual,
            f"{name}_free": float(sum(not p.fixed for p in fit.parameters.values())),
        }
        found |= {f"{name}_first": 100.0 * float(fit.residuals[0]), f"{name}_last": 100.0 * float(fit.residuals[-1])}
    (_, _, _, f0, f1, f2), left = tinker_cutchins()
    found |= {"f0": float(f0), "f1": float(f1) / 1e3, "f2": float(f2) / 1e6, "tinker_error": 100.0 * left}
    for place, (rope, height, width) in enumerate(POLYCAL, 1):
        part = estimate_loop(rope=rope / MM, height=height / MM, width=width / MM, loops=2)  # two arcs are one loop
        values = part.values
        found |= {
            f"rope{place}": rope, f"height{place}": height, f"width{place}": width,
            f"carries{place}": values.static_load / G, f"travel{place}": MM * values.travel["compression"],
            f"small{place}": values.vibration["compression"] / 1e3, f"large{place}": values.shock["compression"] / 1e3,
            f"across{place}": values.shock["shear"] / 1e3,
            f"band{place}": 1.0 + part.bands["compression shock"].within,
            f"other{place}": 1.0 + (part.bands["compression shock"].other or 0.0),
        }  # fmt: skip
    loops = wr.cyclic_test(spring(), AMPLITUDES)
    for place, loop in enumerate(loops, 1):
        found |= {f"k{place}": loop.secant_stiffness / 1e3, f"w{place}": 1e3 * loop.dissipated_energy}
        found[f"c{place}"] = loop.dissipated_energy / (np.pi * 2.0 * np.pi * loop.amplitude**2)
    found["own"] = spring().initial_stiffness / 1e3
    found["stiffer"] = found["own"] / found["small2"]
    for place in range(1, len(loops)):
        growth = np.log(loops[place].dissipated_energy / loops[place - 1].dissipated_energy)
        found[f"p{place}"] = growth / np.log(AMPLITUDES[place] / AMPLITUDES[place - 1])
    for name, chosen in (("static", record(spring())[-1:]), ("small", record(spring())[:1])):
        law = wr.identify(chosen, law=wr.EnhancedDryFriction, profiles=False).law
        found |= {f"{name}_k": law.k / 1e3, f"{name}_d": law.d, f"{name}_u": MM * law.u_c}
    return found


def path() -> Array:
    """Return deflections between the turning points [m]."""
    return np.concatenate([np.linspace(a, b, 60) for a, b in zip(TURNS, TURNS[1:], strict=False)]) / MM


def pictures() -> dict[str, Callable[[], Picture]]:
    """Return what draws the fits, and Ko's decomposition; the moving picture is written beside them."""
    animate()
    return {"chapter_2_laws": _draw_laws, "chapter_2_ko": _draw_ko}


def animate() -> None:
    """Write the moving picture of a path with interior loops: two forces at one deflection."""
    x = path()
    force, frames = spring().trace(x).force / 1e3, []
    for end in np.linspace(20, x.size, FRAMES).astype(int):
        picture, (panel,) = canvas(1, height=3.4)
        picture.set_size_inches(4.6, 3.2)
        picture.set_dpi(100)
        panel.plot(MM * x[:end], force[:end], color=COLOURS[0], lw=1.4)
        panel.plot(MM * x[end - 1], force[end - 1], "o", color=COLOURS[1], ms=6)
        panel.set_xlim(-11.0, 11.0)
        panel.set_ylim(1.1 * force.min(), 1.1 * force.max())
        inscribe(panel, "one path, interior loops", "deflection [mm]", "force [kN]")
        drawn = BytesIO()
        picture.savefig(drawn, format="png")
        frames.append(Image.open(drawn).convert("RGB").quantize(16, dither=Image.Dither.NONE))
    frames[0].save(
        FOLDER / "chapter_2_memory.gif", save_all=True, append_images=frames[1:], duration=120, loop=0, optimize=True
    )


def _draw_laws() -> Picture:
    picture, panels = canvas(2, height=4.2)
    for panel, loop in zip(panels, (record(spring())[-2], record(spring())[0]), strict=True):
        panel.plot(MM * loop.deflection, loop.force, color=GUIDE, lw=3.5, label="record")
        walk = np.concatenate([loop.deflection[:-1], loop.deflection[:-1], loop.deflection])
        for (name, fit), colour in zip(fits().items(), (*COLOURS, INK), strict=False):
            force = fit.law.trace(walk).force[-loop.deflection.size :]
            shift = loop.force[:-1].mean() - force[:-1].mean()
            panel.plot(MM * loop.deflection, force + shift, color=colour, lw=1.2, label=LABELS[name])
        inscribe(panel, f"±{MM * loop.amplitude:.2g} mm", "deflection [mm]", "force [N]")
    explain(panels[0])
    return picture


def _draw_ko() -> Picture:
    picture, (loops, ellipses) = canvas(2, height=3.7)
    chosen = wr.cyclic_test(spring(), AMPLITUDES[2:])
    for loop, colour in zip(reversed(chosen), reversed(BLUES), strict=True):
        x, middle, height = ko(loop)
        loops.plot(MM * loop.deflection, loop.force, color=colour, lw=0.9)
        loops.plot(MM * x, middle, "--", color=colour, lw=1.8)
        angle = np.linspace(0.0, 2.0 * np.pi, 200)
        label = f"±{MM * loop.amplitude:g} mm"
        ellipses.plot(MM * loop.amplitude * np.cos(angle), height * np.sin(angle), color=colour, lw=1.6, label=label)
    inscribe(loops, "loops, and their mid-lines dashed", "deflection [mm]", "force [N]")
    inscribe(ellipses, "ellipses of the same area", "deflection [mm]", "force [N]")
    explain(ellipses, place="below", columns=4)
    return picture
