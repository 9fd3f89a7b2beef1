"""A block on one mount in which everything is called what would do harm if it were more than text."""

from pathlib import Path
from xml.sax.saxutils import quoteattr

import wirerope_mj as wr
from wirerope_mj.foundation.resources import catalogue_folder, models_folder

HTML, MARKUP, FORMULA, OUTSIDE, CELL = "<img src=x onerror=alert(1)>", "[red]x[/red]", "$\\frac{", "../../x", "a|b"
NAME = f"{HTML}{MARKUP}{FORMULA}{OUTSIDE}{CELL}"
"""In the name of every body, mount, point and isolator."""

ESCAPE, TITLE, BREAK = "\x1b[31mred", "\x1b]0;owned\x07", "first\nsecond"
BLOCK, TABLE, MOUNT, POINT = f"block{NAME}", f"_table{NAME}", f"m1{NAME}", f"point/top{NAME}"
DEVICE = f"isolator{NAME}"
QUESTION = f"Does [click](http://example.com) {NAME}{ESCAPE}\n\n# hold?"

FILE_NAME = NAME.replace("/", "").replace("\\", "")
"""As far as a file can be called like that; MuJoCo opens no path with a backslash."""

SCENARIO = f'''"""{QUESTION.encode("unicode_escape").decode().replace('"', chr(92) + '"')}"""
import wirerope_mj as wr


def scenario(*, level: float = 5.0, word: str = {NAME + ESCAPE!r}) -> wr.Scenario:
    """Return the shock."""
    motion = wr.HalfSine(peak=9.8 * level, duration=0.011, direction="z")
    return wr.Scenario(__doc__, "model.xml", motion, {{"duration": 0.05, "timestep": 1e-3}})
'''


def write_hostile_model(folder: Path) -> Path:
    """Write the model and its isolator and return the model's file."""
    text = (models_folder() / "shock_table.xml").read_text(encoding="utf-8")
    for old, new in (  # MuJoCo ends what a tuple refers to at a space
        ('body name="block"', f"body name={quoteattr(BLOCK)}"),
        ('body name="table"', f"body name={quoteattr(TABLE)}"),
        ('"mount/m1"', quoteattr(f"mount/{MOUNT}")),
        ('"point/block_top"', quoteattr(POINT)),
        ('"isolator/wr12_400"', quoteattr(f"isolator/{NAME.replace(' ', '')}")),
        ('"isolators/enidine_wr12_400.toml"', '"device.toml"'),
    ):
        assert old in text
        text = text.replace(old, new)
    (folder / "model.xml").write_text(text, encoding="utf-8")
    write_hostile_isolator(folder / "device.toml")
    return folder / "model.xml"


def write_hostile_isolator(path: Path) -> None:
    """Write the isolator of the catalogue under the name `DEVICE`."""
    device = wr.load_isolator(catalogue_folder() / "enidine_wr12_400.toml")
    wr.Isolator(
        **{axis: law for axis, law in device.axes.items()},
        name=DEVICE,
        limits=device.limits,
        geometry=device.geometry,
        provenance=type(device.provenance)(kind="illustrative", source=f"made up {NAME}{ESCAPE}{TITLE}"),
    ).save(path)


def write_hostile_scenario(folder: Path) -> Path:
    """Write model, isolator and scenario and return the scenario's file, itself called like that."""
    write_hostile_model(folder)
    path = folder / f"{FILE_NAME}.py"
    path.write_text(SCENARIO, encoding="utf-8")
    return path
