"""`wirerope select`: the catalogue parts that meet a worksheet, and what a simulation says of the best of them."""

import sys
from collections.abc import Mapping
from typing import Annotated, Literal

from cyclopts import Parameter

from wirerope_mj.cli.options import Integer, Integers
from wirerope_mj.foundation.arguments import integer, positive
from wirerope_mj.foundation.plain_text import plain

NOTHING_FOUND = 1  # Exit code if no part meets the worksheet
Mode = Literal["compression", "45", "shear", "roll"]


def select(
    *,
    mass: float,
    mounts: Integer,
    shock: str | None = None,
    velocity: float | None = None,
    drop: float | None = None,
    rebound: float = 0.0,
    travel: float | None = None,
    fragility: float | None = None,
    disturbance_rpm: float | None = None,
    disturbance_hz: float | None = None,
    isolation_ratio: float = 3.0,
    loading: Mode = "compression",
    direction: Mode | None = None,
    loops: Integers | None = None,
    all: Annotated[bool, Parameter(negative=())] = False,  # noqa: A002  # the option's name
    simulate: Annotated[bool, Parameter(negative=())] = False,
    best: Integer = 5,
) -> int:
    """Choose isolators by the vendors' worksheet: what carries the load and keeps travel, frequency and acceleration.

    Every g here is 9.81 m/s^2, as in the vendors' sheets. A pulse counts by its velocity change. Parts come by what they
    use of their limits if --fragility is given, else the softest that fits first. Exits 1 if no part meets the worksheet.

    Args:
        mass: of the payload [kg], its centre of mass in the middle of the mounts.
        mounts: how many share it.
        shock: of the base: "15 g 11 ms half-sine" (or sawtooth, trapezoid), or "2 m/s".
        velocity: sudden velocity of the base instead [m/s].
        drop: or height of its fall onto a stop [m].
        rebound: velocity after the fall over the one before it.
        travel: room that the payload has to move [mm].
        fragility: acceleration that the payload stands [g].
        disturbance_rpm: lowest disturbance that must be isolated [revolutions per minute].
        disturbance_hz: the same [Hz].
        isolation_ratio: disturbing over natural frequency.
        loading: how the weight loads the mounts.
        direction: how the shock does; as the weight by default.
        loops: also try the parts with so many loops; load and stiffness in proportion.
        all: show the parts that do not meet it as well, with the reasons.
        simulate: fit the best parts from their rows and put their simulated shock beside the worksheet.
        best: how many are simulated.
    """
    from wirerope_mj.assessment.selection import (
        SimulatedShock,
        select_isolators,
        shock_from_text,
        simulate_candidate,
    )
    from wirerope_mj.assessment.selection.worksheet import WORKSHEET_GRAVITY
    from wirerope_mj.content.part_selection import selection_content
    from wirerope_mj.foundation.errors import WireRopeError
    from wirerope_mj.views.terminal import print_headline
    from wirerope_mj.views.terminal import show as print_sections

    _require(
        {
            "mass": mass, "velocity": velocity, "drop": drop, "travel": travel, "fragility": fragility,
            "disturbance-rpm": disturbance_rpm, "disturbance-hz": disturbance_hz, "isolation-ratio": isolation_ratio,
        },
        mounts=mounts, shocks=sum(given is not None for given in (shock, velocity, drop)), best=best,
    )  # fmt: skip
    if disturbance_rpm is not None:
        disturbance_hz = disturbance_rpm / 60.0
    selection = select_isolators(
        mass=mass, mounts=mounts, pulse=None if shock is None else shock_from_text(shock), velocity=velocity, drop=drop,
        rebound=rebound, travel=None if travel is None else 1e-3 * travel,
        fragility=None if fragility is None else fragility * WORKSHEET_GRAVITY, disturbance=disturbance_hz, loading=loading,
        direction=direction, isolation_ratio=isolation_ratio, loops=loops or (),
    )  # fmt: skip
    simulated: dict[str, SimulatedShock] = {}
    failures: dict[str, str] = {}
    for candidate in selection.candidates[: best if simulate else 0]:
        name = candidate.part.name
        if sys.stderr.isatty():
            print(plain(f"simulating {name} .."), file=sys.stderr, flush=True)
        try:
            simulated[name] = simulate_candidate(candidate, selection.worksheet)
        except WireRopeError as error:
            failures[name] = str(error)
    content = selection_content(selection, simulated, failures, every=all)
    print_sections(content, "worksheet", "parts")
    print_headline(content.verdict)
    if selection.candidates and selection.rejected and not all:
        print("  --all shows every part and says why.")
    return 0 if selection.candidates else NOTHING_FOUND


def _require(values: Mapping[str, float | None], *, mounts: int, shocks: int, best: int) -> None:
    """Raise ValueError unless the options are in range and go together."""
    integer("--mounts", mounts, least=1)
    for option, value in values.items():
        if value is not None:
            positive(f"--{option}", value)
    if values["disturbance-rpm"] is not None and values["disturbance-hz"] is not None:
        raise ValueError("give the disturbance as `--disturbance-rpm` or as `--disturbance-hz`, not both.")
    if shocks != 1:
        raise ValueError('give one shock: `--shock "15 g 11 ms half-sine"`, `--velocity` [m/s] or `--drop` [m].')
    integer("--best", best, least=1)
