"""Base motions as commands and files of jobs say them: phrases, files of levels and a record added."""

from collections.abc import Sequence
from pathlib import Path

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.directions import direction_in
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions import BaseMotion, load_record
from wirerope_mj.motions.records.record import Record, record_channels
from wirerope_mj.motions.restore import motion_of_levels
from wirerope_mj.motions.spoken import motion_from_phrase

# What is said of how a record is played, beside its channels and their directions, as `load_record` takes it.
PLAYED = ("scale", "baseline", "start", "highpass", "resample", "gaps", "unit")


def said_motion(
    phrases: Sequence[tuple[str, str]], *, levels: Sequence[Path] = (), record: Path | None = None,
    channels: Sequence[str] | None = None, direction: str | None = None, played: Entries | None = None,
    duration: float | None = None, folder: Path | None = None,
) -> BaseMotion:  # fmt: skip
    """Add the motions of phrases, each a kind of `SPOKEN_MOTIONS` and a text, of files of levels and of a measured record.

    `channels` of the record are those to use, NAME=DIRECTION, or one with a `direction`; it is `played` as `load_record`
    takes it, by the names of `PLAYED`, and must begin within the `duration` of the simulation [s], if that is known.
    Relative paths in phrases start at `folder`, else at the current one.

    ValueError if nothing is said, a phrase is not understood, or the record would not move the base; ModelError or
    RecordError if a file cannot be read, or does not hold what it must.
    """
    motions = [motion_from_phrase(kind, phrase, folder=folder) for kind, phrase in phrases]
    motions += [motion_of_levels(file) for file in levels]
    if record is not None:
        one = load_record(record, channels=_channels(record, channels, direction), **(played or {}))
        _check_that_it_moves(record, one, duration)
        motions.append(one)
    elif channels is not None or direction is not None:
        raise ValueError("`direction` and `channels` belong to a `record`; other motions say their direction.")
    return sum(motions[1:], start=motions[0])


def _check_that_it_moves(path: Path, motion: Record, duration: float | None) -> None:
    """Raise an error for a record that would leave the base at rest all the time."""
    if not motion.samples.any():
        zero = "all of its samples are zero" if motion.baseline == "none" else "nothing but zeros is left of it"
        raise RecordError(f"{path}: {zero}, so that the base would not move. Is it the right file, and the right channel?")
    if motion.end <= 0.0:
        raise ValueError(
            f"`start` {motion.start:g} lets the record end at {motion.end:g} s, before the simulation begins at 0 s: the "
            "base would not move. Start it at 0 s or later."
        )
    if duration is not None and duration <= motion.start:
        text = f"`duration` {duration:g} ends the simulation before the record begins, at {motion.start:g} s (`start`)."
        raise ValueError(text)


def _channels(record: Path, channels: Sequence[str] | None, direction: str | None) -> Entries | None:
    """Return which channel moves the base in which direction; None leaves it to their names."""
    if channels is None and direction is None:
        return None
    if channels is not None and direction is None:
        pairs = [item.rpartition("=") for item in channels]
        for item, (name, _, _) in zip(channels, pairs, strict=True):
            if not name:
                raise ValueError(f"`channels` are NAME=DIRECTION, for instance ch3=z, got {item!r}.")
        return {name: direction_in(text, "channels") for name, _, text in pairs}
    names = tuple(channels) if channels is not None else record_channels(record)
    if len(names) != 1 or "=" in names[0]:
        raise ValueError(
            f"`direction` turns a record of one channel, and here are {', '.join(names) or 'none'}. Say where each one "
            f"goes in `channels`, for instance {(names or ('ch1',))[0].partition('=')[0]}=z, or name one channel with a "
            "`direction`."
        )
    assert direction is not None
    return {names[0]: direction_in(direction, "direction")}
