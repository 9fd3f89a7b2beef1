"""`wirerope modes`: the modes of a model about its sagged position."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter


def modes(
    model: str,
    *,
    history: Literal["virgin", "relaxed"] = "virgin",
    amplitude_mm: Annotated[list[float] | None, Parameter(consume_multiple=True, negative=())] = None,
    ddam: Literal["hull", "deck", "shell"] | None = None,
    ship: Literal["surface", "submarine"] = "surface",
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Print the modes of a model where it rests: frequencies, damping, what moves, and how far from tipping over.

    Frequencies of small cycles stand first, the limit as their amplitude vanishes; then those of the tangents at rest on
    further loading and on unloading from the chosen history; then, for every amplitude, those of cycles of that size with their
    damping. Small cycles lie between the tangents unless a law has gamma > beta or an elastic part that bends. The folder holds
    the values and a recording in which the model moves in one mode shape after the other.

    Args:
        model: path of an MJCF file with mounts, or the name of one that ships with the package.
        history: virgin, after the weight was laid on slowly, or relaxed, after long vibration.
        amplitude_mm: amplitudes of the mount that moves most [mm], one or several.
        ddam: print the design accelerations of DDAM for equipment on a ship's hull, deck or shell, too: x fore and aft, y
            athwartship, z vertical.
        ship: for which ship.
        out: folder of the result, or a .rrd file for the recording alone; runs/MODEL-modes-DATE-TIME by default.
        force: replace what is there.
    """
    from wirerope_mj.cli.modes_tables import modes_command

    return modes_command(model, history, amplitude_mm or [], ddam=ddam and (ship, ddam), out=out, force=force)
