"""Build the pictures of the docs from runs of today: python docs/build_pictures.py [NAME ..], all if none is named.

docs/img/pictures.json keeps the texts of each picture (titles with their figures, verdicts, tables) and the digest of its file:
a test makes the texts anew, and says which picture is older than what it shows. Pictures of the viewer need a Vulkan driver
(Mesa's will do), that of a page a browser; the search of a placement and the pages of the thesis take minutes.
"""

import argparse
import atexit
import hashlib
import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import chdir, redirect_stdout
from dataclasses import dataclass
from html import unescape
from pathlib import Path
from typing import Any

from wirerope_mj.content.blocks import Chart, SceneView

HERE = Path(__file__).parent
IMAGES, MANIFEST = HERE / "img", HERE / "img" / "pictures.json"
_ELSEWHERE = re.compile(
    "verdict after| in all| s together|written|opens the|real time|steps|computed|[.](parquet|json|rrd|html)"
)
"""In lines of a command that say how long it took, how it computed, and where it wrote."""


@dataclass(frozen=True)
class Made:
    """What a picture shows, as texts, and how its file is drawn."""

    shows: list[str]
    draw: Callable[[Path], None]


def said(*command: str) -> list[str]:
    """Run a command in the current folder, and return what it says of its result."""
    from wirerope_mj.cli import main

    os.environ["COLUMNS"] = "120"
    with redirect_stdout(io.StringIO()) as out:
        if code := main(list(command)):
            raise RuntimeError(f"wirerope {' '.join(command)} exited with {code}: {out.getvalue()}")
    lines = [" ".join(line.split()) for line in out.getvalue().splitlines()]
    return [line for line in lines if line and not _ELSEWHERE.search(line)]


def texts_in(recording: Path) -> list[str]:
    """Return verdict, names of views and of curves in a recording: its largest figures and all of its wording."""
    from rerun.chunk import RrdReader

    reader, texts = RrdReader(str(recording)), set[str]()
    for store in (*reader.blueprints(), *reader.recordings()):
        for chunk in reader.stream(store=store):
            batch, banner = chunk.to_record_batch(), str(chunk.entity_path) == "/verdict"
            for name in batch.schema.names:
                if name in ("ViewBlueprint:display_name", "SeriesLines:names") or (name == "TextDocument:text" and banner):
                    texts |= set(batch[name].flatten().to_pylist())
    return sorted(texts)


def in_viewer(recording: Path, *, timeline: str = "sim_time", **cursor: float) -> Callable[[Path], None]:
    """Return what writes the picture of a recording as the viewer shows it, 1920 x 1080 points, at a place of the cursor."""

    def draw(picture: Path) -> None:
        from rerun.experimental import ViewerClient

        from wirerope_mj.views.recording.viewer import free_port, viewer_binary

        os.environ.setdefault("XDG_RUNTIME_DIR", str(recording.parent))
        port, program = free_port(9876), str(viewer_binary())
        with ViewerClient.spawn(headless=True, port=port, hide_welcome_screen=True, executable_path=program) as viewer:
            viewer.open(str(recording))
            while viewer.get_state().loading:
                time.sleep(0.1)
            viewer.set_time(timeline, play_state="paused", **cursor)
            time.sleep(5.0)  # meshes and text are laid out over the next frames
            viewer.save_screenshot(str(picture))

    return draw


def copied(path: Path) -> Callable[[Path], None]:
    """Return what writes the picture that a command has made."""
    content = path.read_bytes()
    return lambda picture: picture.write_bytes(content) and None


def floating_floor() -> Made:
    """Run the main job; the viewer shows it 52 ms after the pulse began."""
    said("run", "floating_floor_shock", "--out", "floor")
    recording = Path("floor/run.rrd").resolve()
    return Made(texts_in(recording), in_viewer(recording, duration=0.102))


def first_run() -> Made:
    """Draw the run of the front page: the scene at its worst instant, and the three charts of its first sheet."""
    from wirerope_mj.content.first_sheet import brief_blocks
    from wirerope_mj.runs.scenario_file import judged_folder
    from wirerope_mj.views.pictures import save_pictures

    page = (HERE / "index.md").read_text(encoding="utf-8")
    _, *command = shlex.split(page.partition("```bash\n")[2].partition("\n")[0])
    lines = said(*command)
    blocks = [block for block in brief_blocks(judged_folder(Path(command[-1]))) if isinstance(block, Chart | SceneView)]
    return Made(lines, lambda picture: save_pictures(blocks, picture))


def compare() -> Made:
    """Lay two levels on the floor over each other, 42 ms after the pulse began."""
    for level in (9, 15):
        said("run", "floating_floor_shock", "--level-g", str(level), "--out", f"{level}g")
    said("compare", "9g", "15g", "--names", "9 g", "15 g", "--out", "compare.rrd")
    recording = Path("compare.rrd").resolve()
    return Made(texts_in(recording), in_viewer(recording, duration=0.092))


def damage_spectra() -> Made:
    """Draw the damage spectra of a density and of three histories of it, as docs/durability.md computes them."""
    import matplotlib as mpl
    import numpy as np
    from matplotlib.figure import Figure

    import wirerope_mj as wr

    psd = wr.motions.psd_from_g([(5, 0.01), (50, 0.01), (200, 0.000625)])
    frequencies = np.geomspace(5, 100, 20)
    density = wr.vibration_response_spectrum(psd, frequencies, q=10).fatigue_damage(exponent=4.0, duration=60.0)
    times, histories = np.arange(0.0, 60.0, 2.5e-4), []
    for seed in (1, 2, 3):
        vibration = wr.RandomVibration(psd=psd, duration=60.0, seed=seed, direction="z")
        acceleration = vibration.acceleration(times)[:, 2]
        histories.append(wr.fatigue_damage_spectrum(times, acceleration, exponent=4.0, frequencies=frequencies).damage)

    def draw(picture: Path) -> None:
        with mpl.rc_context({"font.size": 11.0}):
            figure = Figure(figsize=(7.7, 3.96), layout="constrained")
            axes = figure.add_subplot()
            for number, damage in enumerate(histories):
                axes.loglog(
                    frequencies,
                    damage,
                    color="#d95f0e",
                    lw=1.0,
                    label="" if number else "three histories of it, cycles counted",
                )
            axes.loglog(frequencies, density, color="#08519c", lw=2.0, label="density, Dirlik")
            axes.set_xticks([5, 10, 20, 50, 100], ["5", "10", "20", "50", "100"])
            axes.set(xlabel="natural frequency [Hz]", ylabel="damage in 60 s, b = 4 [(m/s)$^4$]")
            axes.legend()
            figure.savefig(picture, dpi=100)

    curves = {"density": density} | {f"history {number}": damage for number, damage in enumerate(histories, 1)}
    return Made([f"{name}: {' '.join(f'{value:.2g}' for value in values)}" for name, values in curves.items()], draw)


def first_model() -> Made:
    """Make the plan of the genset of docs/first_model.md, whose tables are those of the template."""
    from wirerope_mj.engine.from_tables import read_layout
    from wirerope_mj.runs.new_model import tables_in
    from wirerope_mj.views.plots.letters import text_of
    from wirerope_mj.views.plots.model_plan import plan_svg, save_plan

    tables = tables_in(HERE.parent / "models" / "templates" / "genset")
    layout = read_layout("genset", tables)
    texts = {line.strip() for line in text_of(plan_svg(layout)[0]).splitlines()}
    return Made(sorted(filter(None, texts)), lambda picture: save_plan(layout, picture))


def board() -> Made:
    """Place the genset on a drawing board, with two of its mounts moved below its engine, and judge it."""
    from wirerope_mj.runs.board.board import Board
    from wirerope_mj.runs.board.opened import from_template, opened
    from wirerope_mj.views.board.columns import fragment

    shown, fragments, scene = Board(opened(from_template("genset", Path("genset")))), dict[str, str](), dict[str, Any]()
    atexit.register(shown.close)  # whether it is drawn or not
    for action in (
        {"do": "add-limit", "value": "acceleration/turbocharger = 10 g"},
        {"do": "move", "names": ["mount/m1", "mount/m4"], "by": [400, 0, 0]},
    ):
        for _, message in shown.act(action):
            fragments |= message.get("html", {})
            scene = message.get("scene", scene)
    around, *_ = fragment("board.html", title=shown.title).partition("<dialog")
    html = "".join([around, fragments["left"], fragments["verdict"], fragments["statics"]])
    texts = re.findall(r">([^<>]*[a-z][^<>]*)<", html)
    words = dict.fromkeys(" ".join(unescape(text).split()) for text in texts)
    used = [
        f"{mount['label']} at {mount['position']}, {mount['used']:.0%}" for mount in scene["items"] if mount["kind"] == "mount"
    ]

    def draw(picture: Path) -> None:
        from threading import Thread

        from playwright.sync_api import sync_playwright

        from wirerope_mj.views.board.server import BoardServer

        server = BoardServer(shown)
        serving = Thread(target=server.run)
        serving.start()
        with sync_playwright() as playwright:
            alike = ["--num-raster-threads=1", "--disable-partial-raster"]  # the same pixels each time
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox", *alike])
            page = browser.new_page(viewport={"width": 1440, "height": 900}, color_scheme="light")
            page.goto(server.address)
            page.wait_for_selector("body[data-stale=false] #compared :first-child", state="attached")
            page.screenshot(path=picture)
            browser.close()
        server.should_exit = True
        serving.join()

    return Made([*used, *words], draw)


def frequency_response() -> Made:
    """Follow the motions of a mass on one mount at three levels."""
    command = ("frf", "sdof_shaker", "--acceleration", "1", "2", "5", "--method", "both", "--rate", "2", "--out", "frf")
    return Made(said(*command), copied(Path("frf/frequency_response.png")))


def frequency_response_view() -> Made:
    """Show the motions along the same branches in the viewer, where the highest level is largest."""
    command = ("frf", "sdof_shaker", "--acceleration", "1", "2", "5", "--method", "continuation", "--out", "branches")
    said(*command)
    recording = Path("branches/run.rrd").resolve()
    return Made(texts_in(recording), in_viewer(recording, timeline="point", sequence=30))


def placement_front() -> Made:
    """Search the placement of the floor's mounts: minutes."""
    lines = said("study", "floor_placement", "--out", "placed")
    return Made([line for line in lines if "on the front" in line], copied(Path("placed/front.png")))


def placement_plans() -> Made:
    """Take the plans of the same search."""
    known = Path("placed").is_dir()
    shows = list(kept()["placement_front"]["shows"]) if known else placement_front().shows
    return Made(shows, copied(Path("placed/placements.png")))


PICTURES = {
    make.__name__: make
    for make in (
        floating_floor, first_run, board, compare, damage_spectra, first_model, frequency_response, frequency_response_view,
        placement_front, placement_plans,
    )
}  # fmt: skip
LONG = ("placement_front", "placement_plans")
"""Those whose texts take minutes to be made anew."""
PAGES = {"gallery": [sys.executable, "docs/gallery/build.py"], "thesis": [sys.executable, "-m", "docs.thesis"]}
"""Pages that are written with their pictures and numbers by commands of their own."""


def kept() -> dict[str, dict[str, Any]]:
    """Return what is known of the pictures as they are."""
    known: dict[str, dict[str, Any]] = json.loads(MANIFEST.read_text(encoding="utf-8")) if MANIFEST.is_file() else {}
    return known


def main() -> None:
    """Build the named pictures and pages, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", choices=[*PICTURES, *PAGES, []], help="pictures of docs/img, gallery, thesis")
    names = parser.parse_args().names or [*PICTURES, *PAGES]
    with tempfile.TemporaryDirectory() as scratch:
        for name in names:
            if name in PAGES:
                subprocess.run(PAGES[name], cwd=HERE.parent, check=True)
                continue
            picture = IMAGES / f"{name}.png"
            with chdir(scratch):
                made = PICTURES[name]()
                made.draw(picture)
            digest = hashlib.sha256(picture.read_bytes()).hexdigest()
            manifest = kept() | {name: {"sha256": digest, "shows": made.shows}}
            text = json.dumps({key: manifest[key] for key in PICTURES if key in manifest}, indent=1, ensure_ascii=False)
            MANIFEST.write_text(f"{text}\n", encoding="utf-8")
            print(f"{picture.relative_to(HERE.parent)}: {picture.stat().st_size / 1e3:.0f} kB", flush=True)


if __name__ == "__main__":
    main()
