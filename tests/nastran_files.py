"""Files as Nastran writes them, for tests: punched and printed eigenvectors, and the binary OP2 of matrices and of modes."""

import struct

import numpy as np


def punched(nodes, frequencies, shapes):
    """Return eigenvectors as Nastran punches them: cards of 80 columns, the last eight their numbers."""
    cards = [
        "$TITLE   = PLATE",
        "$SUBTITLE=",
        "$LABEL   =",
        "$EIGENVECTOR",
        "$REAL OUTPUT",
        "$SUBCASE ID =           1",
    ]
    for mode, frequency in enumerate(frequencies):
        cards.append(f"$EIGENVALUE = {(2 * np.pi * frequency) ** 2:14.7E}  MODE = {mode + 1:5d}")
        for n, node in enumerate(nodes.values()):
            cards.append(f"{node:10d}       G" + "".join(f"{value:18.6E}" for value in shapes[n, mode]))
            cards.append("-CONT-            " + f"{0.0:18.6E}" * 3)
    return "".join(f"{card:<72}{number:8d}\n" for number, card in enumerate(cards, 1))


def printed(nodes, frequencies, shapes):
    """Return an f06 file: pages of two grid points of an eigenvector each, and of forces of constraint between the modes."""
    lines, page = [], 0

    def begin(mode, frequency, title):
        nonlocal page
        page += 1
        lines.append(f"1    PLATE{'':60}JANUARY   1, 2025  NASTRAN   1/ 1/25   PAGE {page:5d}")
        lines.append("0" + " " * 20)
        lines.append(f"      EIGENVALUE = {(2 * np.pi * frequency) ** 2:13.6E}")
        lines.append(f"          CYCLES = {frequency:13.6E}         {title} {mode:10d}")
        lines.append(" ")
        lines.append("      POINT ID.   TYPE" + "".join(f"{name:>15}" for name in ("T1", "T2", "T3", "R1", "R2", "R3")))

    def row(node, values):
        cells = ["0.0" if value == 0.0 else f"{value:13.6E}" for value in (*values, 0.0, 0.0, 0.0)]
        lines.append(f"{node:14d}      G     " + "  ".join(f"{cell:<13}" for cell in cells))

    for mode, frequency in enumerate(frequencies):
        for n, node in enumerate(nodes.values()):
            if n % 2 == 0:
                begin(mode + 1, frequency, "R E A L   E I G E N V E C T O R   N O .")
            row(node, shapes[n, mode])
        begin(mode + 1, frequency, "F O R C E S   O F   S I N G L E - P O I N T   C O N S T R A I N T")
        row(7777, (1.0, 2.0, 3.0))
    return "\n".join([*lines, "1" + " " * 30 + "* * * END OF JOB * * *", ""])


def op2_of_matrices(**matrices):
    """Return an OP2 file (OUTPUT2) of matrices in double precision."""
    data = b""
    for name, matrix in matrices.items():
        data += _named(name, (101, matrix.shape[1], matrix.shape[0], 2, 2, 2 * len(matrix), 10000), 1)
        for column, values in enumerate(matrix.T):
            if column:
                data += _keys(1)
            data += _keys(1 + 2 * len(values)) + _record(struct.pack("<i", 1) + values.astype("<f8").tobytes())
            data += _keys(-4 - column, 1)
        data += _keys(0, 0)
    return data + _keys(0)


def op2_of_modes(nodes, frequencies, shapes, *, table="OUGV1", kind=7, approach=22):
    """Return an OP2 file (PARAM,POST,-1) with a table of real eigenvectors in single precision, and a scalar point in it."""
    data, marker = _named(table, (102, 0, 0, 0, 0, 0, 0), 0), -5
    for mode, frequency in enumerate(frequencies, 1):
        square = np.float32((2 * np.pi * frequency) ** 2)
        ident = struct.pack("<5if", approach, kind, 0, 1, mode, square) + struct.pack("<140i", *[0] * 140)
        rows = b"".join(
            struct.pack("<2i6f", 10 * node + 1, 1, *shapes[n, mode - 1], 0.0, 0.0, 0.0) for n, node in enumerate(nodes.values())
        ) + struct.pack("<2i6f", 10 * 99001 + 1, 2, 1.0, *[0.0] * 5)
        for record in (ident, rows):
            data += _keys(len(record) // 4) + _record(record) + _keys(marker, 1, 0)
            marker -= 1
    return data + _keys(0, 0)


def _record(data):
    size = struct.pack("<i", len(data))
    return size + data + size


def _keys(*numbers):
    return b"".join(_record(struct.pack("<i", number)) for number in numbers)


def _named(name, trailer, kind):
    """Return what begins a block: its name, its trailer, its name again and its kind, 1 of a matrix."""
    text = f"{name.upper():<8}".encode()
    return (
        _keys(2) + _record(text) + _keys(-1, 7) + _record(struct.pack("<7i", *trailer)) + _keys(-2, 1, 0, 2) + _record(text)
        + _keys(-3, 1, kind)
    )  # fmt: skip
