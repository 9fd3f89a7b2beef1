"""
Design accelerations of modes after DDAM
========================================

Some ship specifications ask for no motion at all: every mode of the equipment gets a design acceleration, by its
modal weight and its frequency.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The six modes of the shipped rack of 850 kg, and what each of them moves vertically. The modal weights of all modes add
# up to the weight.

modes = wr.modes(wr.load_system("cabinet"))
weight = 850.0 * wr.STANDARD_GRAVITY * modes.participation[:, 2]
assert np.isclose(weight.sum(), 850.0 * wr.STANDARD_GRAVITY)

# %%
# By hand, for equipment on a deck and the vertical: :math:`A_0 = 10 (37.5 + W)(12 + W) / (6 + W)^2` g and :math:`V_0 =
# 30 (12 + W) / (6 + W)` inches a second, W in kip; these are the unclassified interim values of NRL memorandum 1396.
# The smaller of A0 and V0 omega counts, but not less than 6 g.

kip, inch, g = 4448.22, 0.0254, wr.STANDARD_GRAVITY


def by_hand(weight, frequency):
    """Return the design acceleration [m/s^2]."""
    w = weight / kip
    a0 = 10.0 * (37.5 + w) * (12.0 + w) / (6.0 + w) ** 2 * g
    v0 = 30.0 * (12.0 + w) / (6.0 + w) * inch
    return np.maximum(np.minimum(a0, v0 * 2.0 * np.pi * frequency), 6.0 * g)


design = {"location": "deck", "direction": "vertical"}
for one, frequency, text in zip(weight, modes.frequencies, modes.descriptions, strict=True):
    found = wr.ddam_design_values(max(one, 1e-3), frequency, **design).acceleration
    print(f"{frequency:6.2f} Hz {one:8.1f} N {found / g:6.2f} g  {text}")
    assert np.isclose(found, by_hand(one, frequency), rtol=1e-5)
assert np.isclose(by_hand(kip, 1e4) / g, 102.1, atol=0.05)  # the values usually quoted for one kip are 102 g ..
assert np.isclose(by_hand(kip, 20.0) / (2.0 * np.pi * 20.0) / inch, 55.7, atol=0.05)  # .. and 55.7 in/s

# %%
f = np.geomspace(1.0, 300.0, 200)
for tons in (0.1, 1.0, 10.0):
    values = [wr.ddam_design_values(1e3 * tons * g, one, **design).acceleration / g for one in f]
    plt.loglog(f, values, label=f"{tons:g} t")
plt.loglog(modes.frequencies, by_hand(weight, modes.frequencies) / g, "ko", label="modes of the rack")
plt.xlabel("frequency of the mode [Hz]")
plt.ylabel("design acceleration [g]")
plt.legend()
plt.show()
