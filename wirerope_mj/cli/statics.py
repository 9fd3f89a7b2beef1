"""`wirerope statics`: equilibrium of a model under its weight."""

from pathlib import Path

from wirerope_mj.cli.options import Deck, Model
from wirerope_mj.foundation.plain_text import plain

MISSING = 1  # Exit code if there is no virgin or no relaxed position; what there is has been printed


def statics(model: Model, *, deck: Deck = None, json: Path | None = None) -> int:
    """Print a model's equilibrium: sag and load of every mount, tilt of the payloads, verdicts on loads and travels.

    Virgin is the position after the weight was laid on slowly, relaxed the one after long vibration, when the hysteretic
    part of the load has leaked away; both stand below each other. Exits 1 if only one of them exists, and says why.

    Args:
        json: file for the same values in SI units.
    """
    from wirerope_mj.assessment.criteria import rest_travel_verdicts, rested_verdicts, static_load_verdicts
    from wirerope_mj.content.statics import statics_content
    from wirerope_mj.dynamics.modes import modes
    from wirerope_mj.engine.flexible import deck_of
    from wirerope_mj.engine.statics import model_warnings, static_table
    from wirerope_mj.engine.system import load_on_deck
    from wirerope_mj.foundation.atomic_files import check_writable, write_json
    from wirerope_mj.views.terminal import print_warnings, show

    if json is not None:
        check_writable(json)
    system = load_on_deck(model, deck_of(deck) if deck else None)
    warnings = model_warnings(system)
    print_warnings(warnings)
    table = static_table(system)
    isolators = {name: mount.isolator for name, mount in system.mounts.items()}
    verdicts = rested_verdicts(table) + static_load_verdicts(table) + rest_travel_verdicts(isolators, table, system.bottoms)
    stability = {history: modes(system, history=sag.history).stability for history, sag in table.sags.items()}
    show(statics_content(system.name, table, verdicts, stability))
    if json is not None:
        content = table.to_dict() | {
            "model_warnings": list(warnings),
            "verdicts": [verdict.to_dict() for verdict in verdicts],
            "stability": {history: values.to_dict() for history, values in stability.items()},
        }
        write_json(json, content)
        print(plain(f"  written to {json}"))
    return MISSING if table.missing else 0
