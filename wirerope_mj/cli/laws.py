"""`wirerope laws`: which law fits records of cyclic tests, and which holds for amplitudes that it has not seen."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter


def laws(
    *files: Path,
    elements: int = 5,
    law: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
) -> int:
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
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.mounts.identification.choice import USUAL, compare_laws
    from wirerope_mj.mounts.identification.records import read_tests
    from wirerope_mj.mounts.laws import LAWS

    if unknown := [name for name in law or () if name not in LAWS]:
        raise ValueError(f"`--law`: there is no law {unknown[0]!r}; the laws are {', '.join(sorted(LAWS))}.")
    kinds = [LAWS[name] for name in law] if law else USUAL
    loops = [loop for one in read_tests(files, stop=False).values() for loop in one]
    table = compare_laws(loops, laws=kinds, elements=elements)
    for line in str(table).splitlines():
        print(plain(line))
    best, general, chosen = table.best, table.most_general, table.recommended
    print(plain(f"{best.law} has the best criterion, {general.law} the smallest error on an amplitude left out."))
    if chosen is not general:
        text = (
            f"{chosen.law} has no error on an amplitude left out, for which there are too few, but errs by at most "
            f"{100.0 * chosen.errors.max():.2g} % where {general.law} errs by {100.0 * general.errors.max():.2g} %: test one "
            "amplitude more to see how it predicts."
        )
        print(plain(text))
    farthest = 1e3 * float(table.amplitudes[-1])
    print(plain(f"Errors are those of cycles up to ±{farthest:.3g} mm; of larger ones they say nothing."))
    names = " ".join(str(path) for path in files)
    print(plain(f"wirerope identify {names} --law {chosen.law} --out isolator.toml"))
    return 0
