"""`wirerope loops`: measures on the screen, a picture, a file; one message for bad input."""

import re

import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.mounts.vendor_parts import find_isolator

pytestmark = pytest.mark.quick

LAW = 'law = "bouc-wen"\nalpha = 1e5\nbeta = 800.0\ngamma = 200.0\nn = 1\n'


def printed(capsys, *arguments):
    """Return what a command prints, its cells apart by single spaces."""
    assert main([str(argument) for argument in arguments]) == 0
    return re.sub(r"[ \n]+", " ", capsys.readouterr().out)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_an_isolator_of_the_catalogue_is_tested_on_all_its_axes(folder, capsys):
    out = printed(capsys, "loops", "enidine_wr16_400")
    law = wr.load_isolator(find_isolator("enidine_wr16_400")).axial
    for scale in law.laws:
        assert f"asymmetric-bouc-wen: alpha = {scale.alpha:.6g}" in out
    loop = wr.cyclic_test(law, 0.0432)[0]
    stiffness, energy = loop.secant_stiffness / 1e3, loop.dissipated_energy
    assert f"axial 43.2 {stiffness:.4g} {energy:.4g} {100 * loop.damping_ratio:.4g}" in out
    assert out.count("roll and shear 45.2") == 1  # one law, one test
    assert "roll and shear: softens up to an amplitude of" in out
    assert "axial: hardening overlap" in out
    assert [path.name for path in folder.iterdir()] == ["enidine_wr16_400-loops.png"]
    assert (folder / "enidine_wr16_400-loops.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("option", ["--amplitudes", "--amplitudes-mm"])
def test_a_law_file_is_tested_at_amplitudes_in_millimetres(folder, capsys, option):
    (folder / "steel.toml").write_text(LAW, encoding="utf-8")
    out = printed(capsys, "loops", "steel.toml", option, "1", "2", "4", "--out", "steel.svg")
    # W and K of the reference row alpha = n = 1, (0.8, 0.2), A = 1, in its units of 1 mm and 100 N.
    loop = wr.cyclic_test(wr.BoucWen(alpha=1e5, beta=800.0, gamma=200.0, n=1), 1e-3)[0]
    assert loop.dissipated_energy == pytest.approx(0.08309464386, rel=1e-9)
    assert f"axial 1 {loop.secant_stiffness / 1e3:.4g} 0.08309" in out
    assert out.count(" axial ") == 3
    assert [path.name for path in sorted(folder.iterdir())] == ["steel.svg", "steel.toml"]


@pytest.mark.parametrize(
    ("laws", "amplitudes"),
    [
        ('law = "stop"\ngap_below = 0.04\nk = 1e6', (0.04025, 0.0405, 0.04125, 0.0425, 0.045)),
        (
            'laws = [{ law = "kelvin-voigt", k = 1e5, c = 0.0 }, { law = "stop", gap_below = 0.03, k = 1e6 }]',
            (0.0175, 0.035),
        ),
        ('law = "tabulated"\ndeflection_mm = [0, 36]\nforce_kN = [0, 8]\nsymmetric = true', (0.018, 0.036)),
    ],
)
def test_an_unrated_stop_is_pressed_and_a_table_followed_to_its_end(folder, capsys, laws, amplitudes):
    (folder / "device.toml").write_text(f'name = "device"\n[axial]\n{laws}\n', encoding="utf-8")
    out = printed(capsys, "loops", "device.toml")
    law = wr.load_isolator(folder / "device.toml").axial
    for amplitude in amplitudes:
        stiffness = wr.cyclic_test(law, amplitude)[0].secant_stiffness
        assert stiffness > 0.0
        assert f"axial {1e3 * amplitude:.4g} {stiffness / 1e3:.4g}" in out


def test_loops_of_one_axis_go_to_a_file_that_is_read_back(folder, capsys):
    out = printed(capsys, "loops", "sdof_36hz", "--amplitudes", "1", "--operating-point-mm=-0.5", "--csv", "t.csv")
    assert "about -0.5 mm" in out
    (loop,) = wr.load_cyclic_test("t.csv")
    assert loop.operating_point == pytest.approx(-0.5e-3, rel=1e-12)
    assert loop.amplitude == pytest.approx(1e-3, rel=1e-12)


def test_rate_dependent_law_is_tested_at_its_frequency_and_states_no_tangent(folder, capsys):
    (folder / "rubber.toml").write_text('law = "kelvin-voigt"\nk = 1e5\nc = 300.0\n', encoding="utf-8")
    out = printed(capsys, "loops", "rubber.toml", "--amplitudes", "10", "--frequency", "7", "--axis", "shear")
    assert "at 7 Hz" in out
    # pi c omega A^2 = 4.145 J; zeta = c omega / 2k.
    assert "shear 10 100 4.145 6.597 - - 1 " in out


def test_cycles_are_run_as_asked_and_an_open_loop_says_so(folder, capsys):
    out = printed(capsys, "loops", "sdof_36hz", "--amplitudes", "1", "--cycles", "1")
    assert "1, open by" in out


def test_several_elements_are_described_as_lists(folder, capsys):
    text = 'law = "masing"\nstiffness = [1e5, 5e4]\nslip_force = [100.0, 300.0]\nk = 2e4\n'
    (folder / "masing.toml").write_text(text, encoding="utf-8")
    out = printed(capsys, "loops", "masing.toml", "--amplitudes", "2")
    assert "stiffness = [100000, 50000], slip_force = [100, 300], k = 20000" in out
    assert "axial 2 120 0.4 13.26" in out  # 4 h (A - h/c) of the one element that slips


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nosuch"], "no isolator 'nosuch'.*enidine_wr16_400"),
        (["law.toml"], "law without a rated travel: say at which `--amplitudes`"),
        (["law.toml", "--amplitudes", "-3"], r"`--amplitudes` must be > 0 \[mm\], got -3\.0"),
        (["law.toml", "--amplitudes", "few"], "few"),
        (["law.toml", "--amplitudes", "1", "--frequency", "0"], "`frequency` must be > 0"),
        (["law.toml", "--amplitudes", "1", "--cycles", "0"], "`cycles` must be an integer >= 1"),
        (["law.toml", "--amplitudes", "1", "--cycles", "4.5"], r"--cycles: must be an integer, got 4\.5\."),
        (["law.toml", "--amplitudes", "1", "--axis", "up"], "--axis.*roll.*shear.*axial"),
        (["law.toml", "--amplitudes", "1", "--out", "loops.docx"], "must end with .png"),
        (["law.toml", "--amplitudes", "1", "--csv", "no/t.csv"], "t.csv: there is no folder"),
        (["sdof_36hz", "--axis", "roll"], "has no force on this axis, only on axial"),
        (["enidine_wr16_400", "--csv", "t.csv"], "one axis: name it with --axis"),
        (["short.toml", "--amplitudes", "1"], "short.toml: .*`beta` is missing; needed: alpha, beta"),
        (["unknown.toml", "--amplitudes", "1"], "unknown.toml, line 1: there is no `law` 'bouc'; the laws are"),
        (["broken.toml", "--amplitudes", "1"], "broken.toml: not valid TOML"),
    ],
)
def test_bad_input_gets_one_message_and_writes_nothing(folder, capsys, arguments, message):
    (folder / "law.toml").write_text(LAW, encoding="utf-8")
    (folder / "short.toml").write_text('law = "bouc-wen"\nalpha = 1e5\n', encoding="utf-8")
    (folder / "unknown.toml").write_text('law = "bouc"\nalpha = 1e5\n', encoding="utf-8")
    (folder / "broken.toml").write_text("law = bouc\n", encoding="utf-8")
    before = sorted(folder.iterdir())
    assert main(["loops", *arguments]) == 2
    caught = capsys.readouterr()
    assert caught.out == ""
    assert caught.err.count("\n") == 1
    assert re.search(message, caught.err), caught.err
    assert sorted(folder.iterdir()) == before


def test_a_list_of_one_law_is_that_law(folder, capsys):
    (folder / "one.toml").write_text('name = "a"\n[axial]\nlaws = [{ law = "stop", gap_below = 0.002, k = 1e6 }]\n')
    assert "axial: stop: gap_below = 0.002, k = 1e+06" in printed(capsys, "loops", "one.toml", "--amplitudes", "4")
    assert "axial: stop: gap_below = 0.002, k = 1e+06" in printed(capsys, "isolators", "one.toml")
