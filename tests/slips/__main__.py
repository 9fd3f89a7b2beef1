"""Plant every slip into every base and print what is said: python -m tests.slips [part of a slip's or a campaign's name]."""

import sys
import tempfile
from importlib import import_module
from pathlib import Path

from tests.slips.foreign_inputs import foreign_inputs
from tests.slips.planting import Base, Outcome, Slip, planted, told
from tests.slips.unusual_inputs import unusual_inputs

CAMPAIGNS = ("models_and_tables", "records_and_jobs", "from_practice", "in_context")


def slips(part: str = "") -> list[Slip]:
    """Return the slips of all campaigns whose names, or whose campaign's, hold `part`."""
    every = [(campaign, slip) for campaign in CAMPAIGNS for slip in import_module(f"tests.slips.{campaign}").SLIPS]
    return [slip for campaign, slip in every if part in campaign or part in slip.name]


def bases(chosen: list[Slip]) -> list[Base]:
    """Return the bases of slips, each once."""
    return list({id(base): base for slip in chosen for base in slip.bases}.values())


def _line(outcome: Outcome) -> str:
    first = next((text for text in outcome.sentences if outcome.named), "") or next(iter(outcome.sentences), "(nothing)")
    word = "yes" if outcome.named else "not told" if outcome.slip.untold else "NO"
    return f"{outcome.slip.name} | {outcome.base.name} | {' '.join(first.split())[:160]} | {word}"


def main() -> int:
    chosen, outcomes, alarms = slips(" ".join(sys.argv[1:])), list[Outcome](), 0
    right = [*bases(chosen), *foreign_inputs(), *unusual_inputs()]
    with tempfile.TemporaryDirectory() as folder:
        for number, base in enumerate(right):
            for sentence in told(base, Path(folder) / f"base{number}"):
                alarms += 1
                print(f"FALSE ALARM | {base.name} | {sentence}")
        pairs = [(slip, base) for slip in chosen for base in slip.bases]
        for number, (slip, base) in enumerate(pairs):
            outcomes.append(planted(slip, base, Path(folder) / f"slip{number}"))
            print(_line(outcomes[-1]), flush=True)
    named = sum(outcome.named for outcome in outcomes)
    for slip in chosen:
        if slip.untold:
            print(f"not told: {slip.name}: {slip.untold}")
    print(f"{len(chosen)} slips: {named} of {len(outcomes)} named; {alarms} false alarms over {len(right)} inputs.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
