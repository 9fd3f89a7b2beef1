"""Static loads of mounts against their rated load."""

from wirerope_mj.assessment.criteria.verdict import Verdict
from wirerope_mj.engine.statics import StaticTable
from wirerope_mj.mounts.isolator.static_rating import static_load_unjudged


def static_load_verdicts(table: StaticTable) -> list[Verdict]:
    """Return a verdict on the compression of every mount, history by history, as `starting_load_verdicts` does for a run.

    Not judged where no load is rated, where the mount hangs, and where it carries more across its axis than along it.
    """
    found = []
    for history, sag in table.sags.items():
        for name, mount in sag.listed.items():
            note = static_load_unjudged(mount.force, mount.static_load)
            found.append(
                Verdict(
                    criterion=f"static load in compression, {history}",
                    subject=name,
                    value=mount.compression,
                    limit=None if note else mount.static_load,
                    unit="N",
                    note=note,
                )
            )
    return found
