"""`python -m verification [case ...] [--data FOLDER] [--page FILE]`: run cases, print a table, write the page."""

import argparse
import sys
from pathlib import Path

from verification.cases import CASES
from verification.page import print_table, write_page
from verification.runner import FAILED, OUTSIDE, run_case


def main() -> int:
    """Return 1 if a case failed or is outside its bound for no known reason, else 0; what could not be run does not count."""
    known = {case.name: case for case in CASES}
    parser = argparse.ArgumentParser(prog="python -m verification", description=__doc__)
    parser.add_argument("cases", nargs="*", metavar="case", help="names of cases; all without any")
    parser.add_argument("--page", type=Path, help="write the results as a page, for instance docs/verification.md")
    parser.add_argument("--list", action="store_true", help="list the cases and run none")
    parser.add_argument("--data", type=Path, help="folder of measured tests; without it the cases that need them are not run")
    options = parser.parse_args()
    if options.data and not options.data.is_dir():
        parser.error(f"--data must be a folder of measured tests, got {options.data}: there is no such folder")
    unknown = [name for name in options.cases if name not in known]
    if unknown:
        parser.error(f"no case is called {', '.join(unknown)}; --list names them all")
    if options.page and options.cases:
        parser.error("the page holds all cases: leave out the names of single ones")
    chosen = [known[name] for name in options.cases] or list(CASES)
    if options.list:
        print("\n".join(f"{case.name:32} {case.title}" for case in chosen))
        return 0
    results = []
    for case in chosen:
        print(f"{case.name} ...", end="", flush=True, file=sys.stderr)
        results.append(run_case(case, options.data))
        print(f" {results[-1].status}, {results[-1].seconds:.1f} s", file=sys.stderr)
    print_table(results)
    if options.page:
        write_page(results, options.page)
    return int(any(r.status == FAILED or (r.status == OUTSIDE and not r.case.known) for r in results))


if __name__ == "__main__":
    sys.exit(main())
