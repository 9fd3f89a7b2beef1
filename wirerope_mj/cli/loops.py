"""`wirerope loops` and `wirerope laws`: cyclic tests of an isolator or a law, and which law fits measured ones."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from wirerope_mj.cli.options import Integer, Texts

if TYPE_CHECKING:
    from wirerope_mj.mounts.isolator import Isolator

# Default amplitudes as fractions of the rated travel: enough to see where softening ends.
_FRACTIONS = (0.05, 0.1, 0.25, 0.5, 1.0)


def loops(
    source: str,
    *,
    amplitudes: Annotated[
        list[float] | None, Parameter(name=("--amplitudes", "--amplitudes-mm"), consume_multiple=True, negative=())
    ] = None,
    operating_point_mm: float = 0.0,
    axis: Literal["roll", "shear", "axial"] | None = None,
    frequency: float = 1.0,
    cycles: Integer | None = None,
    out: Path | None = None,
    csv: Path | None = None,
) -> int:
    """Test an isolator or a law in a virtual rig: print what its loops measure and draw them.

    Args:
        source: isolator of the catalogue, or the path of an isolator file or of a law file: a TOML file that holds what stands
            under an axis of an isolator file, law = "..." and its parameters.
        amplitudes: of the sine [mm], one or several; 5, 10, 25, 50 and 100 % of the rated travel by default.
        operating_point_mm: mean deflection [mm], negative in compression; the test ramps there first.
        axis: the only axis to test; for a law file the axis that it stands for, axial by default.
        frequency: of the sine [Hz]; without effect on a rate-independent law.
        cycles: cycles to run before the loop is taken; until it closes by default.
        out: where the picture is written (.png, .svg, .pdf); NAME-loops.png in the current folder by default.
        csv: where the loops of one axis are written, in m and N.
    """
    from wirerope_mj.cli.isolators import check_picture, say_written
    from wirerope_mj.content.blocks import Chart
    from wirerope_mj.content.cyclic_tests import CyclicTests, loops_content
    from wirerope_mj.foundation.arguments import positive
    from wirerope_mj.foundation.atomic_files import check_writable
    from wirerope_mj.mounts.isolator.device import amplitudes_of, distinct_axes
    from wirerope_mj.mounts.test_rig import cyclic_test, save_cyclic_test
    from wirerope_mj.views.pictures import save_pictures
    from wirerope_mj.views.terminal import show

    device, stem, rated = _load(source, axis)
    picture = Path(f"{stem}-loops.png") if out is None else out
    check_picture(picture)
    laws = {title: (one, law) for title, one, law in distinct_axes(device)}
    if axis is not None:
        if (law := device.axes[axis]) is None:
            present = ", ".join(name for name, other in device.axes.items() if other is not None)
            raise ValueError(f"`--axis {axis}`: {device.name} has no force on this axis, only on {present}.")
        laws = {axis: (axis, law)}
    if csv is not None:
        if len(laws) > 1:
            raise ValueError(f"`--csv` holds the loops of one axis: name it with --axis; here are {', '.join(laws)}.")
        check_writable(csv)
    if amplitudes is None and not rated:
        raise ValueError(f"{source} is a law without a rated travel: say at which `--amplitudes` [mm] to test it.")
    sizes = None if amplitudes is None else [positive("--amplitudes", size, unit="mm") / 1e3 for size in amplitudes]
    mean = operating_point_mm / 1e3
    how: dict[str, Any] = {"operating_point": mean, "frequency": frequency}
    found = {
        title: cyclic_test(law, sizes or amplitudes_of(device, one, _FRACTIONS), cycles=cycles, **how)
        for title, (one, law) in laws.items()
    }
    tested = {title: law for title, (_, law) in laws.items()}
    content = loops_content(CyclicTests(isolator=device, laws=tested, loops=found, **how))
    show(content)
    save_pictures([block for block in content.blocks() if isinstance(block, Chart)], picture, title=device.name)
    say_written(picture)
    if csv is not None:
        save_cyclic_test(next(iter(found.values())), csv, frequency=frequency)
        say_written(csv)
    return 0


def _load(source: str, axis: str | None) -> "tuple[Isolator, str, bool]":
    """Load an isolator, a law file as one of a single axis; return it, a name for its files, and if it may have ratings."""
    import tomllib

    from wirerope_mj.foundation.resources import catalogue_folder
    from wirerope_mj.foundation.structure import Place
    from wirerope_mj.foundation.toml_file import toml_content
    from wirerope_mj.mounts.isolator import Isolator, Limits, Travel, read_law
    from wirerope_mj.mounts.vendor_parts import VendorPart, find_isolator, load_isolator

    given = Path(source)
    path = given if given.is_file() else find_isolator(source, beside=catalogue_folder())
    if isinstance(path, VendorPart):
        return load_isolator(path), path.name, True
    try:
        content = toml_content(path)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return load_isolator(path), path.stem, True  # says what is wrong with the file
    if "law" in content or "laws" in content:
        law = read_law(content, Place(path))
        axes: dict[str, Any] = {axis or "axial": law}
        # A law file has no ratings; a law that ends somewhere says so itself when a test leads there.
        end = law.finite_travel if law.needs_rating and law.finite_travel < math.inf else None
        ends = None if end is None else math.nextafter(end, 0.0)
        travel = Travel(compression=ends, tension=ends, shear=ends, roll=ends)
        return Isolator(name=path.stem, limits=Limits(travel=travel), **axes), path.stem, False
    return load_isolator(path), path.stem, True


def laws(*files: Path, elements: int = 5, law: Texts = None) -> int:
    """Compare laws on records of cyclic tests: which fits, and which holds for amplitudes that it has not seen.

    Prints the error of each law at each amplitude, root mean square in percent of half of the force range as `identify` does,
    of the fit to all loops and of the fit to all others. A difference of the Bayesian criterion (BIC) of ten or more counts.
    The law with the smallest errors on amplitudes left out is the one to trust between those that were tested. A law with too
    many parameters for one amplitude less has none; it is recommended where it fits far better than every law that has. Of
    cycles beyond the largest tested one no error speaks.

    Args:
        files: records, one or several.
        elements: Jenkin elements of a masing law.
        law: names of the laws to compare; five by default, from three parameters up.
    """
    from wirerope_mj.content.cyclic_tests import law_choice_statement
    from wirerope_mj.engine.simulation.progress import share_bar
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.mounts.identification.choice import USUAL, compare_laws
    from wirerope_mj.mounts.identification.records import read_tests
    from wirerope_mj.mounts.laws import LAWS
    from wirerope_mj.views.terminal import print_block

    if unknown := [name for name in law or () if name not in LAWS]:
        raise ValueError(f"`--law`: there is no law {unknown[0]!r}; the laws are {', '.join(sorted(LAWS))}.")
    kinds = [LAWS[name] for name in law] if law else USUAL
    measured = [loop for one in read_tests(files, stop=False).values() for loop in one]
    with share_bar("comparing", "% of the fits", enabled=True) as update:
        table = compare_laws(
            measured, laws=kinds, elements=elements, progress=lambda fraction: update(fraction, 100.0 * fraction)
        )
    for line in str(table).splitlines():
        print(plain(line))
    print_block(law_choice_statement(table, " ".join(map(str, files))))
    return 0
