"""Folders that hold whatever a library or Python itself might take for settings, code or data of its own.

Everything in them that could be executed touches `Hostile.mark`, a file outside of the folder.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from threading import Timer

import numpy as np

import wirerope_mj
from wirerope_mj.foundation.kernel_files import LOADED, SHIPPED, cache_folder

_MODULES = """
sitecustomize usercustomize conftest numba numba_config numpy yaml ctypes struct runpy os multiprocessing
pickle json tomllib signal socket typing encodings mujoco glfw rerun dask distributed wirerope_mj pyarrow
scipy matplotlib jinja2 typst lazy_loader cyclopts rich scenario study setup ipython_config
jupyter_config __init__ __main__ textwrap platform h5py pythonfmu3 fmu_slave tbb icc_rt _numba_parallel evil
pandas openpyxl pyuff pymoo imageio_ffmpeg PIL
"""
PROGRAMS = (
    "gcc", "cc", "ld", "ldconfig", "latex", "dvipng", "xdg-open", "rerun", "python", "python3", "uname", "objdump",
    "rerun-loader-evil", "rerun-cli", "ffmpeg",
)  # fmt: skip
LIBRARIES = (
    "libgcc_s.so.1", "libglfw.so.3", "libglfw.so", "libtbb.so.12", "libgomp.so.1",
    "libarrow.so", "libarrow_python.so", "libparquet.so", "libhdfs.so", "librerun_c.so",
)  # fmt: skip
NUMBA = (
    "cache_dir: .k\n", "cache_dir: .k\ncpu_name: generic\n", "cache_dir: .\ndisable_jit: 1\n",
    "cache_locator_classes: evil.Evil\n", "cache_dir: !!python/object/apply:os.system ['touch {mark}']\n", "- 1\n", "\0\xff",
    "opt: evil\n", "captured_errors: evil\n",
)  # fmt: skip
MATPLOTLIB = (
    "text.usetex: True\n", "backend: module://evil\n",
    "text.latex.preamble: \\immediate\\write18{{touch {mark}}}\ntext.usetex: True\n", "savefig.format: evil\n",
    "axes.prop_cycle: __import__('os').system('touch {mark}')\n", "\0\xff", "font.family: evil\nfigure.dpi: 1e9\n",
)  # fmt: skip
SETTINGS = {
    "ipython_config.py": "import os; os.system('touch {mark}')",
    "pyvenv.cfg": "home = .\n",
    "python311._pth": ".\nimport site\n",
    "evil.pth": "import os; os.system('touch {mark}')",
    "dask.yaml": "distributed:\n  worker:\n    preload: [evil]\n",
    "distributed.yaml": "distributed:\n  scheduler:\n    preload: [evil]\n",
    ".env": "PYTHONPATH=.\nPYTHONSTARTUP=evil.py\n",
    "pytest.ini": "[pytest]\naddopts = -p evil\n",
    "pyproject.toml": "[tool.pytest.ini_options]\naddopts = '-p evil'\n",
    "setup.cfg": "[tool:pytest]\naddopts = -p evil\n",
    "fonts.conf": "<fontconfig><include>evil</include></fontconfig>",
    "rerun.toml": "evil = true\n",
    ".rerunrc": "evil",
    ".config/rerun/analytics.json": '{{"analytics_enabled": true, "evil": "{mark}"}}',
    "rerun_config.json": '{{"external_viewer": "touch {mark}"}}',
    "blueprint.rbl": "RRF2 evil",
    "libarrow.so-gdb.py": "import os; os.system('touch {mark}')",
    "core-site.xml": "<configuration><property><name>fs.defaultFS</name><value>file:///evil</value></property></configuration>",
    "openssl.cnf": "openssl_conf = e\n[e]\nengines = f\n[f]\ng = h\n[h]\ndynamic_path = ./libarrow.so\ninit = 1\n",
    ".aws/config": "[default]\ncredential_process = touch {mark}\n",
    "malloc.conf": "prof:true,prof_prefix:evil",
    "numba.cfg": "cache_dir = .k\n",
    ".netrc": "machine x login y password z",
}


_KERNELS = 200  # of those that were compiled last: all that a machine has ever compiled take longer than the command


class Hostile:
    """A folder, and what shows that something of it was executed."""

    def __init__(self, folder: Path, mark: Path, seed: int):
        """Take the folder, which may hold a run or other data already, the mark, and what the choices are drawn with."""
        self.folder, self.mark, self.rng = folder, mark, np.random.default_rng(seed)

    @property
    def pickled(self) -> bytes:
        """A pickle that touches the mark."""
        return b"cposix\nsystem\n(S'touch %s'\ntR." % os.fsencode(self.mark)

    def write(self) -> None:
        """Fill the folder, and some of the folders below it."""
        folders = [self.folder, *(path for path in self.folder.rglob("*") if path.is_dir() and self.rng.random() < 0.3)]
        for folder in folders:
            self._modules(folder)
            self._one(folder / ".numba_config.yaml", NUMBA)
            self._one(folder / "matplotlibrc", MATPLOTLIB)
            for name, text in SETTINGS.items():
                self._put(folder / name, text.format(mark=self.mark))
        self._kernels(self.folder / ".k")
        self._binaries()
        self._links()

    def _modules(self, folder: Path) -> None:
        code = f"import os\nos.system('touch {self.mark}')\n"
        modules = _MODULES.split()
        for name in list(map(str, self.rng.permutation(modules)))[: self.rng.integers(len(modules) // 2, len(modules))]:
            package = self.rng.random() < 0.3
            self._put(folder / name / "__init__.py" if package else folder / f"{name}.py", code)
        for name in ("state.pkl", "a.nbi", "a.nbc", "__pycache__/a.nbi", "parts/0.pkl"):
            self._put(folder / name, self.pickled)

    def _one(self, path: Path, texts: tuple[str, ...]) -> None:
        """Write one of the texts, or what is no file: a pipe, a folder, a link to a device or out of the folder."""
        kind = self.rng.integers(10)
        if path.exists():
            return
        if kind == 0:
            os.mkfifo(path)
        elif kind == 1:
            path.symlink_to("/dev/zero")
        elif kind == 2:
            path.mkdir()
        else:
            text = texts[int(self.rng.integers(len(texts)))]
            self._put(path, text.format(mark=self.mark) if "{mark}" in text else text)

    def _kernels(self, folder: Path) -> None:
        """Write kernels under the names of those that are used here, and of the newest, with the digests they should have."""
        import hashlib

        content = hashlib.sha256(self.pickled).digest() + self.pickled
        kept = [path for source in (SHIPPED, cache_folder()) if source.is_dir() for path in source.glob("*.kernel")]
        newest = sorted(kept, key=lambda path: path.stat().st_mtime)[-_KERNELS:]
        for name in {path.name for path in (*LOADED, *newest)}:
            self._put(folder / name, content)
            self._put(self.folder / name, content)

    def _binaries(self) -> None:
        for name in PROGRAMS:
            self._put(self.folder / name, f"#!/bin/sh\ntouch {self.mark}\n")
            if (self.folder / name).is_file():
                (self.folder / name).chmod(0o755)
        library = shared_library(self.mark)
        for name in LIBRARIES:
            if library is not None:
                self._put(self.folder / name, library)

    def _links(self) -> None:
        """Turn a file of the data into a link, a pipe or a device now and then."""
        files = sorted(
            path for path in self.folder.rglob("*") if path.suffix in (".toml", ".parquet", ".json", ".html", ".rrd", ".xml")
        )
        if files and self.rng.random() < 0.4:
            path = files[int(self.rng.integers(len(files)))]
            path.unlink()
            kind = self.rng.integers(4)
            if kind == 0:
                os.mkfifo(path)
            else:
                path.symlink_to(("/dev/zero", "/etc/passwd", self.folder / "state.pkl")[kind - 1])
        for name in (".run.wirerope.part", ".o.csv.wirerope.part", "MUJOCO_LOG.TXT"):
            if self.rng.random() < 0.3:
                os.mkfifo(self.folder / name)

    def _put(self, path: Path, content: str | bytes) -> None:
        """Write a file where there is none."""
        if path.exists() or path.is_symlink() or any(parent.exists() and not parent.is_dir() for parent in path.parents):
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode("latin-1"))


SERVERS = {"board": "Open http"}
"""Commands that do not end by themselves, and what they print once they serve."""

_COMPILED: dict[Path, bytes | None] = {}


def shared_library(mark: Path) -> bytes | None:
    """Return a shared library that touches the mark when it is loaded; None where there is no compiler."""
    if mark not in _COMPILED:
        compiler = shutil.which("gcc")
        made = mark.with_suffix(".so")
        source = '#include <stdlib.h>\n__attribute__((constructor)) void f(void) { system("touch MARK"); }\n'.replace(
            "MARK", str(mark)
        )
        if compiler:
            subprocess.run([compiler, "-shared", "-fPIC", "-x", "c", "-", "-o", made], input=source, text=True, check=True)
        _COMPILED[mark] = made.read_bytes() if compiler else None
    return _COMPILED[mark]


def audited(command: list[str], folder: Path, log: Path, *, python: str = sys.executable, code: tuple[str, ...] = ()):
    """Run a command in a folder, and return its exit code, what it printed, and what it executed from elsewhere.

    A server is ended once it serves; what does not end in ten minutes is killed.
    """
    allowed = {sys.prefix, sys.base_prefix, sysconfig.get_path("stdlib"), str(Path(wirerope_mj.__file__).parents[1]), *code}
    environment = {
        **os.environ, "PYTHONPATH": str(Path(__file__).parent / "audited"), "AUDIT_LOG": str(log),
        "AUDIT_FOLDER": str(folder.resolve()),
        "AUDIT_CODE": os.pathsep.join(sorted(allowed | {os.path.realpath(path) for path in allowed})),
    }  # fmt: skip
    process = subprocess.Popen(
        [str(Path(python).with_name("wirerope")), *command], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
    )  # fmt: skip
    timer, printed = Timer(600.0, process.kill), ""
    timer.start()
    with process:
        for line in process.stdout:
            printed += line
            if command[0] in SERVERS and SERVERS[command[0]] in line:
                process.terminate()
    timer.cancel()
    return process.returncode, printed, log.read_text() if log.exists() else ""
