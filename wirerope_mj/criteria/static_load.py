"""Static loads of mounts against their rated load."""

from wirerope_mj.criteria.verdict import Verdict
from wirerope_mj.statics import StaticTable


def static_load_verdicts(table: StaticTable) -> list[Verdict]:
    """Return a verdict on the axial load of every mount, history by history; not judged where no load is rated."""
    return [
        Verdict(
            criterion=f"static load in compression, {history}",
            subject=name,
            value=mount.compression,
            limit=mount.static_load,
            unit="N",
            note="" if mount.static_load is not None else "the isolator states no static load",
        )
        for history, sag in table.sags.items()
        for name, mount in sag.mounts.items()
    ]
