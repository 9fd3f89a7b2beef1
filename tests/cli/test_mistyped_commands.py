"""Commands with a slip in them: each is answered in one line that names what of the user's is wrong, and exits 2."""

import shlex

import pytest

from wirerope_mj.cli import main

pytestmark = pytest.mark.quick

FILES = {
    "empty.py": "",
    "syntax.py": "def scenario(:\n",
    "raises.py": "import numpy as np\n\n\ndef scenario(*, a: float = 1.0):\n    return np.zeros(3).reshape(2, 2)\n",
    "none.py": "def scenario(*, a: float = 1.0):\n    return None\n",
    "comma.toml": "alpha = 1,5\n",
    "negative.toml": 'law = "bouc-wen"\nalpha = -1.0\nbeta = 1.0\ngamma = 0.0\nn = 1.0\n',
    "text.toml": 'law = "bouc-wen"\nalpha = "x"\nbeta = 1.0\ngamma = 0.0\nn = 1.0\n',
    "empty.toml": "",
    "line.csv": "time [s], deflection [mm], force [N]\n0, 0, 0\n",
}
IDENTIFY = "identify line.csv --law bouc-wen --out o.toml"
SLIPS = {
    "nonsense": 'Unknown command "nonsense"',
    "run shock_table --level-g 5mm": "`--level-g` must be a number without a unit, with a decimal point, got '5mm'",
    "run shock_table --level_g x": "`wirerope run shock_table --help` says what there is",
    "run shock_table --nope 3": "Unknown option: --nope",
    "run empty.py": "empty.py: there is no function `scenario` here; a scenario is what `def scenario(*, ...)` returns",
    "run syntax.py": "syntax.py, line 1: `def scenario(:` is not Python: invalid syntax",
    "run binary.py": "binary.py: this is not text; a scenario is a Python file",
    "run raises.py": "raises.py, line 5: `return np.zeros(3).reshape(2, 2)` ends with ValueError: cannot reshape",
    "run none.py": "none.py: `scenario` must return a wirerope_mj.Scenario, got None",
    "run folder": "there is no scenario 'folder'",
    "study shock_table --vary 'motion/level = Uniform(1, 2)' --variants 2.5": "--variants: must be an integer, got 2.5",
    "run cabinet_random --seed 2.7": "`--seed` must be an integer, got '2.7'",
    "study shock_table --vary 'body/block/mass = Uniform(1'": "body/block/mass",
    "show binary.rrd": "binary.rrd: this is not a recording of rerun; `wirerope show` takes a run's folder or its run.rrd",
    "show folder": "folder/run.rrd: there is no such recording",
    "statics shock_table extra": "'extra' belongs to no option or argument",
    "isolators comma.toml": "comma.toml: not valid TOML: Expected newline or end of document after a statement (at line 1",
    "isolators binary.toml": "binary.toml, line 2: cannot read this isolator file: it is not a text file in UTF-8",
    "isolators fit comma.toml o.toml": "with texts in quotes and a point, no comma, in numbers",
    "isolators fit binary.toml o.toml": "binary.toml, line 2: cannot read this data sheet: it is not a text file in UTF-8",
    "isolators fit folder o.toml": "folder: cannot read this data sheet",
    "isolators fit absent.toml o.toml": "absent.toml: cannot read this data sheet: there is no such file",
    "isolators fit": "`wirerope isolators fit --help` says what there is",
    "loops negative.toml": "negative.toml, line 2: `alpha` must be > 0, got -1.0",
    "loops text.toml": "text.toml, line 2: `alpha` must be a finite number [N/m], got 'x'",
    "loops enidine_wr16_400 --amplitudes 5mm": "`--amplitudes` must be a number without a unit",
    f"{IDENTIFY} --start binary.toml": "binary.toml, line 2: cannot read this start of a search: it is not a text file",
    f"{IDENTIFY} --start folder": "folder: no such file. A search starts at a law file or at an isolator file",
    f"{IDENTIFY} --fix n": "`--fix` must be NAME=VALUE with a number in SI units, got 'n'",
    "frf shock_table --direction q": "`--direction` must be x, y, z, -x, -y, -z or a vector such as 1,1,0, got 'q'",
    "select --mass 100 --mounts 2.5": "`mounts` must be how many stand where",
    "select worksheet --mass 100 --mounts 2.5": "`--mounts` must be an integer, got '2.5'",
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    for ending in ("py", "toml", "rrd"):
        (tmp_path / f"binary.{ending}").write_bytes(bytes(range(256)))
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", SLIPS)
def test_a_slip_is_answered_by_what_is_wrong_with_it(command, here, capsys):
    assert main(shlex.split(command)) == 2
    printed = capsys.readouterr()
    assert SLIPS[command] in printed.err
    assert printed.err.count("\n") == 1
    assert printed.out == ""
