"""
A bump stop and its energy
==========================

A block strikes its stop. How deep does it go, with what acceleration, and with what speed does it come back?
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The block of 50 kg of ``shock_table`` on a spring of 60 kN/m with a stop of 1 MN/m after 20 mm. A push and its return
# give back ``(1 - loss) / (1 + loss)`` of the energy in the stop: 54 % with a loss of 0.3.

mass, k, stiff, gap, loss, velocity = 50.0, 60e3, 1e6, 20e-3, 0.3, 1.0
g = wr.STANDARD_GRAVITY


def strike(loss):
    """Return the response of the block to a velocity step of its base."""
    stop = wr.Stop(gap_below=gap, k=stiff / (1.0 + loss), loss=loss, reversal=1e-5 if loss else None)
    isolator = wr.Isolator(name="with stop", axial=wr.Parallel(laws=(wr.KelvinVoigt(k=k, c=0.0), stop)))
    system = wr.load_system("shock_table", isolators={"wr12_400": isolator})
    step = wr.VelocityStep(velocity=velocity, direction="z", start=0.01)
    return wr.simulate(system, step, duration=0.12, timestep=2e-5, sample_rate=5000.0)


elastic, lossy = strike(0.0), strike(loss)

# %%
# By hand: kinetic energy and work of the weight from the sag on, against the energy of spring and stop.

sag = mass * g / k
# k x^2 / 2 + stiff (x - gap)^2 / 2 - m g x = m v^2 / 2 - k sag^2 / 2, a quadratic equation for the compression x
constant = (stiff * gap**2 + k * sag**2 - mass * velocity**2) / 2.0
deepest = max(np.roots([(k + stiff) / 2.0, -stiff * gap - mass * g, constant]))
found = -elastic.peaks.mounts["m1"].deflection.minimum[2]
print(f"deepest {1e3 * found:.4f} mm, by hand {1e3 * deepest:.4f} mm")
assert np.isclose(found, deepest, rtol=1e-4)
assert np.isclose(elastic.peaks.bodies["block"].acceleration.value, (k * deepest + stiff * (deepest - gap)) / mass - g)

# %%
# With the loss the push is the same, and the block comes back with the energy less 46 % of what the stop took.

returned = np.abs((lossy.bodies["block"].velocity - lossy.base.velocity)[:, 2])[lossy.time > 0.06].max()
kept = velocity**2 - (1.0 - 0.7 / 1.3) * stiff * (deepest - gap) ** 2 / mass
print(f"comes back with {returned:.4f} m/s, by hand {np.sqrt(kept):.4f} m/s")
assert np.isclose(returned, np.sqrt(kept), rtol=5e-3)

# %%
for one, name in ((elastic, "elastic stop"), (lossy, "stop with a loss of 0.3")):
    plt.plot(1e3 * one.mounts["m1"].deflection[:, 2], 1e-3 * one.mounts["m1"].force[:, 2], label=name)
plt.xlabel("deflection [mm]")
plt.ylabel("force [kN]")
plt.legend()
plt.show()
