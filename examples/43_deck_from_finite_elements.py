"""
A deck from finite elements
===========================

A deck plate of a few finite elements, its modes on held edges, and the block of ``shock_table`` on it: what a program
writes as eigenvectors and participations, ``wirerope flexible`` reads from OP2, OP4, universal, f06 and punch files or from tables.
"""

import matplotlib.pyplot as plt
import numpy as np
import scipy

import wirerope_mj as wr

# %%
# A square steel plate, clamped all round, of 12 x 12 elements after Bogner, Fox and Schmit: their shapes are products of
# Hermite's cubics, so that the plate's matrices are products of a beam's. Bending energy is D/2 times the integral of the square of
# w_xx + w_yy, since the edges are held.

n, side, thickness = 12, 3.0, 0.02  # elements along a side, m, m
rigidity, surface_mass = 210e9 * thickness**3 / (12.0 * (1.0 - 0.3**2)), 7850.0 * thickness  # N m, kg/m^2
h = side / n
to = np.diag([1.0, h, 1.0, h])  # slopes in units of the element


def along(element):
    """Return a beam's matrix of its elements, deflection and slope at every node."""
    whole = np.zeros((2 * n + 2, 2 * n + 2))
    for first in range(0, 2 * n, 2):
        whole[first : first + 4, first : first + 4] += to @ np.array(element) @ to
    return whole


curved = along([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) / h**3  # of second derivatives
sloped = along([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) / (30.0 * h)  # of first ones
heavy = along([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * h / 420.0
k1, g1, m1 = (one[2:-2, 2:-2] for one in (curved, sloped, heavy))  # held at both ends
stiffness = rigidity * (np.kron(k1, m1) + np.kron(m1, k1) + 2.0 * np.kron(g1, g1))
squares, shapes = scipy.linalg.eigh(stiffness, surface_mass * np.kron(m1, m1), subset_by_index=[0, 11])
frequencies = np.sqrt(squares) / (2.0 * np.pi)
clamped = 35.985 / side**2 * np.sqrt(rigidity / surface_mass) / (2.0 * np.pi)  # Leissa (1969): 35.99
print(f"{len(stiffness)} degrees of freedom, modes from {frequencies[0]:.3f} Hz, clamped square {clamped:.3f} Hz")
assert abs(frequencies[0] / clamped - 1.0) < 2e-4

# %%
# Participations are Phi^T M r of a unit motion of the edges; every site of a mount or a stop needs its point. All stand at the
# middle of the plate here.

rigid = wr.load_system("shock_table")
moved = (heavy @ np.tile([1.0, 0.0], n + 1))[2:-2]
gamma = surface_mass * shapes.T @ np.kron(moved, moved)
up, middle = np.array([0.0, 0.0, 1.0]), shapes[(n - 2) * len(k1) + n - 2]  # the deflection of the node in the middle
places = {mount.base_site: rigid.model.site(mount.base_site).pos for mount in rigid.mounts.values()}
deck = wr.FlexiblePart(
    frequencies=frequencies, damping=0.02, participation=np.outer(gamma, up), points=places,
    shapes={name: np.outer(middle, up) for name in places},
)  # fmt: skip
pulse = wr.HalfSine(peak=15.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.01)
print(f"{100.0 * (gamma**2).sum() / (surface_mass * side**2):.0f} % of the mass takes part")

# %%
# The block's acceleration on the rigid table, and on the deck by one mode and by all twelve.

decks = {"rigid": rigid, "one mode": wr.on_deck(rigid, deck.below(30.0)), "12 modes": wr.on_deck(rigid, deck)}
for label, system in decks.items():
    response = wr.simulate(system, pulse, duration=0.3)
    plt.plot(response.time, response.bodies["block"].acceleration[:, 2] / wr.STANDARD_GRAVITY, label=label)
plt.xlabel("time [s]")
plt.ylabel("acceleration of the block [g]")
plt.legend()
plt.show()
