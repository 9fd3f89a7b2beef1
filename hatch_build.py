"""Build hook: a wheel brings its kernels along, compiled for two levels of x86-64 processors."""

import os
import platform
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

REPEATABLE = {"WIREROPE_KERNEL_NUMBER": "0", "PYTHONHASHSEED": "0"}
"""Names in compiled code, and the order of sets while compiling, are the same in every build."""

LEVELS = ("x86-64-v3", "x86-64-v2")
"""Of processors since 2013 and since 2009, one process each. Others compile when a kernel is first called."""

COMPILE = "from wirerope_mj.runs.kernels import use_all_kernels; use_all_kernels()"
COPY = "import sys, pathlib; from wirerope_mj.runs.kernels import copy_kernels; copy_kernels(pathlib.Path(sys.argv[1]))"


class CompiledKernels(BuildHookInterface):
    """Compiles the kernels with the interpreter and the Numba that build the wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile into a folder that goes into the wheel; not for an editable install, whose kernels are there to be edited."""
        self._scratch = Path(tempfile.mkdtemp())
        if version == "editable" or platform.machine() not in ("x86_64", "AMD64"):
            return
        self._at_once(COMPILE)
        self._at_once(COPY)
        build_data["force_include"][str(self._scratch / "kernels")] = "wirerope_mj/_kernels"
        build_data.update(pure_python=False, infer_tag=True)

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove the folder."""
        shutil.rmtree(self._scratch, ignore_errors=True)

    def _at_once(self, code: str) -> None:
        """Run Python code once for each level, at the same time."""
        processes = [
            subprocess.Popen(
                [sys.executable, "-c", code, str(self._scratch / "kernels")],
                env=os.environ
                | REPEATABLE
                | {"NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(self._scratch / level)},
                cwd=self.root,
            )
            for level in LEVELS
        ]
        if any([process.wait() for process in processes]):
            raise RuntimeError("the kernels could not be compiled; set HATCH_BUILD_NO_HOOKS=true for a wheel without them")
