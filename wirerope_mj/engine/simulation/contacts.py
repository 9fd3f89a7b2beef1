"""The contacts of a run, from the tracker's memory in the system's userdata."""

from dataclasses import replace

from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.response.contacts import ContactPeak
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.contact_pairs import contact_name, payload_first, untouched
from wirerope_mj.foundation.arrays import Array

OTHERS = "further pairs"  # name of all pairs of geoms beyond the memory's last row


def contacts_of(system: System, user: Array) -> dict[str, ContactPeak]:
    """Return the contacts by name: the model's declared pairs, touched or not, what else touched, then the mounts' stops.

    Where more touched than the memory has rows for, the last row is of all further pairs together, and what is not known to
    have touched is left out.
    """
    model, addresses, base = system.model, system.assembly.tables.user, system.assembly.subjects.base
    contacts = dict(system.assembly.contacts)
    rows = addresses.contact_rows(user)
    for row in rows[rows[:, at.TOUCHES] != 0.0]:
        if row[at.GEOMS] == at.SEVERAL:
            contacts[OTHERS] = _touched(ContactPeak(geoms=(OTHERS, ""), bodies=("", "")), row)
        else:
            one, other = divmod(int(row[at.GEOMS]), at.MOST_GEOMS)
            pair = payload_first(model, base, (one - 1, other - 1))
            contacts[contact_name(model, pair)] = _touched(untouched(model, pair), row)
    if OTHERS in contacts:
        contacts = {name: contact for name, contact in contacts.items() if contact.touches}
    return contacts | _stops(system, user) if addresses.n_stops else contacts


def _stops(system: System, user: Array) -> dict[str, ContactPeak]:
    """Return the stops among the mounts' laws, open or not, by the mount's name; with the axis where it has several."""
    rows = iter(system.assembly.tables.user.stop_rows(user))
    contacts = {}
    for mount in system.mounts.values():
        axes = mount.isolator.stops
        for number, axis in enumerate(axes):
            name = mount.name if len(axes) == 1 else f"{mount.name} {axis}"
            name += f" {axes[: number + 1].count(axis)}" if axes.count(axis) > 1 else ""
            open_stop = ContactPeak(geoms=("", ""), bodies=(mount.payload_body, mount.base_body), mount=mount.name)
            row = next(rows)
            contacts[name] = _touched(open_stop, row) if row[at.TOUCHES] else open_stop
    return contacts


def _touched(contact: ContactPeak, row: Array) -> ContactPeak:
    force, depth = float(row[at.FORCE_PEAK]), float(row[at.DEPTH])
    return replace(
        contact,
        touches=int(row[at.TOUCHES]),
        from_start=bool(row[at.FROM_START]),
        first_touch=float(row[at.FIRST_TOUCH]),
        duration=float(row[at.TOUCHED_FOR]),
        force=force,
        force_time=float(row[at.FORCE_TIME]) if force else None,
        penetration=depth,
        penetration_time=float(row[at.DEPTH_TIME]) if depth else None,
        energy=float(row[at.WORK]),
    )
