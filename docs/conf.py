"""The documentation site: `python -m sphinx -W -b html docs docs/_build/html` builds it, without a network."""

import re
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

from pygments.lexers.special import TextLexer

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from site_pages import write_api, write_commands, write_recording  # noqa: E402

project = "wirerope_mj"
author = "the wirerope_mj authors"
copyright = "the wirerope_mj authors, Apache-2.0"  # noqa: A001
release = metadata.version("wirerope-mj")

extensions = [
    "myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx-mathjax-offline", "sphinx_gallery.gen_gallery",
]  # fmt: skip
exclude_patterns = ["_build", "_shared", "specimens", "notebooks", "gallery/figures", "**sg_execution_times.rst"]
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence", "dollarmath"]

add_module_names = False
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
napoleon_google_docstring = True
napoleon_use_ivar = True
napoleon_use_rtype = False
default_role = "code"  # names in docstrings stand in single backquotes
python_use_unqualified_type_names = True

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "examples",
    "filename_pattern": r"/\d\d_",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "remove_config_comments": True,
    "min_reported_time": 1e9,
    "show_memory": False,
}

html_theme = "furo"
html_extra_path = ["_shared"]
html_title = f"wirerope_mj {release}"
html_show_sourcelink = False
suppress_warnings = ["config.cache"]

write_commands(HERE / "commands.md")
write_api(HERE / "api.rst")
write_recording(HERE / "_shared" / "recordings" / "floor", "floating_floor_shock")

_OUTSIDE = {"../models/README.md": "models.md", "../benchmarks/README.md": "benchmarks.md"}


def _bars_are_text(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Escape the bars of absolute values outside code, which reStructuredText takes for substitutions."""
    for number, line in enumerate(lines):
        parts = re.split(r"(`[^`]*`)", line)
        lines[number] = "".join(part if part.startswith("`") else part.replace("|", r"\|") for part in parts)


def _links_stay_inside(app: Any, name: str, source: list[str]) -> None:
    """Point links that leave this folder at the pages which hold the same here."""
    for outside, inside in _OUTSIDE.items():
        source[0] = source[0].replace(f"]({outside}", f"]({inside}")


def setup(app: Any) -> None:
    """Join the program's own texts with what Sphinx expects."""
    app.add_lexer("csv", TextLexer)
    app.connect("autodoc-process-docstring", _bars_are_text)
    app.connect("source-read", _links_stay_inside)
