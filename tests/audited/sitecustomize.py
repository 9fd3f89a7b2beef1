"""Imported by every Python of a test that has this folder on its path: what a process executes from elsewhere is noted.

`AUDIT_LOG` names the file of notes, `AUDIT_FOLDER` the folder that nothing may come from, `AUDIT_CODE` those that code may.
"""

import os
import shutil
import sys

_LOG = os.open(os.environ["AUDIT_LOG"], os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
_HOSTILE = os.environ["AUDIT_FOLDER"]
_CODE = (os.path.dirname(os.path.realpath(__file__)), *os.environ["AUDIT_CODE"].split(os.pathsep))
_PROGRAMS = ("/usr/", "/bin/", "/sbin/", "/lib")
_SETTINGS = ("matplotlibrc", ".numba_config.yaml", "ipython_config.py", ".env", "conftest.py")
_READ_AS_CODE = (".kernel", ".pkl", ".nbi", ".nbc", ".py", ".pyc", ".so", ".pth")
_HARMFUL = {
    "system",
    "popen",
    "Popen",
    "exec",
    "eval",
    "compile",
    "getattr",
    "__import__",
    "open",
    "execv",
    "spawnv",
    "touch",
}


def _note(event, what):
    os.write(_LOG, f"{event}: {what}\n".encode(errors="replace"))


def _allowed(name):
    """Return whether code of this name may run: of the package or the interpreter, or made by code that is."""
    if name.startswith("<"):
        try:
            caller = sys._getframe(2).f_code.co_filename
        except ValueError:  # what was given to the interpreter with -c
            return True
        return caller.startswith("<") or _allowed(caller)
    path = os.path.realpath(name)
    if path.endswith("fmu_slave.py"):  # a copy in a temporary folder, as other programs run it
        return "pythonfmu_" in path and not path.startswith(_HOSTILE)
    return path.startswith(_CODE) and not path.startswith(_HOSTILE)


def _is_only_handled():
    """Return whether a file is read for its checksum, as every file of a run is, or opened to be removed with its folder."""
    frame, depth = sys._getframe(2), 0
    while frame is not None and depth < 5:
        if frame.f_code.co_name in ("digest_of", "_rmtree_safe_fd"):
            return True
        frame, depth = frame.f_back, depth + 1
    return False


def _hook(event, arguments):
    if event == "exec":
        name = getattr(arguments[0], "co_filename", "")
        if not _allowed(name):
            _note(event, name)
    elif event == "import" and arguments[1]:
        if not _allowed(arguments[1]):
            _note(event, arguments[1])
    elif event == "ctypes.dlopen":
        name = arguments[0]
        if isinstance(name, str) and os.path.realpath(name).startswith(_HOSTILE) and os.sep in name:
            _note(event, name)
    elif event == "pickle.find_class":
        if str(arguments[1]).rpartition(".")[2] in _HARMFUL and arguments[0] in (
            "os",
            "posix",
            "nt",
            "builtins",
            "subprocess",
        ):
            _note(event, arguments)
    elif event in ("subprocess.Popen", "os.exec", "os.posix_spawn"):
        given = arguments[0] or arguments[1][0]
        program = os.path.realpath(shutil.which(os.fsdecode(given)) or os.fsdecode(given))
        if not (program.startswith(_PROGRAMS) or _allowed(program)) or program.startswith(_HOSTILE):
            _note(event, arguments[:2])
    elif event == "os.system":
        _note(event, arguments)
    elif event == "open" and isinstance(arguments[0], str | bytes):
        path = os.fsdecode(arguments[0])
        inside = os.path.realpath(path).startswith(_HOSTILE) or os.path.abspath(path).startswith(_HOSTILE)
        if inside and (os.path.basename(path) in _SETTINGS or path.endswith(_READ_AS_CODE)) and not _is_only_handled():
            _note(event, path)


sys.addaudithook(_hook)
