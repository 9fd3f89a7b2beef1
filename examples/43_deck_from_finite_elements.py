"""
A deck from finite elements
===========================

A deck beam of a few finite elements, its modes on held ends, and the block of ``shock_table`` on it: what a program writes as
eigenvectors and participations, ``wirerope flexible`` reads from OP4, universal and punch files or from tables like these.
"""

import matplotlib.pyplot as plt
import numpy as np
import scipy

import wirerope_mj as wr

# %%
# Twenty beam elements of Hermite's cubics, 4 m long, with deflection and slope at every node; both ends are held.

n, length, bending, line_mass = 20, 4.0, 4.0e5, 60.0  # elements, m, N m^2, kg/m
h = length / n
to = np.diag([1.0, h, 1.0, h])  # slopes in units of the element
stiff = bending / h**3 * to @ [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]] @ to
heavy = line_mass * h / 420 * to @ [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]] @ to
k, m = np.zeros((2, 2 * n + 2, 2 * n + 2))
for first in range(0, 2 * n, 2):
    k[first : first + 4, first : first + 4] += stiff
    m[first : first + 4, first : first + 4] += heavy
squares, shapes = scipy.linalg.eigh(k[2:-2, 2:-2], m[2:-2, 2:-2], subset_by_index=[0, 7])
frequencies = np.sqrt(squares) / (2.0 * np.pi)
clamped = 4.730041**2 / length**2 * np.sqrt(bending / line_mass) / (2.0 * np.pi)  # closed form of the lowest
print(f"modes from {frequencies[0]:.2f} Hz, clamped beam {clamped:.2f} Hz")
assert abs(frequencies[0] / clamped - 1.0) < 1e-4

# %%
# Participations are Phi^T M r of a unit motion of the ends; every site of a mount or a stop needs its point. All stand at the
# middle of the beam here.

rigid = wr.load_system("shock_table")
gamma = shapes.T @ (m @ np.tile([1.0, 0.0], n + 1))[2:-2]
up, middle = np.array([0.0, 0.0, 1.0]), shapes[n - 2]  # the deflection of node n / 2
places = {mount.base_site: rigid.model.site(mount.base_site).pos for mount in rigid.mounts.values()}
deck = wr.FlexiblePart(
    frequencies=frequencies, damping=0.02, participation=np.outer(gamma, up), points=places,
    shapes={name: np.outer(middle, up) for name in places},
)  # fmt: skip
pulse = wr.HalfSine(peak=15.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.01)
print(f"{100.0 * (gamma**2).sum() / (line_mass * length):.0f} % of the mass takes part")

# %%
# The block's acceleration on the rigid table, and on the deck by one mode and by all eight.

decks = {"rigid": rigid, "one mode": wr.on_deck(rigid, deck.below(20.0)), "8 modes": wr.on_deck(rigid, deck)}
for label, system in decks.items():
    response = wr.simulate(system, pulse, duration=0.3)
    plt.plot(response.time, response.bodies["block"].acceleration[:, 2] / wr.STANDARD_GRAVITY, label=label)
plt.xlabel("time [s]")
plt.ylabel("acceleration of the block [g]")
plt.legend()
plt.show()
