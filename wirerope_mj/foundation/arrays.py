"""The array type of the package's annotations."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
"""Numbers of double precision; the shape stands in the docstring."""
