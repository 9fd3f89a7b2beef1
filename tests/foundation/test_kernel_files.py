"""Compiled kernels on disk: right code or a compilation, whatever was changed, cut off, forbidden, or done at the same time."""

import ast
import math
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numba
import pytest
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.event import Event, EventStatus

from wirerope_mj.foundation import jit, kernel_files, kernel_proof
from wirerope_mj.foundation.jit import njit
from wirerope_mj.foundation.kernel_proof import TESTED, doubt
from wirerope_mj.foundation.linked_code import LinkedCode

ROOT = Path(__file__).parents[2]

KERNELS = """
from wirerope_mj.foundation.jit import inlined, njit
import constants as at

FACTOR = 3.0

@njit
def apart(x):
    return x + 0.5

@{decorator}
def inner(x):
    return {inner}

@njit
def outer(x):
    return inner(x) + at.OFFSET
"""

USE = """
import sys
from numba.core import event
compiled = []
class Count(event.Listener):
    def on_start(self, event):
        compiled.append(event.data["dispatcher"].py_func.__name__)
    def on_end(self, event):
        pass
{before}
import wirerope_mj.foundation.jit  # which tries this Numba first, once
event.register("numba:compile", Count())
import kernels
print(kernels.outer(2.0), kernels.apart(2.0), *compiled)
"""


def test_nothing_is_said_of_functions_that_others_compile(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(jit, "PATIENCE", -1.0)
    monkeypatch.setattr(jit, "compile_beside", lambda: None)
    watch = jit.Watch(str(tmp_path))

    def said_of(function):
        for status in EventStatus:
            watch.notify(Event("numba:compile", status, {"dispatcher": SimpleNamespace(py_func=function)}))
        return capsys.readouterr().err

    def kernel(x):
        return x

    assert said_of(kernel) == ""
    njit(kernel)
    assert "kernels are compiled" in said_of(kernel)


@pytest.fixture
def use(tmp_path):
    """Return a function that calls two kernels in a new process: it returns their results, and which were compiled."""

    def run(*, inner="FACTOR * x", offset=1, decorator="njit", before="", wait=True, **environment):
        texts = {"kernels.py": KERNELS.format(inner=inner, decorator=decorator), "constants.py": f"OFFSET = {offset}\n"}
        for name, text in texts.items():
            if not (tmp_path / name).exists() or (tmp_path / name).read_text() != text:
                (tmp_path / name).write_text(text)
        values = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), **environment}
        process = subprocess.Popen(
            [sys.executable, "-B", "-c", USE.format(before=before)],
            cwd=tmp_path,
            env={name: value for name, value in values.items() if value is not None},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        if not wait:
            return process
        return outcome(process)

    return run


def outcome(process):
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    outer, apart, *compiled = out.split()
    return float(outer), float(apart), compiled


ALL = ["outer", "inner", "apart"]


def files(tmp_path):
    return sorted((tmp_path / "cache").glob("*.kernel"))


def test_a_second_process_compiles_nothing(use):
    assert use() == (7.0, 2.5, ALL)
    assert use() == (7.0, 2.5, [])


@pytest.mark.slow
def test_a_changed_kernel_is_compiled_again_with_those_that_call_it_and_no_other(use):
    use()
    assert use(inner="FACTOR * x + 1.0") == (8.0, 2.5, ["outer", "inner"])
    assert use() == (7.0, 2.5, [])  # what was there before is still right


def test_a_comment_changes_nothing(use):
    use()
    assert use(inner="FACTOR * x  # [N]") == (7.0, 2.5, [])


@pytest.mark.slow
def test_a_constant_of_another_module_counts(use):
    """So do the addresses of tables, which are such constants."""
    use()
    assert use(offset=2) == (8.0, 2.5, ["outer"])


@pytest.mark.slow
def test_how_a_kernel_is_compiled_counts(use):
    use()
    assert use(decorator="inlined")[2] == ["outer", "inner"]


@pytest.mark.slow
def test_another_numba_another_python_and_another_processor_compile(use):
    use()
    assert use(before="import numba; numba.__version__ = '0.1'") == (7.0, 2.5, ALL)
    assert use(before="import llvmlite; llvmlite.__version__ = '0.1'") == (7.0, 2.5, ALL)
    assert use(before="sys.implementation.cache_tag = 'cpython-399'") == (7.0, 2.5, ALL)
    assert use(NUMBA_CPU_NAME="x86-64-v2", NUMBA_CPU_FEATURES="") == (7.0, 2.5, ALL)
    assert use(NUMBA_OPT="1") == (7.0, 2.5, ALL)


@pytest.mark.slow
@pytest.mark.skipif(kernel_files.level() is None, reason="no code is shipped for this machine's processor")
def test_code_for_a_level_of_processors_is_used_by_those_that_have_its_features_and_no_others(use):
    assert kernel_files.level() == "x86-64-v3"  # the machine of these tests has it
    use(NUMBA_CPU_NAME="x86-64-v3", NUMBA_CPU_FEATURES="")
    lacking = (
        "import llvmlite.binding as llvm; features = llvm.get_host_cpu_features();"
        "llvm.get_host_cpu_features = lambda: type(features)({**features, '%s': False})"
    )
    assert use() == (7.0, 2.5, [])
    assert use(before=lacking % "fma") == (7.0, 2.5, ALL)
    use(NUMBA_CPU_NAME="x86-64-v2", NUMBA_CPU_FEATURES="")
    assert use(before=lacking % "avx2") == (7.0, 2.5, [])
    assert use(before=lacking % "popcnt") == (7.0, 2.5, ALL)


@pytest.mark.slow
def test_a_file_that_was_cut_off_is_compiled_anew_and_replaced(use, tmp_path):
    use()
    for path in files(tmp_path):
        path.write_bytes(path.read_bytes()[:-100])
    assert use() == (7.0, 2.5, ALL)
    assert use() == (7.0, 2.5, [])


@pytest.mark.slow
@pytest.mark.parametrize("content", [b"", b"short", b"no code at all"])
def test_a_file_of_anything_else_is_compiled_anew(use, tmp_path, content):
    use()
    checksum = kernel_files.hashlib.sha256(content).digest()
    for path in files(tmp_path):
        path.write_bytes(checksum + content if content else b"")
    assert use() == (7.0, 2.5, ALL)


@pytest.mark.slow
def test_a_folder_that_cannot_be_written_hinders_nothing(use, tmp_path):
    (tmp_path / "file").write_text("")
    assert use(NUMBA_CACHE_DIR=str(tmp_path / "file" / "cache")) == (7.0, 2.5, ALL)


@pytest.mark.slow
def test_two_processes_at_once_leave_whole_files(use, tmp_path):
    both = [use(wait=False), use(wait=False)]
    for process in both:
        assert outcome(process)[:2] == (7.0, 2.5)
    assert use() == (7.0, 2.5, [])
    assert len(files(tmp_path)) == 3
    assert {path.suffix for path in (tmp_path / "cache").iterdir()} == {".kernel", ".proof"}


def test_what_a_package_brings_along_is_found_with_no_cache_at_all(use, tmp_path):
    use(NUMBA_CPU_NAME="x86-64-v3", NUMBA_CPU_FEATURES="")
    (tmp_path / "cache").rename(tmp_path / "shipped")
    shipped = "import pathlib; from wirerope_mj.foundation import kernel_files; kernel_files.SHIPPED = pathlib.Path('shipped')"
    assert use(before=shipped) == (7.0, 2.5, [])
    assert not (tmp_path / "cache").exists()


@pytest.mark.slow
def test_a_wheel_that_is_built_twice_brings_the_same_kernels(use, tmp_path):
    text = (ROOT / "hatch_build.py").read_text(encoding="utf-8")
    repeatable = ast.literal_eval(re.search(r"^REPEATABLE = (.*)$", text, re.MULTILINE)[1])
    for place in ("first", "second"):
        assert use(NUMBA_CACHE_DIR=str(tmp_path / place), **repeatable) == (7.0, 2.5, ALL)
    first, second = ({file.name: file.read_bytes() for file in (tmp_path / p).glob("*.kernel")} for p in ("first", "second"))
    assert len(first) == len(ALL)
    assert first == second


@pytest.mark.slow
def test_settings_of_the_current_folder_say_nothing_of_where_kernels_are(use, tmp_path):
    """Reading a kernel executes what it holds, so that a folder that one looks at may not name the cache."""
    (tmp_path / ".numba_config.yaml").write_text("cache_dir: here\ncpu_name: generic\n")
    users = {"NUMBA_CACHE_DIR": None, "XDG_CACHE_HOME": str(tmp_path / "cache")}
    assert use(**users, before="import wirerope_mj") == (7.0, 2.5, ALL)
    assert not (tmp_path / "here").exists()
    assert len(list((tmp_path / "cache" / "wirerope_mj").glob("*.kernel"))) == 3


@pytest.mark.slow
def test_a_relative_folder_of_the_environment_is_not_used(use, tmp_path):
    (tmp_path / "home").mkdir(mode=0o700)
    relative = {"NUMBA_CACHE_DIR": "here", "XDG_CACHE_HOME": "there", "HOME": str(tmp_path / "home")}
    assert use(**relative) == (7.0, 2.5, ALL)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["constants.py", "home", "kernels.py"]
    assert use(**relative) == (7.0, 2.5, [])


owned = pytest.mark.skipif(not kernel_files._KNOWN, reason="this system has no owners and modes")


@pytest.mark.slow
@owned
@pytest.mark.parametrize("place", ["cache", "."])
def test_a_folder_that_others_may_write_is_not_used(use, tmp_path, place):
    use()
    (tmp_path / place).chmod(0o777)
    before = {path: path.stat().st_mtime_ns for path in files(tmp_path)}
    assert use() == (7.0, 2.5, ALL)
    assert {path: path.stat().st_mtime_ns for path in files(tmp_path)} == before
    assert f"others may write {(tmp_path / place).resolve()}" in kernel_files.where_kept(tmp_path / "cache")
    (tmp_path / place).chmod(0o755)
    assert use() == (7.0, 2.5, [])


@pytest.mark.slow
@owned
def test_a_folder_in_which_nobody_may_rename_what_is_not_theirs_may_be_above_it(use, tmp_path):
    tmp_path.chmod(0o1777)
    use()
    assert use() == (7.0, 2.5, [])


@pytest.mark.slow
@owned
def test_a_kernel_that_others_may_write_is_not_used_and_replaced(use, tmp_path):
    use()
    for path in files(tmp_path):
        path.chmod(0o666)
    assert use() == (7.0, 2.5, ALL)
    assert use() == (7.0, 2.5, [])


@pytest.mark.slow
@owned
def test_a_link_is_no_kernel(use, tmp_path):
    use()
    (tmp_path / "elsewhere").mkdir()
    for path in files(tmp_path):
        path.rename(tmp_path / "elsewhere" / path.name)
        path.symlink_to(tmp_path / "elsewhere" / path.name)
    assert use() == (7.0, 2.5, ALL)


@pytest.mark.slow
@owned
@pytest.mark.skipif(not kernel_files._KNOWN or os.geteuid() != 0, reason="only root may give files away")
@pytest.mark.parametrize("what", ["cache", "files"])
def test_what_belongs_to_another_user_is_not_used(use, tmp_path, what):
    use()
    for path in [tmp_path / "cache"] if what == "cache" else files(tmp_path):
        os.chown(path, 12345, -1)
    assert use() == (7.0, 2.5, ALL)


@njit
def root_of(x):
    if x < 0.0:
        raise ValueError("no root of a negative number")
    return math.sqrt(x)


@njit
def doubled_root(x):
    return 2.0 * root_of(x)


def test_only_what_python_calls_becomes_machine_code_and_what_it_calls_raises_as_its_own():
    assert doubled_root(4.0) == 4.0
    assert not root_of.overloads
    with pytest.raises(ValueError, match="no root of a negative number"):
        doubled_root(-1.0)
    assert root_of(4.0) == 2.0
    with pytest.raises(ValueError, match="no root of a negative number"):
        root_of(-1.0)


# Another Numba, as far as it matters here: a class under another name, and code that is read again from one argument.
RENAMED = "import numba.core.codegen as c; c.CodeLibrary3 = c.JITCodeLibrary; del c.JITCodeLibrary"
REBUILT = """
from numba.core.caching import CompileResultCacheImpl
from numba.core.compiler import CompileResult
before = CompileResult._rebuild
CompileResult._rebuild = classmethod(lambda cls, context, payload: before(context, *payload))
CompileResultCacheImpl.rebuild = lambda self, context, payload: CompileResult._rebuild(context, payload)
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("before", "why"), [(RENAMED, "cannot import name 'JITCodeLibrary'"), (REBUILT, "_rebuild|<lambda>")], ids=["name", "code"]
)
def test_with_a_numba_that_is_not_known_kernels_are_compiled_by_numba_alone_and_kept(use, before, why):
    use()  # a note that all is well with this Numba says nothing of another
    for compiled in (ALL, []):
        process = use(before=before, wait=False)
        out, err = process.communicate(timeout=120)
        assert out.split() == ["7.0", "2.5", *compiled]
        assert err.count("compiled by Numba alone") == 1
        assert re.search(why, err)
        assert f"pip install 'numba=={TESTED}.*'" in err
    assert use() == (7.0, 2.5, [])


@pytest.mark.parametrize(("error", "kept"), [(MemoryError, False), (OSError, False), (RuntimeError, True)])
def test_a_doubt_is_kept_if_it_is_one_of_this_numba_and_not_of_the_moment(error, kept, tmp_path, monkeypatch):
    def refuse(linked):
        raise error("no")

    monkeypatch.setattr(kernel_proof, "SHIPPED", tmp_path)
    monkeypatch.setattr(kernel_proof, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(kernel_proof, "_try", refuse)
    assert kernel_proof._doubt() == f"{error.__name__}: no"
    monkeypatch.setattr(kernel_proof, "_try", lambda linked: None)
    assert bool(kernel_proof._doubt()) is kept


def test_this_numba_is_known():
    assert doubt() == ""


def test_functions_of_others_are_compiled_as_numba_has_it():
    assert even(10)
    assert JITCPUCodegen._library_class is JITCodeLibrary
    assert JITCPUCodegen.set_env.__module__ == "numba.core.codegen"
    (code,) = even.overloads.values()
    assert type(code.library) is JITCodeLibrary
    assert doubled_root(4.0) == 4.0
    (code,) = doubled_root.overloads.values()
    assert type(code.library) is LinkedCode


def test_the_newest_numba_that_was_tested_is_the_newest_that_is_allowed():
    major, minor = map(int, TESTED.split("."))
    dependencies = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    assert f"numba>=0.65,<{major}.{minor + 1}" in dependencies


@numba.njit
def even(n):
    return n == 0 or odd(n - 1)


@numba.njit
def odd(n):
    return n != 0 and even(n - 1)


def test_functions_of_others_that_call_each_other_are_compiled_as_ever():
    assert even(10)
    assert not even(11)
