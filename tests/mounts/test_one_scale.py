"""Isolator files of one scale, as they shipped before, answer what they answered: stored numbers of the code before."""

import numpy as np
import pytest
from one_scale import FILES, SHEETS, one_scale

import wirerope_mj as wr
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet

PATH = [0.0, 8e-3, -6e-3, 3e-3]
"""Deflections of an axis [m]."""

# Forces of roll, shear and axial at the end of the path [N]; loss of a steady cycle of 5 mm along the axis [J].
ANSWERS = {
    "enidine_wr12_400": (230.85891082018392, 230.85891082018392, 728.4914482873039, 5.103666563154216),
    "enidine_wr16_400": (530.915219471681, 530.915219471681, 1922.466006771353, 12.352922129939422),
    "enidine_wr16_700": (271.2346772054957, 271.2346772054957, 1257.4394681945457, 10.433106809987567),
    "enidine_wr20_600": (688.0034842706386, 688.0034842706386, 2725.5321127211064, 20.913544427453765),
    "socitec_cb1390_20": (469.9773505047302, 620.5321405514464, 2142.0308814964205, 16.16213727479757),
    "socitec_cb1390_30": (334.5294457856079, 395.0914854364487, 1458.25774848933, 11.940218027539226),
    "socitec_cb1400_15": (694.0805538093633, 637.5955440594657, 3270.2032731775184, 25.94571738593972),
    "socitec_cb1400_30": (270.5962202510336, 270.5962202510336, 1126.2513381323902, 8.253170314966864),
}
SAME = 1e-12
"""On the processor that computed them the numbers are the same to the last bit; other exponentials differ by a few of these."""


@pytest.mark.quick
def test_all_files_are_looked_at():
    assert FILES.keys() == SHEETS.keys() == ANSWERS.keys()


@pytest.mark.quick
@pytest.mark.parametrize("name", ANSWERS)
def test_a_file_has_the_forces_and_losses_that_it_had(name):
    isolator = wr.load_isolator(FILES[name])
    forces = [getattr(isolator, axis).trace(PATH).force[-1] for axis in ("roll", "shear", "axial")]
    loss = wr.cyclic_test(isolator.axial, [5e-3])[0].dissipated_energy
    np.testing.assert_allclose([*forces, loss], ANSWERS[name], rtol=SAME)


@pytest.mark.parametrize("name", SHEETS)
def test_a_sheet_without_scales_still_gives_its_file(name):
    fitted, file = fit_datasheet(SHEETS[name]), wr.load_isolator(FILES[name])
    for axis, law in file.axes.items():
        # nine digits, of which the last depends on the processor
        np.testing.assert_allclose(fitted.axes[axis].kernel_parameters(), law.kernel_parameters(), rtol=2e-8)
    assert fitted.spread.covariance[0][0] == pytest.approx(file.spread.covariance[0][0], rel=1e-5)


@pytest.mark.parametrize("engine", ["kernel", "mujoco"])
def test_the_cabinet_on_coupled_mounts_of_one_scale_moves_as_it_did(engine):
    system = wr.load_system("cabinet", isolators=one_scale("cb1400_15"))
    pulse = wr.HalfSine(peak=100.0, duration=0.011, direction=(1, 0, 1), start=0.01)
    peaks = wr.simulate(system, pulse, duration=0.2, timestep=2.5e-4, sample_rate=1000.0, engine=engine).peaks
    assert peaks.bodies["rack"].acceleration.value == pytest.approx(29.61645970350376, rel=SAME)
    assert peaks.mounts["m01"].deflection.minimum[2] == pytest.approx(-0.010697491134020774, rel=SAME)


def test_the_table_sags_as_it_did():
    system = wr.load_system("shock_table", isolators=one_scale("wr12_400"))
    assert wr.equilibrium(system).mounts["m1"].deflection[2] == pytest.approx(-0.0018737661614624396, rel=1e-10)
