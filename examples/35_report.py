"""
From a shock to a report and a recording
========================================

A run becomes a folder: samples, verdicts, a page that is handed over, a recording to scrub through. This writes one to a
temporary folder and reads it back.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A scenario says model, motion and how long. The rack of 850 kg under a sawtooth of 10 g.

scenario = wr.Scenario(
    question="Does the rack keep its limit of 10 g?",
    model="cabinet.xml",
    motion=wr.Sawtooth(peak=10.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.02),
    simulate={"duration": 0.3, "accuracy": 1e-3},
)
with tempfile.TemporaryDirectory() as parent:
    folder = Path(parent, "run")
    response = wr.run_scenario(scenario, folder)  # the same as wr.load_response(folder), later
    verdicts = wr.judge(response)
    sizes = {path.name: path.stat().st_size for path in folder.iterdir() if path.is_file()}
    page = (folder / "report.html").read_text(encoding="utf-8")
    time, history = response.time, response.bodies["rack"].acceleration[:, 2]
    repeated = wr.replay(folder)
print({name: f"{size / 1024:.0f} kB" for name, size in sorted(sizes.items())})
assert {"report.html", "run.rrd", "response.parquet", "summary.json"} <= set(sizes)

# %%
# The verdict is the largest acceleration of all steps over 10 g. The page says what the numbers say.

peak = response.peaks.bodies["rack"].acceleration.value
verdict = next(one for one in verdicts if one.criterion == "acceleration" and one.subject == "rack")
print(f"{peak / wr.STANDARD_GRAVITY:.2f} g of 10 g: {verdict.verdict}")
assert np.isclose(verdict.utilisation, peak / 98.0665)
assert (verdict.verdict == "within") == (peak < 98.0665)
assert np.abs(history).max() <= peak
assert "Does the rack keep its limit of 10 g?" in page

# %%
# The folder holds all that it takes to compute the run again, to the last bit.

print(repeated)
assert repeated.identical

# %%
plt.plot(1e3 * time, history / wr.STANDARD_GRAVITY)
plt.xlabel("time [ms]")
plt.ylabel("acceleration of the rack [g]")
plt.show()
