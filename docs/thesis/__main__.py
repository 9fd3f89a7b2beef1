"""Compute all numbers and pictures of the pages about the thesis and write them: python -m docs.thesis [CHAPTER ..]."""

import json
import sys
import time

from build import save  # of the gallery

from docs.thesis import FOLDER
from docs.thesis.pages import CHAPTERS, NUMBERS, chapter, page, stored, written


def main(names: list[str]) -> None:
    """Write the pages of these chapters, of all if none is named; the other chapters' numbers stay."""
    numbers = stored() if NUMBERS.exists() else {}
    for name in names or CHAPTERS:
        began, module = time.perf_counter(), chapter(name)
        numbers[name] = {key: float(f"{value:.7g}") for key, value in module.numbers().items()}
        ordered = {one: numbers[one] for one in CHAPTERS if one in numbers}
        NUMBERS.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8", newline="\n")
        for picture, draw in module.pictures().items():
            save(draw(), FOLDER / f"{picture}.png")
        page(name).write_text(written(name, numbers[name]), encoding="utf-8", newline="\n")
        print(f"{name}: {len(numbers[name])} numbers, {time.perf_counter() - began:.0f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
