"""Take a picture of a run as the rerun viewer shows it, without a screen (a Vulkan driver is needed, Mesa's will do).

python docs/viewer_picture.py runs/floating_floor_shock docs/img/floating_floor.png --time 0.1 --tab Overview
"""

import argparse
import os
import tempfile
import time
from pathlib import Path

from rerun.experimental import ViewerClient

from wirerope_mj.recording import record_rerun
from wirerope_mj.recording.viewer import free_port, viewer_binary
from wirerope_mj.response import load_response


def main() -> None:
    """Record the run with the wanted tab in front, open it, move the cursor, and save what is seen."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder of a run")
    parser.add_argument("picture", type=Path, help="PNG to write")
    parser.add_argument("--time", type=float, default=0.0, help="instant of the cursor [s]")
    parser.add_argument("--tab", default="Overview", help="tab in front")
    parser.add_argument("--title", default="", help="heading of the scenario")
    options = parser.parse_args()
    scenario = options.folder / "scenario.toml"
    with tempfile.TemporaryDirectory() as scratch:
        os.environ.setdefault("XDG_RUNTIME_DIR", scratch)
        recording = record_rerun(
            load_response(options.folder),
            Path(scratch) / "run.rrd",
            title=options.title,
            scenario_text=scenario.read_text() if scenario.is_file() else "",
            tab=options.tab,
        )
        options.picture.parent.mkdir(parents=True, exist_ok=True)
        save_picture(recording, options.picture, instant=options.time)


def save_picture(recording: Path, picture: Path, *, instant: float) -> None:
    """Write what the viewer shows at `instant` [s], 1920 x 1080 points."""
    binary = str(viewer_binary())
    with ViewerClient.spawn(
        headless=True, port=free_port(9876), hide_welcome_screen=True, executable_path=binary
    ) as viewer:
        viewer.open(str(recording))
        while viewer.get_state().loading:
            time.sleep(0.1)
        viewer.set_time("sim_time", duration=instant, play_state="paused")
        time.sleep(2.0)  # meshes and text are laid out over the next frames
        viewer.save_screenshot(str(picture))


if __name__ == "__main__":
    main()
