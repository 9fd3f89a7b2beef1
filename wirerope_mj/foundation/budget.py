"""Budgets of computations: memory, disk and time are estimated before the start, and refused above a limit."""

import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from wirerope_mj.foundation.errors import BudgetError

# Of the memory that is free: what is made of the numbers, sorted, drawn and written, takes as much again.
MEMORY_SHARE = 0.5
# Of the disk that is free: report, recording and pictures go beside the samples.
DISK_SHARE = 0.9
# Time of a step of one system at the least [s]: of those that stand side by side in the kernel, on a few cores. A system
# alone takes 1 to 3 us, MuJoCo ten times as much; so what is refused would have taken longer than is said.
STEP = 1e-7
# Time of a computation at the most [s]: a week.
LONGEST = 7 * 86_400.0
# Free memory where the system does not say [B]: a small computer's.
UNKNOWN_MEMORY = 4e9

_MEMINFO = Path("/proc/meminfo")
_GROUPS = (
    (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory.current")),
    (Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"), Path("/sys/fs/cgroup/memory/memory.usage_in_bytes")),
)
_UNITS = ("B", "kB", "MB", "GB", "TB", "PB", "EB")


def require_memory(subject: str, size: float, remedy: str) -> None:
    """Raise BudgetError if numbers of at least `size` [B] need more memory than is available.

    The message begins with the `subject` that takes it, as "the samples of this run", and ends with the `remedy`, a sentence.
    """
    if size < 1e6:
        return  # nobody need look
    free = _free_memory()
    if size > MEMORY_SHARE * free:
        raise BudgetError(
            f"{subject} would take {bytes_text(size)} of memory; the limit is {bytes_text(MEMORY_SHARE * free)}, "
            f"{MEMORY_SHARE:.0%} of what is free. {remedy}"
        )


def require_disk(subject: str, size: float, folder: Path, remedy: str) -> None:
    """Raise BudgetError if a file of at most `size` [B] may need more disk than is free where its folder is."""
    existing = next((path for path in (folder, *folder.absolute().parents) if path.is_dir()), Path())
    free = shutil.disk_usage(existing).free
    if size > DISK_SHARE * free:
        raise BudgetError(
            f"{subject} may take up to {bytes_text(size)} of disk; the limit is {bytes_text(DISK_SHARE * free)}, "
            f"{DISK_SHARE:.0%} of what is free. {remedy}"
        )


def require_time(subject: str, steps: float, remedy: str, *, step: float = STEP) -> None:
    """Raise BudgetError if a number of steps, each `step` [s] of computing, takes longer than `LONGEST`.

    `subject` and `remedy` are those of `require_memory`.
    """
    seconds = step * steps
    if seconds > LONGEST:
        raise BudgetError(
            f"{subject} would take {steps:.2g} steps, {seconds / 86_400.0:.3g} days of computing at the very least; the limit "
            f"is {LONGEST / 86_400.0:.0f} days. {remedy}"
        )


def memory_taken() -> float:
    """Return the most memory that this process has had so far [B]; 0 where the system does not say."""
    try:
        import resource
    except ImportError:  # Windows
        return 0.0
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(most) if sys.platform == "darwin" else 1024.0 * most


def bytes_text(size: float) -> str:
    """Format a size in bytes with a suitable unit: 7.2 TB."""
    power = 0
    while size >= 999.5 and power < len(_UNITS) - 1:
        size, power = size / 1e3, power + 1
    return f"{size:.3g} {_UNITS[power]}"


def _free_memory() -> float:
    return min(_limits(), default=UNKNOWN_MEMORY)


def _limits() -> Iterator[float]:
    """Yield the memory that the system, its control groups and the limits of this process leave free [B]."""
    try:
        lines = dict(line.split(":", 1) for line in _MEMINFO.read_text(encoding="ascii").splitlines() if ":" in line)
        yield 1024.0 * float(lines["MemAvailable"].split()[0])
    except (OSError, KeyError, ValueError):  # no Linux: all that is built in
        if "SC_PHYS_PAGES" in getattr(os, "sysconf_names", ()):
            yield float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for most, used in _GROUPS:
        try:
            yield max(float(most.read_text(encoding="ascii")) - float(used.read_text(encoding="ascii")), 0.0)
        except (OSError, ValueError):  # no such group, or "max"
            continue
    try:
        import resource
    except ImportError:  # Windows
        return
    soft = resource.getrlimit(resource.RLIMIT_AS)[0]
    if soft != resource.RLIM_INFINITY:
        yield float(soft)
