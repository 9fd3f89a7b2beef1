"""Take a picture of a run as the rerun viewer shows it, without a screen (a Vulkan driver is needed, Mesa's will do).

python docs/viewer_picture.py runs/floating_floor_shock docs/img/floating_floor.png --time 0.1 --tab Overview

Several runs are laid over each other, as `wirerope compare` does:

python docs/viewer_picture.py runs/floor_15g runs/floor_20g docs/img/compare.png --names "15 g" "20 g" --time 0.094
"""

import argparse
import os
import tempfile
import time
from pathlib import Path

from rerun.experimental import ViewerClient

from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.engine.response import load_response
from wirerope_mj.runs.scenario_file import scenario_content
from wirerope_mj.runs.sources import run_inputs, system_and_motion
from wirerope_mj.views.recording import record_overlay, record_rerun
from wirerope_mj.views.recording.viewer import free_port, viewer_binary


def main() -> None:
    """Record the runs with the wanted tab in front, open it, move the cursor, and save what is seen."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=Path, nargs="+", help="folder of a run, or of each of several")
    parser.add_argument("picture", type=Path, help="PNG to write")
    parser.add_argument("--time", type=float, default=0.0, help="instant of the cursor [s]")
    parser.add_argument("--tab", default="Overview", help="tab in front")
    parser.add_argument("--title", default="", help="heading of the scenario of a single run")
    parser.add_argument("--names", nargs="+", help="names of several runs; those of their folders if not given")
    parser.add_argument("--scene", default="", help="scene in front, of several runs; the worst mount if not given")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        os.environ.setdefault("XDG_RUNTIME_DIR", scratch)
        record = _one if len(options.folders) == 1 else _several
        recording = record(options, Path(scratch) / "run.rrd")
        options.picture.parent.mkdir(parents=True, exist_ok=True)
        save_picture(recording, options.picture, instant=options.time)


def _one(options: argparse.Namespace, path: Path) -> Path:
    (folder,) = options.folders
    scenario = folder / "scenario.toml"
    response, text, verdicts = load_response(folder), "", None
    if scenario.is_file():
        text = scenario.read_text()
        system, _ = system_and_motion(folder, scenario_content(folder))
        verdicts = judged_run(system, response).verdicts
    return record_rerun(response, path, title=options.title, scenario_text=text, verdicts=verdicts, tab=options.tab)


def _several(options: argparse.Namespace, path: Path) -> Path:
    folders = dict(zip(options.names or [folder.name for folder in options.folders], options.folders, strict=True))
    responses = {name: load_response(folder) for name, folder in folders.items()}
    inputs = {name: run_inputs(folder) for name, folder in folders.items()}
    return record_overlay(responses, path, inputs=inputs, tab=options.tab, scene=options.scene)


def save_picture(recording: Path, picture: Path, *, instant: float) -> None:
    """Write what the viewer shows at `instant` [s], 1920 x 1080 points."""
    binary = str(viewer_binary())
    with ViewerClient.spawn(headless=True, port=free_port(9876), hide_welcome_screen=True, executable_path=binary) as viewer:
        viewer.open(str(recording))
        while viewer.get_state().loading:
            time.sleep(0.1)
        viewer.set_time("sim_time", duration=instant, play_state="paused")
        time.sleep(2.0)  # meshes and text are laid out over the next frames
        viewer.save_screenshot(str(picture))


if __name__ == "__main__":
    main()
