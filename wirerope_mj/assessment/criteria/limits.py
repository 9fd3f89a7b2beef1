"""Limits of the payload by name, and the bodies that they are for."""

from collections.abc import Sequence

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.payload_limits import PayloadLimit


def payload_bodies(response: Response) -> list[str]:
    """Return the names of the bodies that move and are not fixed to the base, in the order of the scene."""
    return [body.name for body in response.scene.bodies if body.moves and not body.on_base]


def limits_by_name(
    response: Response,
    limits: Sequence[PayloadLimit] | None,
    kind: str,
    known: Sequence[str],
    others: Sequence[str] = (),
) -> dict[str, PayloadLimit]:
    """Return the limits of one kind by name: those given, else those of the model; `others` are not listed in an error.

    Raises:
        ValueError: a limit names nothing that is known.
    """
    chosen = [limit for limit in (response.scene.limits if limits is None else limits) if limit.kind == kind]
    for limit in chosen:
        if limit.name not in known and limit.name not in others:
            names = ", ".join(known) or "none"
            raise ValueError(f"`limits` name {limit.name!r}, which has no {kind} here. There are: {names}.")
    return {limit.name: limit for limit in chosen}
