"""A run repeated on decks that bend, side by side, to see how much a rigid deck leaves out."""

from collections.abc import Sequence
from dataclasses import replace

from wirerope_mj.engine.flexible import Panel
from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.response.peaks import Peaks
from wirerope_mj.engine.simulation.batch import BatchResult, simulate_batch
from wirerope_mj.engine.simulation.stability import stable_step
from wirerope_mj.engine.system import System, on_deck
from wirerope_mj.motions import BaseMotion


def peaks_on_decks(
    system: System, motion: BaseMotion, panels: Sequence[Panel], *, duration: float, timestep: float, initial: str,
    sample_rate: float,
) -> list[Peaks | str]:  # fmt: skip
    """Simulate a system of a rigid deck on panels, which differ in frequency and damping, as one batch.

    Args:
        system: on a rigid deck.
        motion: of its base.
        panels: of one mass and direction.
        duration: as `simulate` takes it, like the others.
        timestep: largest step [s] of the run on the rigid deck; the panels' own rates are slower than the mounts'.
        initial: "settled", "relaxed" or "unloaded".
        sample_rate: steps end at its samples [Hz].

    Returns:
        The peaks on each panel, or why there are none.
    """
    first = on_deck(system, panels[0])
    systems = [first, *(retuned(first, panel) for panel in panels[1:])]
    step = min(timestep, *map(stable_step, systems))
    results = simulate_batch(
        systems, motion, duration=duration, timestep=step, initial=initial, sample_rate=sample_rate, threads=1
    )
    return [one.peaks if isinstance(one, BatchResult) else one.message for one in results]


def retuned(system: System, panel: Panel) -> System:
    """Return a system on a panel with the stiffness and the damping of another one of the same mass."""
    model = system.model.__copy__()
    joint = model.joint(NAME)
    q = int(model.jnt_qposadr[joint.id])
    model.qpos_spring[q] *= (
        float(model.jnt_stiffness[joint.id]) / panel.stiffness
    )  # its weight hangs in the spring as before
    model.jnt_stiffness[joint.id] = panel.stiffness
    model.dof_damping[int(model.jnt_dofadr[joint.id])] = panel.damper
    return replace(system, model=model, assembly=replace(system.assembly, model=model))
