"""The array types of the package's annotations; the shape stands in the docstring."""

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Integers = npt.NDArray[np.int64]
Booleans = npt.NDArray[np.bool_]
AnyArray = npt.NDArray[Any]  # of numbers or of texts
