"""Every law by its name: one parameter set in the size of a mount, and a strategy for hypothesis in units of one.

A law that joins the registry is among them; its parameters are drawn within what its class declares unless it stands here.
"""

from dataclasses import MISSING, fields, replace

import numpy as np
from hypothesis import strategies as st

from wirerope_mj.foundation.structure import bounds_of
from wirerope_mj.mounts.laws import LAWS, Law, Parallel

PARAMETERS = {name: law.example for name, law in LAWS.items()}


def example(name: str, **changes: object) -> Law:
    """Return the law of PARAMETERS with this name, some of its parameters changed."""
    return LAWS[name](**{**PARAMETERS[name], **changes})


def _laws(name: str, **parameters: st.SearchStrategy) -> st.SearchStrategy[Law]:
    """Return laws with this name and drawn parameters."""
    return st.fixed_dictionaries(parameters).map(lambda drawn: LAWS[name](**drawn))


positive, small, any_sign = st.floats(0.2, 5.0), st.floats(0.0, 1.0), st.floats(-0.9, 1.0)
sharpness = st.one_of(st.sampled_from([1.0, 2.0]), st.floats(0.2, 3.0))


@st.composite
def _bouc_wen(draw, name, **more):
    """Return laws with a bounded hysteretic force, sharpness from far below to above 1."""
    beta = draw(st.floats(0.05, 2.0))
    parameters = {"alpha": draw(positive), "beta": beta, "gamma": draw(any_sign) * beta, "n": draw(sharpness)}
    return LAWS[name](**parameters, **{key: draw(value) for key, value in more.items()})


@st.composite
def _masing(draw):
    """Return one to six Jenkin elements with yield deflections from far below to above the paths' size."""
    n = draw(st.integers(1, 6))
    stiffness = draw(st.lists(positive, min_size=n, max_size=n))
    slip = draw(st.lists(st.floats(0.05, 5.0), min_size=n, max_size=n))
    return LAWS["masing"](stiffness=stiffness, slip_force=slip, k=draw(small), k2=draw(small), k3=draw(small))


@st.composite
def _stop(draw):
    """Return stops of one side or both, elastic, lossy or viscous or both, by k and exponent or by points."""
    side = draw(st.sampled_from(["below", "above", "both"]))
    gaps = {f"gap_{name}": draw(st.floats(0.0, 2.0)) for name in ("below", "above") if side in (name, "both")}
    if draw(st.booleans()):
        curve = {"k": draw(positive), "exponent": draw(st.sampled_from([1.0, 1.5, 2.0]))}
    else:
        steps = draw(st.lists(st.tuples(st.floats(0.1, 1.0), st.floats(0.1, 3.0)), min_size=1, max_size=5))
        depths, forces = np.cumsum(np.array(steps), axis=0).T
        curve = {"depths": depths, "forces": forces}
    loss, viscous = draw(st.none() | st.floats(0.05, 1.0)), draw(st.none() | small)
    lossy = {} if loss is None else {"loss": loss, "reversal": draw(st.floats(0.05, 2.0))}
    rounding = draw(st.floats(0.05, 1.0)) if viscous else draw(small)
    return LAWS["stop"](**gaps, **curve, **lossy, rounding=rounding, c=viscous or 0.0)


@st.composite
def parallel_laws(draw):
    """Return two or three laws in parallel, a stop among them more often than others."""
    names = st.sampled_from([*(name for name in STRATEGIES if name != "bouc-wen-baber-noori"), *["stop"] * 6])
    return Parallel(laws=tuple(draw(STRATEGIES[name]) for name in draw(st.lists(names, min_size=2, max_size=3))))


@st.composite
def _tabulated(draw):
    """Return limit curves of different shapes, or a curve with areas, around zero and as wide as the paths."""
    spacings = st.lists(st.floats(0.1, 2.0), min_size=1, max_size=4)
    sides = [np.cumsum(draw(spacings)) for _ in range(2)]
    x = np.concatenate([-sides[0][::-1] / sides[0][-1], [0.0], sides[1] / sides[1][-1]]) * 3.0
    mean = np.concatenate([-np.cumsum(draw(st.lists(small, min_size=len(side), max_size=len(side)))) for side in sides])
    mean = np.concatenate([mean[: len(sides[0])][::-1], [0.0], -mean[len(sides[0]) :]])
    kept = {"deflection": x, "yield_deflection": draw(st.floats(0.1, 3.0)), "extrapolate": True}
    if draw(st.booleans()):
        half = np.array(draw(st.lists(small, min_size=x.size, max_size=x.size)))
        return LAWS["tabulated"](upper=mean + half, lower=mean - half, **kept)
    sizes = np.array([0.5, 2.0])
    areas = 4.0 * draw(positive) * (sizes - kept["yield_deflection"] * np.tanh(sizes / kept["yield_deflection"]))
    areas[1] *= draw(st.floats(0.9, 2.0))
    return LAWS["tabulated"](force=mean, curve="mid", amplitudes=sizes, areas=areas, **kept)


POLYNOMIAL = {"k1": small, "k2": small, "k3": small}
STRATEGIES = {
    "bouc-wen": _bouc_wen("bouc-wen", k=small),
    "ozdemir": _laws("ozdemir", alpha=positive, beta=st.floats(0.05, 2.0), n=sharpness, k=small),
    "asymmetric-bouc-wen": _bouc_wen(
        "asymmetric-bouc-wen", **POLYNOMIAL, b=st.floats(0.4, 2.5), c=st.floats(-1.5, 1.5)
    ),
    "symmetric-bouc-wen": _bouc_wen("symmetric-bouc-wen", **POLYNOMIAL),
    "kelvin-voigt": _laws("kelvin-voigt", k=positive, c=positive),
    "enhanced-dry-friction": _laws("enhanced-dry-friction", k=small, d=positive, u_c=st.floats(0.1, 3.0)),
    "masing": _masing(),
    # k2^2 <= 9/2 k1 k3 keeps the energy of the polynomial from becoming negative.
    "tinker-cutchins": _laws(
        "tinker-cutchins", k1=st.floats(0.5, 2.0), k2=st.floats(-1.0, 1.0), k3=st.floats(0.5, 1.0), c=small,
        n=st.floats(0.5, 3.0), f0=small, f1=small, f2=small, smoothing=st.floats(0.01, 1.0),
    ),
    "equivalent-viscous": _laws(
        "equivalent-viscous", k1=st.floats(0.5, 2.0), k2=st.floats(-1.0, 1.0), k3=st.floats(0.5, 1.0), energy=positive,
        amplitude=positive, frequency=positive,
    ),
    "zener": _laws("zener", k0=positive, k1=positive, c=positive),
    "vaiana-rosati": _laws(
        "vaiana-rosati", kb=small, f0=positive, alpha=positive, b1=small, b2=small, g1=small, g2=small, g3=any_sign,
        f0_minus=st.none() | positive, alpha_minus=st.none() | positive,
    ),
    "bouc-wen-baber-noori": _laws(
        "bouc-wen-baber-noori", alpha=st.floats(2.0, 5.0), beta=st.floats(0.3, 2.0), gamma=st.floats(-0.2, 1.0),
        n=sharpness, k=small, delta_alpha=st.floats(0.0, 0.01), delta_nu=st.floats(0.0, 0.1),
        delta_eta=st.floats(0.0, 0.1), zeta=st.floats(0.0, 0.9), q=st.floats(0.0, 0.3), p=small,
        psi=st.floats(0.1, 1.0), delta_psi=st.floats(0.0, 0.05), lam=st.floats(0.1, 1.0),
    ),
    # 2 sqrt(k1 k3) >= 0.4: the polynomial's force never turns against its deflection.
    "scragged-bouc-wen": _bouc_wen(
        "scragged-bouc-wen", softening=st.floats(0.0, 0.95), reach=st.floats(0.1, 3.0), k1=st.floats(0.2, 1.0),
        k2=st.floats(-0.4, 1.0), k3=st.floats(0.2, 1.0),
    ),
    "stop": _stop(),
    "tabulated": _tabulated(),
}  # fmt: skip


def _declared(law):
    """Return laws of a class whose required parameters are drawn within what it declares."""
    drawn = {name: positive for name, meta in bounds_of(law).items() if meta.gt is not None}
    drawn |= {name: small for name, meta in bounds_of(law).items() if meta.ge is not None}
    required = [field.name for field in fields(law) if field.default is MISSING]
    return _laws(law.name, **{name: drawn.get(name, any_sign) for name in required})


STRATEGIES |= {name: _declared(law) for name, law in LAWS.items() if name not in STRATEGIES}

SLOWED = {
    "kelvin-voigt": lambda law, s: replace(law, c=law.c * s),
    "zener": lambda law, s: replace(law, c=law.c * s),
    "tinker-cutchins": lambda law, s: replace(law, c=law.c * s**law.n, smoothing=law.smoothing / s),
    "equivalent-viscous": lambda law, s: replace(law, frequency=law.frequency / s),
    "stop": lambda law, s: replace(law, c=law.c * s),
}
"""The law that draws, s times slower, the loop of `law`: the stated rate dependence. The others do not know the rate."""


def _swapped(law):
    """Return Vaiana and Rosati's law with the curves of both directions exchanged and turned about the origin."""
    both = [(name, f"{name}_minus") for name in ("kb", "f0", "alpha", "b1", "b2", "g1", "g2", "g3")]
    turned = {"b1", "b2", "g3"}
    swap = {a: getattr(law, b) * (-1.0 if a in turned else 1.0) for a, b in both}
    return replace(law, **swap, **{b: getattr(law, a) * (-1.0 if a in turned else 1.0) for a, b in both})


def _turned(law):
    """Return a tabulated law turned about the origin."""
    flip = {name: tuple(-v for v in getattr(law, name)[::-1]) for name in ("deflection", "force")}
    both = {"upper": "lower", "lower": "upper"}
    return replace(law, **flip, **{a: tuple(-v for v in getattr(law, b)[::-1]) for a, b in both.items()})


MIRRORED = {
    "asymmetric-bouc-wen": lambda law: replace(law, c=-law.c),
    "tinker-cutchins": lambda law: replace(law, k2=-law.k2),
    "equivalent-viscous": lambda law: replace(law, k2=-law.k2),
    "vaiana-rosati": _swapped,
    "stop": lambda law: replace(law, gap_below=law.gap_above, gap_above=law.gap_below),
    "tabulated": _turned,
}
"""The law that answers the mirrored path with the mirrored force; a law that is not named here is odd itself."""


def passive(law):
    """Return whether no path from the unloaded state should gain work: only Vaiana and Rosati's law claims less."""
    return all(one.name != "vaiana-rosati" or (one.f0, one.alpha) == (one.f0_minus, one.alpha_minus) for one in law.components)


turning_points = st.lists(st.floats(-3.0, 3.0), min_size=2, max_size=10)


def path_through(points, *, per_segment):
    """Return samples of a path from 0 through the turning points, `per_segment` to each stretch."""
    ends = [0.0, *points]
    return np.concatenate([[0.0], *(np.linspace(a, b, per_segment + 1)[1:] for a, b in zip(ends, points, strict=False))])


def smooth_path(points, *, per_segment, duration=1.0):
    """Return deflection, time and rate of half cosines from 0 through the turning points, each in `duration`."""
    phase = np.linspace(0.0, np.pi, per_segment + 1)[1:]
    x, v = [np.zeros(1)], [np.zeros(1)]
    for a, b in zip([0.0, *points], points, strict=False):
        x.append(0.5 * (a + b) - 0.5 * (b - a) * np.cos(phase))
        v.append(0.5 * (b - a) * np.sin(phase) * np.pi / duration)
    x, v = np.concatenate(x), np.concatenate(v)
    return x, np.arange(x.size) * duration / per_segment, v


# Steady loops of amplitude A for alpha = 1: beta, gamma, n, A, peak z, work per cycle. The digits are those of an
# event-split integration (relative tolerance 1e-12) of the differential equation.
LOOPS = [
    (0.8, 0.2, 1, 1, 0.7488105660, 0.8309464386),
    (0.5, 0.5, 1, 1, 0.7215354572, 0.5932447550),
    (0.8, 0.2, 1, 2, 0.9608865002, 3.8868885201),
    (0.5, 0.5, 1, 2, 0.9525215090, 3.2826167390),
    (1.0, 0.0, 1, 1, 0.7615941560, 0.9536233762),
    (1.0, 0.0, 1, 2, 0.9640275801, 4.1438896797),
    (0.8, 0.2, 2, 1, 0.8481664027, 0.6727513048),
    (0.5, 0.5, 2, 1, 0.8256588617, 0.4630878365),
    (0.5, -0.4, 1, 1, 1.1431451805, 0.6222631732),
    (0.5, -0.5, 1, 2, 2.6934413590, 4.4808609183),
    (0.8, -1.0, 2, 2, 7.9446241187, 10.4247588475),
]
