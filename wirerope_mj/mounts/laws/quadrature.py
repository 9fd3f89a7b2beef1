"""Gauss and Legendre's rule of eight points between 0 and 1, exact for polynomials of degree 15.

That covers the power of a cubic spring along a cubic path, which has degree 11.
"""

import numpy as np

_HALVES = np.array([0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623])
_HALF_WEIGHTS = np.array([0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626])

NODES = 0.5 * np.concatenate([1.0 - _HALVES[::-1], 1.0 + _HALVES])
WEIGHTS = 0.5 * np.concatenate([_HALF_WEIGHTS[::-1], _HALF_WEIGHTS])
