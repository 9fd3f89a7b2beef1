"""Racks on wire-rope isolators that a vendor's program has computed: translations only, and what is compared of them."""

from dataclasses import dataclass

import numpy as np

import wirerope_mj as wr
from wirerope_mj.dynamics.single_mass.equivalent import oscillator_at

G = wr.STANDARD_GRAVITY
VELOCITY = 20.0 * G * 11e-3 / 2.0  # [m/s], of the terminal-peak sawtooth of 20 g and 11 ms


@dataclass(frozen=True)
class Rack:
    """A rack on mounts below and stabilisers behind, upright whatever happens."""

    isolator: wr.Isolator
    mass: float
    below: int
    behind: int

    @property
    def system(self):
        """Positions do not matter to translations: all mounts stand in the same place."""
        turned = 'xyaxes="0 0 1 0 -1 0"'  # roll upright, axis along x
        mounts = {f"m{i}": "" for i in range(self.below)} | {f"s{i}": turned for i in range(self.behind)}
        slides = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
        joints = {
            body: "".join(f'<joint name="{body}_{n}" type="slide" axis="{a}"/>' for n, a in slides.items())
            for body in ("deck", "rack")
        }
        sites = {body: "".join(f'<site name="{body}/{n}" {a}/>' for n, a in mounts.items()) for body in ("deck", "rack")}
        tuples = "".join(
            f'<tuple name="mount/{name}"><element objtype="site" objname="rack/{name}"/><element objtype="site" '
            f'objname="deck/{name}"/><element objtype="text" objname="isolator/a"/></tuple>'
            for name in mounts
        )
        text = f"""<mujoco><option gravity="0 0 {-G}"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
            <body name="deck">{joints["deck"]}<geom size=".1" mass="5"/>{sites["deck"]}</body>
            <body name="rack">{joints["rack"]}<geom size=".1" mass="{self.mass}"/>{sites["rack"]}</body></worldbody>
            <custom><text name="isolator/a" data="a.toml"/>{tuples}</custom></mujoco>"""
        return wr.load_system(text, isolators={"a": self.isolator})

    def frequencies(self, amplitude, stiffness):
        """Return the frequencies of translations along x, y, z [Hz] by one of the stiffnesses of steady cycles."""
        axial, shear, roll = (
            getattr(oscillator_at(law, amplitude, frequency=10.0), stiffness)
            for law in (self.isolator.axial, self.isolator.shear, self.isolator.roll)
        )
        along = [
            self.below * roll + self.behind * axial,
            (self.below + self.behind) * shear,
            self.below * axial + self.behind * roll,
        ]
        return np.sqrt(np.array(along) / self.mass) / (2.0 * np.pi)


def modes_along(found):
    """Return the frequencies of translations along x, y and z [Hz]."""
    return found.frequencies[found.participation.argmax(axis=0)]


def sag(system):
    """Return the sag of the mounts below on the first loading [mm]."""
    return -1e3 * wr.equilibrium(system).mounts["m0"].deflection[2]


def shock(system, axis, sense, *, timestep=2e-4):
    """Return the largest displacement [mm] and acceleration [g] of the rack along an axis, the deck starting in a sense."""
    at, step = "xyz".index(axis), wr.VelocityStep(velocity=sense * VELOCITY, direction=axis)
    response = wr.simulate(system, step, duration=0.3, timestep=timestep, sample_rate=5000.0)
    moved = (response.bodies["rack"].position - response.base.displacement)[:, at]
    peak = response.peaks.bodies["rack"].acceleration
    return 1e3 * np.abs(moved - moved[0]).max(), max(peak.maximum[at], -peak.minimum[at]) / G
