"""`wirerope select`: every part of the catalogue simulated in the places of the mounts; and the vendors' worksheet."""

from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Literal

from cyclopts import App

from wirerope_mj.cli.options import Flag, Force, Integer, Integers, Repeated, RepeatedPaths
from wirerope_mj.cli.shock import said_in_options, with_motions
from wirerope_mj.foundation.arguments import integer, positive
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.plain_text import plain
from wirerope_mj.motions import BaseMotion

NOTHING_FOUND = 1  # Exit code if no part meets the demands
Mode = Literal["compression", "45", "shear", "roll"]

select_app = App(name="select")


@select_app.default
@with_motions
def select(
    model: str | None = None,
    *,
    shock: Repeated = None,
    levels: RepeatedPaths = None,
    mass: float | None = None,
    mounts: Repeated = None,
    size: tuple[float, float, float] | None = None,
    fragility: float | None = None,
    travel: float | None = None,
    height_max: float | None = None,
    room: tuple[float, float, float] | None = None,
    limit: Repeated = None,
    initial: Literal["settled", "relaxed"] = "settled",
    parts: str = "*",
    prices: Path | None = None,
    by: Literal["margin", "acceleration", "number", "height", "price", "mass"] | None = None,
    all: Flag = False,  # noqa: A002  # the option's name
    take: str | None = None,
    out: Path | None = None,
    force: Force = False,
    **motions: Any,
) -> int:
    """Choose isolators: simulate every part of the catalogue under all load cases, and rank those that keep the limits.

    The equipment is a model, whose mounts take every part in turn, the model and load cases of a job, or a box by its mass.
    Each motion is a load case, in the options of `wirerope shock`, such as --psd or --record, or by --shock with the kind of
    the motion among its words; without a direction it is along z there. Exits 1 if no part keeps every limit.

    wirerope select --mass 420 --size 800 800 1800 --mounts 4+2 --shock "half-sine 15 g 11 ms y" --fragility 15 --travel 60

    Args:
        model: path of a model, name of one that ships, or file of a job (JOB.toml) with model, load cases and limits.
        shock: a load case: "half-sine 15 g 11 ms z", "double half-sine 60 g 2.5 m/s 43 mm", "2 m/s"; again for each further.
        levels: a load case: file of levels, as `wirerope levels` writes one.
        mass: of equipment that is a box filled evenly [kg], instead of a model.
        mounts: of the box: how many stand where: "4" below it, "4+2" below and behind it at +y, "4 top + 4 bottom",
            "4 ceiling", "4 wall", "8 corners 45 deg", "4 corners"; again for each alternative.
        size: of the box along x, y and z [mm]; without it the mounts stand at the height of the centre of mass.
        fragility: acceleration that each body of the payload stands [g].
        travel: room around each point of the payload, for a box its corners, both ways along x, y and z [mm].
        height_max: largest height of a part [mm].
        room: box along x, y and z [mm] in which equipment and mounts must stay, with the sway of every load case; mounts count
            by their height and width, turned as they stand.
        limit: "acceleration/rack = 15 g" or "clearance/rack_top = 30 30 20 mm", as `wirerope shock` takes it.
        initial: state in which each case begins: settled under its weight, or relaxed (after long vibration).
        parts: which parts of the vendors' tables, such as "CB1400*".
        prices: table (CSV or XLSX) of one's own: name of the part, price, mass [kg].
        by: what parts that keep every limit are ranked by: margin, acceleration, number (of mounts), height, price or mass;
            the margin by default, without a limit of an acceleration the acceleration.
        all: show every part, and which were refused for which reason.
        take: part that is written, instead of the first.
        out: folder into which the model on the chosen part is written, with the limits in it.
    """
    import numpy as np

    from wirerope_mj.content.part_selection import catalogue_selection_content
    from wirerope_mj.engine.simulation.progress import share_bar
    from wirerope_mj.foundation.atomic_files import check_folder
    from wirerope_mj.foundation.payload_limits import limit_from_text
    from wirerope_mj.foundation.units import STANDARD_GRAVITY
    from wirerope_mj.runs.new_model import KIND, marks
    from wirerope_mj.runs.selection import equipment, read_prices, write_selected
    from wirerope_mj.studies.catalogue import catalogue, select_parts
    from wirerope_mj.views.terminal import show_result

    lengths = (("room", length) for length in room or ())
    for option, value in (("mass", mass), ("fragility", fragility), ("travel", travel), ("height-max", height_max), *lengths):
        if value is not None:
            positive(f"--{option}", value)
    if (model is None) == (mass is None):
        raise ValueError("give the equipment as a model or a job, or as a box by `--mass` and `--mounts`: one of them.")
    if mass is None and (mounts or size):
        raise ValueError("`--mounts` and `--size` belong to `--mass`: a model has its mounts.")
    if mass is not None and not mounts:
        raise ValueError('`--mounts` must say how many there are, "4", or below and behind, "4+2".')
    if room is not None and mass is not None and size is None:
        raise ValueError("`--room` needs the box's own `--size`: what must stay in the room has none without it.")
    stated = {} if prices is None else read_prices(prices)
    if by in ("price", "mass") and not any(by in own for own in stated.values()):
        raise ValueError(f"`--by {by}` needs `--prices`, a table with a column {by!r}.")
    box = None if mass is None else {"mass": mass, "size": None if size is None else tuple(1e-3 * one for one in size)}
    systems, cases = equipment(
        model, _load_cases(shock or (), levels or (), motions), box=box, mounts=mounts or (),
        limits=[limit_from_text(text) for text in limit or ()],
        fragility=None if fragility is None else fragility * STANDARD_GRAVITY, travel=None if travel is None else 1e-3 * travel,
    )  # fmt: skip
    tried = catalogue(parts, highest=None if height_max is None else 1e-3 * height_max)
    if take is not None and take not in tried:
        near = get_close_matches(take, tried, n=3)
        meant = f" Near it: {', '.join(near)}." if near else ""
        raise ValueError(f"`--take` must be a part that is tried, got {take!r}.{meant}")
    if out is not None:
        check_folder(out, force=force, kind=KIND, marks=marks(out.resolve().name))
    with share_bar("simulating", "parts", enabled=True) as update:
        selection = select_parts(
            systems, tried, cases, by=by, stated=stated, initial=initial,
            room=None if room is None else 1e-3 * np.array(room), progress=lambda done: update(done, len(tried) * done),
        )  # fmt: skip
    content = catalogue_selection_content(selection, every=all)
    show_result(content, "brief", others=("parts",), every=all)
    if out is not None or take is not None:
        chosen = next(one for one in selection.tried if take in (None, one.name))
        path = write_selected(chosen, out or Path(chosen.name.lower()), box=box, force=force)
        print(plain(f"  written: {path}, on {chosen.mounts} {chosen.name}"))
    elif selection.meeting:
        print("  --out FOLDER writes the model on the first part, --all prints every table; both simulate again")
    return 0 if selection.meeting else NOTHING_FOUND


def _load_cases(shocks: Sequence[str], levels: Sequence[Path], motions: Entries) -> dict[str, BaseMotion]:
    """Make a load case of each motion that the options say, by its name."""
    from wirerope_mj.motions.registry import motion_from_phrase, motion_from_words, motion_of_levels
    from wirerope_mj.runs.said_motion import said_motion

    phrases, recorded = said_in_options(motions)
    cases = {text: motion_from_words(text) for text in shocks}
    cases |= {f"{kind} {text}": motion_from_phrase(kind, text) for kind, text in phrases}
    cases |= {} if recorded["record"] is None else {recorded["record"].stem: said_motion([], **recorded)}
    return cases | {file.stem: motion_of_levels(file) for file in levels}


@select_app.command
def worksheet(
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
    all: Flag = False,  # noqa: A002  # the option's name
) -> int:
    """Look up parts by the vendors' worksheet, closed formulas of a guided mass: load, travel, frequency and acceleration.

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
    """
    from wirerope_mj.assessment.selection import WORKSHEET_GRAVITY, select_isolators, shock_from_text
    from wirerope_mj.content.part_selection import selection_content
    from wirerope_mj.views.terminal import show_result

    integer("--mounts", mounts, least=1)
    given = {
        "mass": mass, "velocity": velocity, "drop": drop, "travel": travel, "fragility": fragility,
        "disturbance-rpm": disturbance_rpm, "disturbance-hz": disturbance_hz, "isolation-ratio": isolation_ratio,
    }  # fmt: skip
    for option, value in given.items():
        if value is not None:
            positive(f"--{option}", value)
    if disturbance_rpm is not None and disturbance_hz is not None:
        raise ValueError("give the disturbance as `--disturbance-rpm` or as `--disturbance-hz`, not both.")
    if (shock, velocity, drop).count(None) != 2:
        raise ValueError('give one shock: `--shock "15 g 11 ms half-sine"`, `--velocity` [m/s] or `--drop` [m].')
    if disturbance_rpm is not None:
        disturbance_hz = disturbance_rpm / 60.0
    selection = select_isolators(
        mass=mass, mounts=mounts, pulse=None if shock is None else shock_from_text(shock), velocity=velocity, drop=drop,
        rebound=rebound, travel=None if travel is None else 1e-3 * travel,
        fragility=None if fragility is None else fragility * WORKSHEET_GRAVITY, disturbance=disturbance_hz, loading=loading,
        direction=direction, isolation_ratio=isolation_ratio, loops=loops or (),
    )  # fmt: skip
    content = selection_content(selection, every=all)
    show_result(content, "worksheet", "parts", others=(), every=all)
    if selection.candidates and selection.rejected and not all:
        print("  --all shows every part and says why.")
    return 0 if selection.candidates else NOTHING_FOUND
