"""Modes of a system about its sagged position, and its stability against tipping over."""

from dataclasses import dataclass

import numpy as np
import scipy

from wirerope_mj.engine.statics import Equilibrium, History
from wirerope_mj.foundation.arrays import Array, Entries, Integers
from wirerope_mj.foundation.summary import Summarised, json_values, quantity

_LARGE = 20.0  # gravity factor, and rise [m], above which both are reported as a large margin
AMPLE = 3.0  # gravity factor from which a payload is called stable; less is called slender


def paired(likeness: Array) -> Integers:
    """Pair rows with columns of a likeness (n, n) of modes so that its sum is largest; returns the column of each row, (n,)."""
    # not `scipy.optimize`, which takes five times as long to import; a weight of 0 would exclude a pair
    matched = scipy.sparse.csgraph.min_weight_full_bipartite_matching(scipy.sparse.csr_array(2.0 - likeness))
    return np.asarray(matched[1])


@dataclass(frozen=True, kw_only=True)
class TippingStability:
    """Distance of the stiffness from being indefinite, with the mounts' tangents at rest.

    About the virgin position these are those of small cycles. About the relaxed one they are those of the elastic parts alone:
    under lasting vibration the hysteretic forces leak away, and the weight that they carried keeps sinking.
    """

    # of stiffness over mass [(rad/s)^2]; below zero the payload tips over, at zero a motion has no stiffness
    smallest_eigenvalue: float
    gravity_factor: float  # multiple of the weight, preload included, at which it tips over; infinite if it never does
    # smallest rise of the centre of mass of a payload, or of a jointed part of it, at which it tips over [m]; infinite if none
    # tips over, 0 if one does already. Bodies on a part count with it
    rise: float
    softest: float  # the gravity factor with the mounts' tangents on further loading instead of small cycles

    @property
    def stable(self) -> bool:
        return self.smallest_eigenvalue > 0.0

    @property
    def word(self) -> str:
        """One of "stable", "slender" (gravity factor below 3), "not held" (a motion without stiffness) and "tips over"."""
        if self.smallest_eigenvalue < 0.0:
            return "tips over"
        if self.smallest_eigenvalue == 0.0:
            return "not held"
        return "stable" if self.gravity_factor >= AMPLE else "slender"

    @property
    def description(self) -> str:
        """Clause that describes the margin against tipping over."""
        if self.word == "tips over":
            return "it tips over: its mounts do not hold its weight upright."
        if self.word == "not held":
            return "something moves without any stiffness: no mount, joint or stop holds it."
        if self.gravity_factor > _LARGE and self.rise > _LARGE:
            return f"{self.word}, large margin."
        limits = []
        if np.isfinite(self.gravity_factor):
            limits.append(f"at {self.gravity_factor:.2g} times its weight")
        if np.isfinite(self.rise):
            limits.append(f"with its centre of mass, or that of a part on a joint, {self.rise:.2g} m higher")
        return f"{self.word}; it would tip over {', or '.join(limits)}."

    def to_dict(self) -> Entries:
        """Write the stability as plain values; infinite ones are None."""
        values: Entries = {
            "word": self.word, "smallest_eigenvalue_1_s2": self.smallest_eigenvalue, "gravity_factor": self.gravity_factor,
            "rise_m": self.rise, "gravity_factor_on_loading": self.softest,
        }  # fmt: skip
        return {name: json_values(value) for name, value in values.items()}


@dataclass(frozen=True, kw_only=True)
class PayloadShape:
    """Motion of a payload in every mode, on the scale of `Modes.shapes`."""

    centre: Array  # centre of mass at rest [m], world frame, (3,)
    mass: float  # mass of the payload's root body and of all bodies on it [kg]
    inertia: Array  # its moments of inertia about the centre of mass at rest [kg m^2], world axes, (3,)
    translation: Array  # of the centre of mass [m], world frame, (n_modes, 3)
    rotation: Array  # of the root body [rad], world frame, (n_modes, 3)


@dataclass(frozen=True, kw_only=True)
class NaturalFrequencies:
    """Frequencies [Hz], (n,), and descriptions of modes, the same as in `Modes`."""

    frequencies: Array  # [Hz], (n_modes,)
    descriptions: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, repr=False)
class Modes(Summarised):
    """Modes of a system about the position where it rests, from the lowest on.

    Shapes are scaled so that the largest deflection of any mount is 1 m (without such, the largest coordinate 1): times the
    amplitude they are the motion. Unless an amplitude is given everything is the limit of small amplitude.
    """

    #: [Hz], (n_modes,); 0 for a motion that nothing holds, of all that tip over too if the equilibrium names a motion that no
    #: mount resists; else NaN where the weight wins over the mounts and the system tips over
    frequencies: Array
    damping_ratio: Array  #: of the closed cycles and of dampers, (n_modes,)
    #: loading, unloading: frequencies with every mount's tangent on further loading and on unloading from its history [Hz],
    #: (n_modes,): the first quarter cycle feels the one or the other. Those of small cycles lie between them where beta >=
    #: gamma; with gamma > beta both tangents are softer than alpha
    loading: Array
    unloading: Array
    shapes: Array  #: velocity coordinates of MuJoCo as columns, (n_v, n_modes); the driven base stands still
    payloads: dict[str, PayloadShape]  #: motion of every payload
    mounts: dict[str, Array]  #: deflection of every mount in its axes, (n_modes, 3)
    #: effective modal mass along x, y and z over the moving mass, (n_modes, 3); each column sums to 1, or to 0 where joints
    #: allow no motion along it
    participation: Array
    moving_mass: Array  #: mass that can move along x, y and z [kg], (3,)
    #: description of each mode, such as "rocking about y + sway x"; ends in "(free)" or "(tips over)" for such a mode
    descriptions: tuple[str, ...]
    history: History  #: equilibrium about which the modes are
    amplitude: float | None  #: largest deflection of any mount [m]; None: vanishing
    stability: TippingStability  #: against tipping over
    free: Integers  #: velocity coordinates of MuJoCo that can move, (n,)
    #: mass, stiffness: matrices of the free coordinates, (n, n); the stiffness is that of small closed cycles
    mass: Array
    stiffness: Array
    equilibrium: Equilibrium  #: position, forces and state of rest

    def _summary(self) -> tuple[str, dict[str, str]]:
        lines = {
            f"{frequency:.4g} Hz": f"{text}, damping {100.0 * damping:.3g} %"
            for frequency, text, damping in zip(self.frequencies, self.descriptions, self.damping_ratio, strict=True)
        }
        about = "small amplitudes" if self.amplitude is None else f"an amplitude of {quantity(self.amplitude, 'm')}"
        return f"Modes about the {self.history} equilibrium, {about}", lines

    @property
    def outside_tangents(self) -> Integers:
        """Indices of the modes whose frequency is outside the frequencies by the tangents on loading and on unloading."""
        slack = 1e-6  # equal tangents of a law differ by the rounding of their difference quotients
        tangents = np.nan_to_num(np.stack([self.loading, self.unloading]))  # NaN, a mode that tips over, is below all
        low, high = (1.0 - slack) * tangents.min(axis=0), (1.0 + slack) * tangents.max(axis=0)
        return np.flatnonzero((self.frequencies > high) | (self.frequencies < low))

    def indices_in(self, other: "Modes") -> list[int]:
        """Match each mode with the index of the corresponding mode in `other`, modes of the same system."""
        free = (modes.shapes[self.free] for modes in (self, other))
        ours, theirs = (x / np.sqrt(np.einsum("nj,nk,kj->j", x, self.mass, x)) for x in free)
        return [int(index) for index in paired((ours.T @ self.mass @ theirs) ** 2)]

    def to_dict(self) -> Entries:
        """Write the modes as plain values, SI; non-finite values are None."""
        modes = [
            {
                "word": description, "frequency_Hz": json_values(self.frequencies[i]),
                "loading_Hz": json_values(self.loading[i]), "unloading_Hz": json_values(self.unloading[i]),
                "damping_ratio": json_values(self.damping_ratio[i]), "participation": self.participation[i].tolist(),
                "payloads": {
                    name: {"translation": p.translation[i].tolist(), "rotation": p.rotation[i].tolist()}
                    for name, p in self.payloads.items()
                },
                "mounts": {name: shape[i].tolist() for name, shape in self.mounts.items()},
            }
            for i, description in enumerate(self.descriptions)
        ]  # fmt: skip
        return {
            "history": self.history, "amplitude_m": self.amplitude, "moving_mass_kg": self.moving_mass.tolist(),
            "modes": modes, "stability": self.stability.to_dict(),
        }  # fmt: skip
