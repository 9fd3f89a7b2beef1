"""The types that annotations share: arrays, whose shape stands in the docstring, and tables that are not checked yet."""

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Integers = npt.NDArray[np.int64]
Booleans = npt.NDArray[np.bool_]
AnyArray = npt.NDArray[Any]  # of numbers or of texts
ArrayLike = npt.ArrayLike  # what NumPy makes an array of
# A table of TOML or JSON, options of a command, arguments to pass on: of any type until the code that takes them checks them.
Entries = dict[str, Any]
