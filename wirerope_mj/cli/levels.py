"""`wirerope levels`: files of levels to be filled in."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter


def levels(
    name: str | None = None, *, out: Path | None = None, force: Annotated[bool, Parameter(negative=())] = False
) -> int:
    """List files of levels to fill in from a specification, or write one, for `wirerope shock MODEL --levels FILE`.

    The files name the fields and formulas of a standard. Levels are those of your own specification: none is built in, and a
    motion with an open level is refused.

    Args:
        name: of the file, such as bv_043; without it all are listed.
        out: where it is written; NAME.toml in the current folder by default.
        force: replace a file that is there.
    """
    from wirerope_mj.cli.tables import print_questions
    from wirerope_mj.foundation.atomic_files import atomic_file
    from wirerope_mj.foundation.errors import RecordError
    from wirerope_mj.foundation.toml_file import read_toml
    from wirerope_mj.motions.restore import level_templates

    templates = level_templates()
    if name is None:
        print_questions(
            "levels", {stem: read_toml(path, "file of levels")["standard"] for stem, path in templates.items()}
        )
        return 0
    if name not in templates:
        raise ValueError(f"there are no levels {name!r}; there are {', '.join(templates)}.")
    target = out or Path(f"{name}.toml")
    if target.exists() and not force:
        raise RecordError(f"{target}: the file exists; --force replaces it.")
    with atomic_file(target) as temporary:
        temporary.write_bytes(templates[name].read_bytes())
    print(f"written: {target}")
    return 0
