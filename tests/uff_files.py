"""Universal files for tests, written by hand from the format's description, not by the reader under test."""

import struct

import numpy as np

END = {"x": 1, "y": 2, "z": 3, "-x": -1, "-y": -2, "-z": -3, "rz": 6, "scalar": 0}


def history(node, end, values, *, step=1e-3, times=None, unit="NONE", kind=12, function=1, binary=False, count=None):
    """Returns dataset 58 of a function at a nodal degree of freedom, as bytes.

    Args:
        node, end: response node and direction, of `END`.
        values: ordinates.
        step: interval of the abscissa [s].
        times: instants of an uneven abscissa; None: even.
        unit: label of the ordinate's unit.
        kind: specific data type of the ordinate; 12 is acceleration.
        function: type; 1 is a time response.
        binary: whether values are written as 64-bit numbers.
        count: of values in the header; None: as many as there are.
    """
    values = np.asarray(values, dtype=float)
    even = times is None
    numbers = values if even else np.column_stack([times, values]).ravel()
    mark = f"b{1:6d}{2:6d}{11:12d}{8 * numbers.size:12d}{0:6d}{0:6d}{0:12d}{0:12d}" if binary else ""
    head = [
        f"{-1:6d}",
        f"{58:6d}{mark}",
        *(text.ljust(80) for text in ("a shock", "NONE", "21-NOV-26 13:00:00", "NONE", "NONE")),
        f"{function:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{node:10d}{END[end]:4d} {'NONE':10s}{0:10d}{0:4d}",
        f"{4:10d}{values.size if count is None else count:10d}{int(even):10d}{0.0:13.5e}{step * even:13.5e}{0.0:13.5e}",
        f"{17:10d}{0:5d}{0:5d}{0:5d} {'time':20s} {'s':20s}",
        f"{kind:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {unit:20s}",
        f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}",
        f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}",
    ]
    text = "\n".join(head).encode() + b"\n"
    if binary:
        return text + struct.pack(f"<{numbers.size}d", *numbers) + b"    -1\n"
    widths = ["20.11e"] if even else ["13.5e", "20.11e"]
    cells = [f"{number:{widths[i % len(widths)]}}" for i, number in enumerate(numbers)]
    rows = ["".join(cells[i : i + 4]) for i in range(0, len(cells), 4)]
    return text + "\n".join(rows).encode() + b"\n    -1\n"


def units(code, length):
    """Returns dataset 164: a code of a system of units, and how many of its units of length are in a metre."""
    factors = "".join(f"{number:25.17e}".replace("e", "D") for number in (length, 1.0, 1.0))
    return f"{-1:6d}\n{164:6d}\n{code:10d}{'a system':20s}{1:10d}\n{factors}\n{0.0:25.17e}\n{-1:6d}\n".encode()
