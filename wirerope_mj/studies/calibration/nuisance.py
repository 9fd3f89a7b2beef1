"""Faults of measuring chains that a calibration may find along with the system: gain, delay and offset of channels."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.studies.inputs.distributions import Distribution, Normal, Uniform

# Names of such quantities; NAME may hold * and ? and matches channels with or without their test's name
FORM = "channel/NAME/gain, channel/NAME/delay, channel/NAME/offset"

UNITS = {"gain": "", "delay": "s", "offset": "SI"}
NEUTRAL = {"gain": 1.0, "delay": 0.0, "offset": 0.0}

_NAME = re.compile(r"channel/(.*)/(gain|delay|offset)")


@dataclass(frozen=True, kw_only=True)
class Nuisance:
    """One number of measuring chains."""

    name: str  # as in `vary`, each channel's own where each has one
    kind: str  # "gain", "delay" or "offset"
    channels: tuple[int, ...]  # numbers of those that have it
    distribution: Normal | Uniform  # of its values


def nuisances(vary: Mapping[str, Distribution], channels: Sequence[str]) -> list[Nuisance]:
    """Return the numbers of measuring chains among the quantities that vary.

    Raises:
        ModelError: a name matches no channel.
        ValueError: a distribution is not Normal or Uniform, or relative.
    """
    found = []
    for name, distribution in vary.items():
        if not name.startswith("channel/"):
            continue
        match = _NAME.fullmatch(name)
        if match is None:
            raise ModelError(f"`vary`: there is no quantity {name!r} of a channel; there is {FORM}.")
        pattern, kind = match.groups()
        matched = [
            k
            for k, one in enumerate(channels)
            if fnmatchcase(one, pattern) or fnmatchcase(one.partition("/")[2], pattern)
        ]
        if not matched:
            raise ModelError(f"`vary`: {name!r}: there is no channel {pattern!r}. There is: {', '.join(channels)}.")
        if not isinstance(distribution, Normal | Uniform) or distribution.relative:
            raise ValueError(f"`vary`: {name!r} must be a Normal or a Uniform, not relative, got {distribution!r}.")
        groups = [(k,) for k in matched] if distribution.each else [tuple(matched)]
        found += [
            Nuisance(
                name=f"channel/{channels[own[0]]}/{kind}" if distribution.each else name, kind=kind, channels=own,
                distribution=distribution,
            )
            for own in groups
        ]  # fmt: skip
    return found


def chains(found: Sequence[Nuisance], values: Array, channels: int) -> dict[str, Array]:
    """Return gain [-], delay [s] and offset [SI] of every channel, (n, n_channels) each, from values (n, n_nuisances)."""
    chain = {kind: np.full((len(values), channels), neutral) for kind, neutral in NEUTRAL.items()}
    for one, column in zip(found, values.T, strict=True):
        for k in one.channels:
            if one.kind == "gain":
                chain[one.kind][:, k] *= column
            else:
                chain[one.kind][:, k] += column
    return chain
