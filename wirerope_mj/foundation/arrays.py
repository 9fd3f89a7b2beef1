"""The array types of the package's annotations; the shape stands in the docstring."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Integers = npt.NDArray[np.int64]
Booleans = npt.NDArray[np.bool_]
