"""The documentation site: `python -m sphinx -W -b html docs docs/_build/html` builds it, without a network."""

import re
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike
from pygments.lexers.special import TextLexer
from sphinx.ext.napoleon.docstring import GoogleDocstring
from sphinx.util.typing import stringify_annotation

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
exclude_patterns = [
    "_build", "_shared", "specimens", "notebooks", "gallery/figures", "thesis/templates", "**sg_execution_times.rst",
]  # fmt: skip
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
    "image_srcset": ["2x"],
    "reset_modules": ("matplotlib", "site_pages.plain_figures"),
}

html_theme = "furo"
pygments_dark_style = "github-dark"  # code blocks follow the theme
html_extra_path = ["_shared"]
html_static_path = ["site"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_show_search_summary = False  # browsers read no other file beside one
html_title = f"wirerope_mj {release}"
html_show_sourcelink = False
suppress_warnings = ["config.cache"]

write_commands(HERE / "commands.md")
write_api(HERE / "api")
write_recording(HERE / "_shared" / "recordings" / "floor", "floating_floor_shock")

_OUTSIDE = {"../models/README.md": "models.md", "../benchmarks/README.md": "benchmarks.md"}


def _whole(self: GoogleDocstring) -> list[str]:
    """Return the docstring of a property as it stands: it holds no type before a colon."""
    return list(self._dedent(self._consume_to_end()))


GoogleDocstring._parse_attribute_docstring = _whole  # type: ignore[method-assign]

_ARRAY_LIKE = stringify_annotation(ArrayLike, "smart")


def _array_like(
    app: Any, what: str, name: str, thing: Any, options: Any, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """Write ArrayLike as it is called, not as what it stands for."""
    return signature and signature.replace(_ARRAY_LIKE, "ArrayLike"), returned


def _formulas_stand(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Keep the lines of indented formulas apart: a paragraph before them ends in two colons for reStructuredText."""
    for number in range(len(lines) - 1, 1, -1):
        begins = lines[number].startswith("    ") and not lines[number - 1].strip()
        before = lines[number - 2]
        if begins and before.strip() and not before.startswith(" ") and not before.endswith("::"):
            lines[number:number] = ["::", ""]


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
    app.connect("autodoc-process-docstring", _formulas_stand, priority=400)  # before napoleon
    app.connect("autodoc-process-docstring", _bars_are_text)
    app.connect("autodoc-process-signature", _array_like)
    app.connect("source-read", _links_stay_inside)
