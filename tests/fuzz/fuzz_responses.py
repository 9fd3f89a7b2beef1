"""Options of frequency responses, checked as `wirerope frf` checks them; a few are computed."""

import numpy as np
from campaign import Case
from hostile import pick

import wirerope_mj as wr
from wirerope_mj.cli.frf import _levels
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import order_bands
from wirerope_mj.foundation.directions import direction_in

_SYSTEMS = {name: wr.load_system(name) for name in ("sdof_shaker", "shock_table")}
_WILD = (float("nan"), float("inf"), -1.0, 0.0, -0.0, 1e-308, 1e308, 1e-12, 1e12, 10**400, True, None, "2", 3, 0.5, 1e9)
_WORDS = ("x", "y", "z", "1,0,1", "0,0,0", "nan,1,1", "1e400,0,0", "-z", "", "xyz", "1,2", "1,2,3,4", "a,b,c")
_BODIES = ("mass", "block", "deck", "table", "nobody", "", None, 3)


def mutate(rng: np.random.Generator, folder) -> Case:
    """Make options, one or two of which are strange."""
    options = {
        "accelerations": (1.0,), "method": "sweep", "direction": "z", "response_direction": None, "payload": None, "start": 2.0,
        "stop": 2.2, "rate": 60.0, "periods": 1, "largest_step": 0.02, "smallest_step": 1e-5, "smoothing": None,
    }  # fmt: skip
    for _ in range(pick(rng, (1, 1, 2))):
        name = pick(rng, list(options))
        if name in ("direction", "response_direction"):
            options[name] = pick(rng, _WORDS)
        elif name == "method":
            options[name] = pick(rng, ("continuation", "both", "sweep", "", None, "Sweep"))
        elif name == "payload":
            options[name] = pick(rng, _BODIES)
        elif name == "accelerations":
            options[name] = tuple(pick(rng, (*_WILD, 1.0, 2.0)) for _ in range(int(rng.integers(0, 3))))
        else:
            options[name] = pick(rng, _WILD)
    orders = None
    if rng.random() < 0.2:
        orders = [[pick(rng, (*_WILD, 1.0, 2.0)) for _ in range(int(rng.integers(0, 3)))] for _ in range(2)]
    asked = {"system": pick(rng, list(_SYSTEMS)), "options": options, "orders": orders, "compute": rng.random() < 0.02}
    return Case(
        f"{asked!r:.250}",
        asked,
        (*options, "acceleration", "--orders", "--speed-rpm", "axes", "base", "moves", "sweep"),
    )


def use(case: Case) -> str | None:
    """Check the options, and compute the response of a few."""
    options, system = dict(case.inputs["options"]), _SYSTEMS[case.inputs["system"]]
    if case.inputs["orders"] is not None:
        for band in order_bands(*case.inputs["orders"]):
            if not (np.isfinite([band.low, band.high]).all() and band.label):
                return "a band is not finite"
    options["accelerations"] = _levels(options["accelerations"] or None, None)
    for name in ("direction", "response_direction"):
        if options[name] is not None:
            options[name] = direction_in(options[name], name)
    checked = ResponseOptions(**options).checked(system)
    low, high = checked.range
    if not (0.0 < low < high and np.isfinite([low, high, *checked.accelerations, checked.rate]).all()):
        return "the range is not finite"
    if case.inputs["compute"] and checked.method == "sweep" and high / low < 2.0 and checked.rate > 10.0:
        (level, *_) = frequency_response(system, checked).levels
        assert level.up is not None
        return None if np.isfinite(level.up.amplitude).all() else "the envelope is not finite"
    return None
