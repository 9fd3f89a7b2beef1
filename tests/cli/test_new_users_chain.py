"""From a file of accelerations to a calibrated model in four commands, as a new user does it: no Python."""

import json

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main

G = wr.STANDARD_GRAVITY
BASE = ["BX=base x", "BY=base y", "BZ=base z"]
BLOCK = ["PX=body/block x", "PY=body/block y", "PZ=body/block z"]


@pytest.fixture
def user(tmp_path, monkeypatch):
    """Go to an empty folder but for the file of a test: 10 kHz, three axes, z clipped, offsets, the block 0.3 ms late.

    The isolator of the true table is 20 % stiffer than the model's, and there is 1 % noise.
    """
    monkeypatch.chdir(tmp_path)
    table, rng = wr.load_system("shock_table"), np.random.default_rng(7)
    truth = wr.varied(table, isolators={"m1": table.mounts["m1"].written.scaled(1.2)})
    pulses = [wr.HalfSine(peak=p * G, duration=0.011, direction=d, start=0.03) for p, d in ((8, "z"), (4, "x"), (3, "y"))]
    r = wr.simulate(truth, pulses[0] + pulses[1] + pulses[2], duration=0.4, sample_rate=10_000.0)
    late = [np.interp(r.time - 3e-4, r.time, history) for history in r.bodies["block"].acceleration.T]
    samples = np.column_stack([r.base.acceleration, *late]) / G
    samples += 0.01 * np.abs(samples).max(axis=0) * rng.standard_normal(samples.shape)
    samples[:, 5] = np.minimum(samples[:, 5], 0.95 * samples[:, 5].max())
    samples += [0.03, -0.02, 0.05, 0.1, -0.05, 0.2]
    columns, header = np.column_stack([r.time + 12.0, samples]), "time [s],BX [g],BY [g],BZ [g],PX [g],PY [g],PZ [g]"
    np.savetxt("drop.csv", columns, delimiter=",", header=header, comments="", fmt="%.6g")
    return tmp_path


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::wirerope_mj.foundation.errors.RecordWarning")  # it is clipped, and says so
def test_files_become_overlay_measures_calibrated_model_and_page(user, capsys):
    record = ["--record", "drop.csv", "--channels", "BX=x", "BY=y", "BZ=z", "--baseline", "rest"]
    main(["shock", "shock_table", *record, "--out", "runs/drop"])
    assert main(["compare", "runs/drop", "drop.csv", "--baseline", "rest", "--map", *BASE, *BLOCK]) == 0
    said = capsys.readouterr().out
    assert "block, x" in said
    assert "saturated" in said  # z is clipped
    vary = ["--vary", "mount/m1/stiffness = Uniform(0.7, 1.4)", "--vary", "channel/*/delay = Normal(0, 0.0005)"]
    assert main(["calibrate", "runs/drop", *vary, "--out", "calibrated"]) == 0
    rows = {row[0]: row for row in json.loads((user / "calibrated/calibration.json").read_text())["values"]["rows"]}
    assert rows["mount/m1/stiffness"][1] == pytest.approx(1.2, rel=0.01)
    # The noise of the base's record is an error of the model, which of a delay cannot be told: the interval owns it.
    assert rows["channel/*/delay"][2] < 3e-4 < rows["channel/*/delay"][3]
    assert rows["mount/m1/stiffness"][3] < 1.05 * rows["mount/m1/stiffness"][2]  # and the band says how well
    assert "Measured and calculated" in (user / "calibrated/report.html").read_text(encoding="utf-8")
    assert main(["modes", "calibrated/model/shock_table.xml"]) == 0
