"""Edits of nested values and of bytes, as a slip of the hand or a bad copy makes them."""

import numpy as np


def anywhere(rng, content, first=None):
    """Return a table or list in nested values, a key of it, and the way there."""
    key = first if first is not None else list(content)[rng.integers(len(content))]
    where, holder = str(key), content
    while isinstance(holder[key], dict | list) and len(holder[key]) and rng.random() < 0.9:
        holder = holder[key]
        key = list(holder)[rng.integers(len(holder))] if isinstance(holder, dict) else int(rng.integers(len(holder)))
        where += f".{key}"
    return holder, key, where


def edit(rng, holder, key, *, toml=False):
    """Edit one value in place and return what was done."""
    value = holder[key]
    number = isinstance(value, float | int) and not isinstance(value, bool)
    kind = str(rng.choice(["number", "remove", "rename", "unknown", "retype", "nan", "huge", "path"] + ["number"] * 4 * number))
    if kind == "number" and number:
        holder[key] = float(value * 1.01 if value else 1e-2) if isinstance(value, float) else value + 1
        tiny = ", tiny" if 0.0 < abs(value) < 1e-3 else ""  # perhaps rounding next to what it is compared with
        return f"number {value} -> {holder[key]}{tiny}"
    if kind == "remove":
        del holder[key]
    elif kind == "rename" and isinstance(holder, dict):
        holder[f"{key}x"] = holder.pop(key)
    elif kind == "unknown":
        holder.update(strange=1) if isinstance(holder, dict) else holder.append(1.0)
    elif kind == "nan":
        holder[key] = float(rng.choice([np.nan, np.inf, -np.inf]))
    elif kind == "huge":
        holder[key] = [1e300, -1e300, 10**12, 0.0, -1.0, 1e-300, 2**62][rng.integers(7)]
    elif kind == "path":
        holder[key] = str(rng.choice(["../../other", "/etc/passwd", "", "\0", "a" * 5000, "report.html", "."]))
    else:
        choices = ["text", 3, 2.5, True, [], {}, [1.0, 2.0], {"a": 1}] + ([] if toml else [None])
        holder[key] = choices[rng.integers(len(choices))]
    after = holder.get(key, "") if isinstance(holder, dict) else ""
    return f"{kind} {str(value)[:30]} -> {str(after)[:30]}"


def damaged(rng, content):
    """Return bytes with some flipped, cut, doubled or zeroed."""
    kind, at = rng.integers(4), int(rng.integers(len(content)))
    size = int(rng.integers(1, 40))
    if kind == 0:
        return content[:at]
    if kind == 1:
        return content[:at] + bytes(rng.integers(0, 256, size, dtype=np.uint8)) + content[at + size :]
    if kind == 2:
        return content[:at] + bytes(size) + content[at + size :]
    return content[:at] + content[max(at - size, 0) : at] + content[at:]
