"""Blocks on isolators: a table of their ratings, and the laws, geometry and provenance of each."""

from collections.abc import Iterator, Sequence

from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.numbers import ABSENT, number, with_unit
from wirerope_mj.foundation.tables import Column, Table, left
from wirerope_mj.foundation.units import in_unit
from wirerope_mj.mounts.isolator import AXES, Isolator
from wirerope_mj.mounts.isolator.travel import RATINGS
from wirerope_mj.mounts.laws import Law

_SOFTENING = 0.05  # fraction of a mount's stiffness lost to a bracket, above which the figure is stated


def ratings_table(devices: Sequence[Isolator]) -> Table:
    laws = [dict.fromkeys(law.name for law in device.axes.values() if law is not None) for device in devices]
    rows = [
        (device.name, device.provenance.kind, ", ".join(names), *ratings(device))
        for device, names in zip(devices, laws, strict=True)
    ]
    return Table(
        "isolators", "Isolators and their ratings", [*left("isolator", "figures are", "laws"), *RATING_COLUMNS], rows,
        note=f"{ABSENT}: not stated, and so not judged.",
    )  # fmt: skip


RATING_COLUMNS = (
    Column("height", "mm", ".4g"), Column("width", "mm", ".4g"), Column("static\nload", "kN", 4),
    *(Column({"compression": "compr."}.get(rating, rating), "mm", ".4g") for rating in RATINGS),
)  # fmt: skip


def ratings(device: Isolator) -> tuple[float | None, ...]:
    """List sizes, static load and rated travels of an isolator, the cells of `RATING_COLUMNS`."""
    size, limits = device.geometry, device.limits
    sizes = (size.height, size.width) if size else (None, None)
    return *sizes, limits.static_load, *(getattr(limits.travel, rating) for rating in RATINGS)


def provenance_statement(device: Isolator) -> Statement:
    """State the provenance of an isolator's figures, its stops, stiffening and bracket, and what is assumed."""
    stated = device.provenance
    text = f"{device.name}: {stated.kind} figures. "
    text += f"Source: {stated.source.rstrip('.')}. " if stated.source else "No source is stated. "
    text += f"Fitted to: {stated.fitted_to.rstrip('.')}." if stated.fitted_to else "Nothing is said of a fit."
    for axis, law in device.axes.items():
        for stop in law.stops if law is not None else ():
            sides = ((stop.gap_below, "below"), (stop.gap_above, "above"))
            gaps = " and ".join(f"{with_unit(gap, 'm')} {side}" for gap, side in sides if gap is not None)
            if stop.k is None:
                force = f"points up to {with_unit(stop.forces[-1], 'N')} at {with_unit(stop.depths[-1], 'm')} beyond it"
            elif stop.exponent == 1.0:
                force = f"{with_unit(stop.k, 'kN/m')} beyond it"
            else:
                force = f"exponent {number(stop.exponent)} beyond it"
            rest = f" from rest at {with_unit(stop.rest, 'm')}" if stop.rest is not None else ""
            text += f" Stop, {axis}: gap {gaps}{rest}, {force}."
    if device.stiffening is not None:
        text += f" Stiffened by its first cycles, {device.stiffening.description}."
    if device.temperature is not None:
        text += f" Temperature: {device.temperature.description}."
    for axis, stiffness in device.bracket.stated.items() if device.bracket is not None else ():
        law = device.axes[axis]
        softer = law.initial_stiffness / (law.initial_stiffness + stiffness) if law is not None else 0.0
        amount = f"by {100.0 * softer:.0f} %" if softer > _SOFTENING else f"by less than {100.0 * _SOFTENING:.0f} %"
        text += f" Along {axis} on a bracket of {1e-6 * stiffness:.4g} kN/mm, softer {amount} at small amplitudes."
    assumed = tuple(f"Assumed: {item.rstrip('.')}." for item in stated.assumed)
    return Statement(f"source-{device.name}", text, items=assumed)


def isolator_blocks(device: Isolator) -> Iterator[Block]:
    """Yield the provenance, laws, couplings and sizes of an isolator as statements."""
    yield provenance_statement(device)
    laws = [f"{axis}: {'no force' if law is None else law_text(law)}" for axis, law in device.axes.items()]
    # what acts on several axes
    if device.coupling is not None:
        both = " and ".join(AXES[axis] for axis in device.coupled_axes)
        laws.append(f"coupling: {device.coupling}, {both} share one hysteretic force")
    if device.loop is not None:
        values = device.loop.to_dict()
        rows = "; ".join(", ".join(f"{value:.6g}" for value in row) for row in values.pop("coefficients"))
        ends = ", ".join(f"{name} = {value:.6g}" for name, value in values.items())
        laws.append(f"loop: {ends}, coefficients = [{rows}] J")
    if device.rotation is not None:
        stiffness = ", ".join(f"{axis} = {value:.6g}" for axis, value in device.rotation.to_dict().items())
        laws.append(f"rotation: {stiffness} N m/rad")
    for name, effect in (("stiffening", device.stiffening), ("temperature", device.temperature)):
        if effect is not None:
            laws.append(f"{name}: {effect.description}, which the table does not count")
    yield Statement("laws", "Laws, in SI units:", items=tuple(laws))
    if device.geometry is not None:
        sizes = {"height": device.geometry.height, "width": device.geometry.width, "bar": device.geometry.bar}
        known = ", ".join(f"{name} {in_unit(size, 'mm'):.4g} mm" for name, size in sizes.items() if size is not None)
        if known:
            text = f"Envelope: {known}; a mount's position in a table is its mid-height."
            yield Statement("envelope", text)


def law_text(law: Law) -> str:
    """Write the parts of a law with their parameters as in an isolator file, SI units."""
    texts = []
    for values in (part.to_dict() for part in law.components):
        parameters = [f"{key} = {_value_text(value)}" for key, value in values.items() if key != "law"]
        texts.append(f"{values['law']}: {', '.join(parameters)}")
    return " and ".join(texts)


def _value_text(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value_text, value))}]"
    return f"{value:.6g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value).lower()
