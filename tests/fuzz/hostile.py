"""Values and damage that inputs of any kind are mutated with."""

NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e30",
    "1e9",
    "-1e9",
    "1e-9",
    "1e-300",
    "0",
    "-0.0",
    "-1",
    "1e400",
    "1_0",
)
"""Numbers as text."""

WORDS = (
    "",
    "x",
    "true",
    "0x10",
    "1,5",
    "55 mm",
    "Ünïcode",
    "a b",
    "../..",
    "None",
    "-",
    "[1, 2]",
    "&amp;",
    "mount/",
    "9" * 400,
)
"""What is no number."""


def damaged(text: bytes, rng) -> bytes:
    """Return `text` with a few bytes changed, left out, repeated, or cut off."""
    data = bytearray(text)
    for _ in range(int(rng.integers(1, 5))):
        place, kind = int(rng.integers(len(data))), rng.integers(6)
        if kind == 0:
            data[place] = int(rng.integers(256))
        elif kind == 1:
            data[place] ^= 1 << int(rng.integers(8))
        elif kind == 2:
            del data[place : place + int(rng.integers(1, 30))]
        elif kind == 3:
            data[place:place] = data[place : place + int(rng.integers(1, 200))]
        elif kind == 4:
            data[place:place] = bytes(rng.integers(256, size=int(rng.integers(1, 4)), dtype="uint8"))
        elif rng.random() < 0.3:
            del data[place:]
        if not data:
            data = bytearray(b" ")
    return bytes(data)


def pick(rng, values):
    """Return one of `values`."""
    return values[int(rng.integers(len(values)))]
