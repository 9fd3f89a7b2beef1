"""Values as JSON knows them."""

import math
from typing import Any


def json_values(value: Any) -> Any:
    """Return a value, or those in dictionaries and lists, as JSON knows them: floats that are NaN or infinite become None."""
    if isinstance(value, dict):
        return {name: json_values(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [json_values(item) for item in value]
    if isinstance(value, float):  # NumPy's double is one of them
        return float(value) if math.isfinite(value) else None
    return value
