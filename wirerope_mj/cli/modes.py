"""`wirerope modes`: the modes of a model about its equilibrium."""

from pathlib import Path
from typing import Literal

from wirerope_mj.cli.options import Deck, Force, Model, Numbers, dated


def modes(
    model: Model, *, history: Literal["virgin", "relaxed"] = "virgin", amplitude_mm: Numbers = None,
    ddam: Literal["hull", "deck", "shell"] | None = None, ship: Literal["surface", "submarine"] = "surface", deck: Deck = None,
    out: Path | None = None, force: Force = False,
) -> int:  # fmt: skip
    """Print the modes of a model about its equilibrium: frequencies, damping, shapes, and stability against tipping over.

    Natural frequencies of small amplitude stand first, with those of the tangents at rest; then, for every amplitude, frequency
    and damping of cycles of that size, which are those to quote for a shock. The folder holds the values and a recording in
    which the model moves in one mode shape after the other.

    Args:
        history: virgin, after the weight was laid on slowly, or relaxed, after long vibration.
        amplitude_mm: amplitudes of the mount that moves most [mm], one or several.
        ddam: print the design accelerations of DDAM for equipment on a ship's hull, deck or shell, too: x fore and aft, y
            athwartship, z vertical.
        ship: for which ship.
        out: folder of the result, or a .rrd file for the recording alone; runs/MODEL-modes-DATE-TIME by default.
    """
    from wirerope_mj.cli.tables import TIMELINE, say_next
    from wirerope_mj.content.modes import modes_content
    from wirerope_mj.dynamics.modes import modes as modes_of
    from wirerope_mj.engine.flexible import deck_of
    from wirerope_mj.engine.statics import model_warnings
    from wirerope_mj.engine.system import load_on_deck
    from wirerope_mj.foundation.arguments import positive
    from wirerope_mj.foundation.atomic_files import check_folder, check_writable
    from wirerope_mj.runs.analyses import MODES_KIND, MODES_MARKS, write_modes
    from wirerope_mj.views.terminal import print_lines, print_warnings, show

    sizes = [positive("--amplitude-mm", size, unit="mm") / 1e3 for size in amplitude_mm or []]
    system = load_on_deck(model, deck_of(deck) if deck else None)
    target = out or dated(f"{system.name}-modes")
    alone = target.suffix == ".rrd"
    if alone:
        check_writable(target, force=force)
    else:
        check_folder(target, force=force, kind=MODES_KIND, marks=MODES_MARKS)
    print_warnings(model_warnings(system))
    small = modes_of(system, history=history)
    large = [modes_of(system, history=history, amplitude=size) for size in sizes]
    if alone:
        from wirerope_mj.dynamics.modes.animation import animated_modes
        from wirerope_mj.views.recording.frequencies import record_modes

        record_modes(animated_modes(system, small), target, title=system.name, larger=large)
    else:
        write_modes(system, system.name, [small, *large], target, force=force)
    show(modes_content(system, small, large, ddam=ddam and (ship, ddam)))
    print_lines(["", f"written to {target}"])
    say_next({("show", target): TIMELINE})
    return 0
