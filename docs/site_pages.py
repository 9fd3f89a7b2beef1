"""What the program itself writes for the documentation site: its commands, the public API, a shared run."""

import ast
import contextlib
import io
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rich.console import Console

import wirerope_mj
from wirerope_mj.cli import main
from wirerope_mj.cli.app import COMMANDS, app, tell_all

_ROOMS = {
    "mounts": "Mounts: laws, isolators, tests and their identification",
    "motions": "Motions of the base, forces on the payload, spectra",
    "engine": "Systems, statics, simulation",
    "dynamics": "Modes, sweeps, periodic motions",
    "assessment": "Criteria, selection, comparison, durability",
    "studies": "Studies and searches",
    "runs": "Runs and their folders",
    "views": "Pictures, recordings, pages",
    "foundation": "Errors and units",
}


def write_commands(path: Path) -> None:
    """Write what `wirerope COMMAND --help` says, command by command."""
    parts = ["# Every command", "What `wirerope COMMAND --help` prints, written by the program itself.", ""]
    for name in COMMANDS:
        parts += [f"## wirerope {name}", "", "```text", _help(name), "```", ""]
    _write(path, "\n".join(parts))


def _help(name: str) -> str:
    """Return the help of a command as it stands in a terminal of 84 columns."""
    out = io.StringIO()
    tell_all(name)
    app.help_print([name], console=Console(file=out, width=84, color_system=None))
    return "\n".join(line.rstrip() for line in out.getvalue().strip().splitlines())


def write_api(folder: Path) -> None:
    """Write the public names, a page for each wing, each name with its signature and its docstring."""
    folder.mkdir(exist_ok=True)
    names = list(public_names())
    for wing, title in _ROOMS.items():
        parts = [title, "=" * len(title), ""]
        for module, name in names:
            if module.split(".")[1] == wing:
                parts += _entry(name)
        _write(folder / f"{wing}.rst", "\n".join(parts))
    parts = ["API", "===", "", "``import wirerope_mj as wr``: the public names, by wing. Units are SI throughout.", ""]
    parts += [".. toctree::", "   :maxdepth: 1", "", *(f"   {wing}" for wing in _ROOMS), ""]
    _write(folder / "index.rst", "\n".join(parts))


def plain_figures(_gallery: Any, _file: Any) -> None:
    """Give the figures of the examples letters that can be read on a phone, and no empty margins."""
    import matplotlib

    matplotlib.rcParams.update(
        {
            "figure.figsize": (5.2, 3.9),
            "font.size": 11.0,
            "figure.constrained_layout.use": True,
            "savefig.bbox": "tight",
        }
    )


def write_recording(folder: Path, scenario: str) -> None:
    """Write a run of a scenario with its report, its recording and the web viewer; one that is there stays."""
    if folder.is_dir():
        return
    with tempfile.TemporaryDirectory() as scratch, contextlib.redirect_stdout(io.StringIO()):
        for command in (["run", scenario, "--out", f"{scratch}/run"], ["share", f"{scratch}/run", str(folder)]):
            if code := main(command):
                raise RuntimeError(f"wirerope {' '.join(command)} exited with {code}")


def public_names() -> Iterator[tuple[str, str]]:
    """Yield module and name of everything in the public API."""
    stub = Path(wirerope_mj.__file__).with_suffix(".pyi")
    for node in ast.parse(stub.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                yield f"wirerope_mj.{node.module}", alias.name


def _entry(name: str) -> list[str]:
    thing = getattr(wirerope_mj, name, None)
    kind = "autoclass" if isinstance(thing, type) else "autofunction" if callable(thing) else "autodata"
    return [f".. {kind}:: wirerope_mj.{name}", *(["   :members:"] if kind == "autoclass" else []), ""]


def _write(path: Path, text: str) -> None:
    """Write a file if it is not the same already, so that only what changed is built again."""
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
