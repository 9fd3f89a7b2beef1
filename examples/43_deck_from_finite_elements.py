"""
A deck from finite elements
===========================

The modes of a plate of own finite elements, and the block of ``shock_table`` on it: what a program writes as eigenvectors and
participations, ``wirerope flexible`` reads from files of many kinds.
"""

import matplotlib.pyplot as plt
import numpy as np
import scipy

import wirerope_mj as wr

# %%
# A square steel plate, clamped all round, of 12 x 12 elements after Bogner, Fox and Schmit: their shapes are products of
# Hermite's cubics, so that the plate's matrices are products of a beam's. Where all edges are held, the bending energy is D/2
# times the integral of the square of w_xx + w_yy.

n, side, thickness = 12, 3.0, 0.02  # elements along a side, m, m
rigidity, surface_mass = 210e9 * thickness**3 / (12.0 * (1.0 - 0.3**2)), 7850.0 * thickness  # N m, kg/m^2
h = side / n
to = np.diag([1.0, h, 1.0, h])  # slopes in units of the element
curved, sloped, heavy = np.zeros((3, 2 * n + 2, 2 * n + 2))  # of second and first derivatives, of deflections
for e in (slice(first, first + 4) for first in range(0, 2 * n, 2)):
    curved[e, e] += to @ [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]] @ to / h**3
    sloped[e, e] += to @ [[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]] @ to / (30.0 * h)
    heavy[e, e] += to @ [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]] @ to * h / 420.0
k, g, m = (one[2:-2, 2:-2] for one in (curved, sloped, heavy))  # held at both ends
stiffness = rigidity * (np.kron(k, m) + np.kron(m, k) + 2.0 * np.kron(g, g))
squares, shapes = scipy.linalg.eigh(stiffness, surface_mass * np.kron(m, m), subset_by_index=[0, 11])
frequencies = np.sqrt(squares) / (2.0 * np.pi)
clamped = 35.985 / side**2 * np.sqrt(rigidity / surface_mass) / (2.0 * np.pi)  # Leissa (1969): 35.99
assert abs(frequencies[0] / clamped - 1.0) < 2e-4

# %%
# Participations are Phi^T M r of a unit motion of the edges. All mounts and stops stand at the middle of the plate here.

rigid = wr.load_system("shock_table")
moved = (heavy @ np.tile([1.0, 0.0], n + 1))[2:-2]
gamma = surface_mass * shapes.T @ np.kron(moved, moved)
up, middle = np.array([0.0, 0.0, 1.0]), shapes[(n - 2) * len(k) + n - 2]  # the deflection of the node in the middle
places = {mount.base_site: rigid.model.site(mount.base_site).pos for mount in rigid.mounts.values()}
where = {"points": places, "shapes": {name: np.outer(middle, up) for name in places}}
deck = wr.FlexiblePart(frequencies=frequencies, damping=0.02, participation=np.outer(gamma, up), **where)
pulse = wr.HalfSine(peak=8.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.01)
for label, base in {"rigid": None, "12 modes": deck}.items():
    response = wr.simulate(wr.on_deck(rigid, base) if base else rigid, pulse, duration=0.3)
    plt.plot(response.time, response.bodies["block"].acceleration[:, 2] / wr.STANDARD_GRAVITY, label=label)
plt.xlabel("time [s]")
plt.ylabel("acceleration of the block [g]")
plt.legend()
plt.show()
