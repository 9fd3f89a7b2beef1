"""
From a data sheet to a law
==========================

A vendor states two stiffnesses: one for vibration, one for shock. The catalogue's isolators are laws fitted to them.
This looks up both in the law, and shows why two numbers are needed.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# ITT Enidine's WR16-400: in compression 613 N/mm for vibration, 278 N/mm for shock over the rated travel of 43.2 mm,
# static load 2869 N. The vendor does not say at what amplitude the first holds; 7 % of the travel is taken for it.

isolator = wr.load_isolator("enidine_wr16_400")
law, travel = isolator.axial, 43.2e-3
assert isolator.limits.travel.compression == travel
assert isolator.limits.static_load == 2869.0

# %%
# Vibration: the secant of a steady loop. Shock: force over travel when the mount is pressed for the first time.

vibration = wr.cyclic_test(law, [0.07 * travel])[0].secant_stiffness
press = law.trace(np.linspace(0.0, -travel, 400))
shock = press.force[-1] / press.deflection[-1]
print(f"vibration {1e-3 * vibration:.1f} kN/m (613), shock {1e-3 * shock:.1f} kN/m (278)")
assert np.isclose(vibration, 613e3, rtol=1e-3)
assert np.isclose(shock, 278e3, rtol=1e-3)

# %%
# Between the two the stiffness of a steady loop falls with its amplitude, as ropes slip more. The damping ratio at
# 1 mm is 10 %; the vendor says 5 to 15 % for the series.

amplitudes = np.geomspace(0.2e-3, 20e-3, 25)
loops = wr.cyclic_test(law, amplitudes)
secants = np.array([loop.secant_stiffness for loop in loops])
assert np.isclose(wr.cyclic_test(law, [1e-3])[0].damping_ratio, 0.103, atol=0.001)
assert (np.diff(secants[amplitudes < 10e-3]) < 0.0).all()

# %%
plt.semilogx(1e3 * amplitudes, 1e-3 * secants, label="steady loops")
plt.plot(70.0 * travel, 613.0, "o", color="C3", label="vibration stiffness of the data sheet")
plt.axhline(278.0, color="0.6", label="shock stiffness of the data sheet")
plt.xlabel("amplitude [mm]")
plt.ylabel("stiffness [kN/m]")
plt.ylim(0.0, 1150.0)
plt.legend(loc="lower left")
plt.show()
