"""A rectangular plate in finite elements, as an own reference: matrices, edges, and its mounts' points.

The element is that of Adini, Clough and Melosh with w, its slopes along x and y at four corners, and Kirchhoff's plate theory;
mass and stiffness are integrated by Gauss' rule.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

EXPONENTS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (3, 1), (1, 3)]


def terms(x, y, dx=0, dy=0):
    """Return the derivatives d^(dx + dy) / dx^dx dy^dy of the element's polynomials at a point, (12,)."""

    def derived(value, power, order):
        factor = 1.0
        for _ in range(order):
            factor, power = factor * power, power - 1
        return factor * value ** max(power, 0) if factor else 0.0

    return np.array([derived(x, i, dx) * derived(y, j, dy) for i, j in EXPONENTS])


def element(a, b, rigidity, nu, surface_mass):
    """Return mass and stiffness of an element of the size a by b, (12, 12) each."""
    corners = [(0.0, 0.0), (a, 0.0), (a, b), (0.0, b)]
    to_terms = np.linalg.inv([terms(x, y, *order) for x, y in corners for order in ((0, 0), (1, 0), (0, 1))])
    bending = rigidity * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
    mass, stiffness = np.zeros((12, 12)), np.zeros((12, 12))
    points, weights = np.polynomial.legendre.leggauss(4)
    for x, wx in zip(0.5 * a * (points + 1), 0.5 * a * weights, strict=True):
        for y, wy in zip(0.5 * b * (points + 1), 0.5 * b * weights, strict=True):
            shape = terms(x, y) @ to_terms
            curvature = np.array([terms(x, y, 2, 0), terms(x, y, 0, 2), 2.0 * terms(x, y, 1, 1)]) @ to_terms
            mass += wx * wy * surface_mass * np.outer(shape, shape)
            stiffness += wx * wy * curvature.T @ bending @ curvature
    return mass, stiffness


@dataclass(frozen=True)
class Plate:
    """A plate on its edges: matrices of the free degrees of freedom, M r of a unit motion of the edges, where w stands."""

    mass: np.ndarray
    stiffness: np.ndarray
    force: np.ndarray  # M r, (n,)
    deflection: dict  # number of w among the free degrees of freedom, by (x, y) as node numbers

    def modes(self, count):
        """Return angular frequencies, (count,), mass-normalised shapes, (n, count), and participations, (count,)."""
        values, shapes = scipy.linalg.eigh(self.stiffness, self.mass, subset_by_index=[0, count - 1])
        return np.sqrt(values), shapes, shapes.T @ self.force


def whole_plate(a, b, thickness, nx, ny, *, modulus=210e9, nu=0.3, density=7850.0):
    """Return mass and stiffness of a steel plate of nx by ny elements without edges, w and its slopes node by node."""
    rigidity = modulus * thickness**3 / (12.0 * (1.0 - nu**2))
    one = element(a / nx, b / ny, rigidity, nu, density * thickness)
    n = 3 * (nx + 1) * (ny + 1)
    mass, stiffness = np.zeros((n, n)), np.zeros((n, n))

    def node(i, j):
        return i + (nx + 1) * j

    for i in range(nx):
        for j in range(ny):
            nodes = (node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1))
            dofs = np.concatenate([3 * number + np.arange(3) for number in nodes])
            mass[np.ix_(dofs, dofs)] += one[0]
            stiffness[np.ix_(dofs, dofs)] += one[1]
    return mass, stiffness


def plate(a, b, thickness, nx, ny, *, clamped):
    """Return a steel plate of nx by ny elements on clamped or simply supported edges."""
    mass, stiffness = whole_plate(a, b, thickness, nx, ny)
    n = len(mass)

    def node(i, j):
        return i + (nx + 1) * j

    held = set()
    for i in range(nx + 1):
        for j in range(ny + 1):
            on_x, on_y = i in (0, nx), j in (0, ny)  # along an edge w and the slope along it vanish
            if on_x or on_y:
                held |= {3 * node(i, j)}
                held |= {3 * node(i, j) + 2} if on_x or clamped else set()
                held |= {3 * node(i, j) + 1} if on_y or clamped else set()
    free = np.array(sorted(set(range(n)) - held))
    rigid = np.zeros(n)
    rigid[::3] = 1.0
    places = {(i, j): 3 * node(i, j) for i in range(nx + 1) for j in range(ny + 1)}
    numbers = {dof: number for number, dof in enumerate(free.tolist())}
    return Plate(
        mass[np.ix_(free, free)], stiffness[np.ix_(free, free)], (mass @ rigid)[free],
        {place: numbers[dof] for place, dof in places.items() if dof in numbers},
    )  # fmt: skip
