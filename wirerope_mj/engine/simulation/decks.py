"""A run repeated on decks that bend, side by side, to see how much a rigid deck leaves out."""

from collections.abc import Sequence

from wirerope_mj.engine.flexible import Panel
from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.simulation.batch import BatchResult, simulate_batch
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.system import System, on_deck, varied
from wirerope_mj.motions import BaseMotion


def peaks_on_decks(
    system: System, motion: BaseMotion, panels: Sequence[Panel], *, duration: float, timestep: float, initial: str,
    sample_rate: float,
) -> list[Peaks | str]:  # fmt: skip
    """Simulate a system of a rigid deck on panels, which differ in frequency, as one batch.

    Args:
        system: on a rigid deck.
        motion: of its base.
        panels: of one mass, damping ratio and direction.
        duration: as `simulate` takes it, like the others.
        timestep: largest step [s] of the run on the rigid deck; the panels' own rates are slower than the mounts'.
        initial: "settled", "relaxed" or "unloaded".
        sample_rate: steps end at its samples [Hz].

    Returns:
        The peaks on each panel, or why there are none.
    """
    first = on_deck(system, panels[0])
    systems = [varied(first, tunings={NAME: panel.frequency / panels[0].frequency}) for panel in panels]
    step = min(timestep, *map(stable_step, systems))
    results = simulate_batch(
        systems, motion, duration=duration, timestep=step, initial=initial, sample_rate=sample_rate, threads=1
    )
    return [one.peaks if isinstance(one, BatchResult) else one.message for one in results]
