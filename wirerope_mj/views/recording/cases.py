"""Load cases of one model in one layout, which the viewer has for all recordings of an application."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import rerun.blueprint as rrb

from wirerope_mj.content.histories import USED
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.run import panel_over_frequency
from wirerope_mj.foundation.plain_text import markdown, markdown_lines
from wirerope_mj.views.recording.blueprint import blueprint_of, loop_widths
from wirerope_mj.views.recording.drawn_runs import Drawn, one_run, shared_selection
from wirerope_mj.views.recording.ghosts import ghost_factor
from wirerope_mj.views.recording.loops import LoopPlot, drawn_loops, loop_plots
from wirerope_mj.views.recording.texts import run_texts


def cases_drawn(runs: Mapping[str, JudgedRun], notes: Mapping[str, str]) -> dict[str, Drawn]:
    """Return what is drawn of each case: the mounts, loops and lanes that matter in any of them."""
    alone = {name: one_run(run, panel_over_frequency(run)) for name, run in runs.items()}
    drawn_runs = [drawn.runs[0] for drawn in alone.values()]
    shared = shared_selection(drawn_runs, drawn_runs[0].selection.mounts)
    found = {}
    for name, run in runs.items():
        text = "\n\n".join(filter(None, (markdown_lines(notes[name]), f"**Base motion:** {markdown(run.acting)}")))
        texts = run_texts(run, title=name, scenario_text=text)
        banner = replace(texts[0], text=f"{markdown(name)}: {texts[0].text}")
        found[name] = replace(alone[name], shared=shared, texts=(banner, *texts[1:]), cases=True)
    return found


def layout_of_cases(cases: Sequence[Drawn]) -> tuple[rrb.Blueprint, float]:
    """Return the layout of all cases, and the factor by which it enlarges the ghosts' motion."""
    shared, factor = cases[0].shared, min(map(ghost_factor, cases))
    panels = {key: panel for drawn in reversed(cases) for key, panel in drawn.panels.items()}
    panels = {key: panels[key] for drawn in cases for key in drawn.panels}
    if (USED,) in panels:
        panels[USED,] = replace(panels[USED,], title="Used of the limits [%]")
    over_frequency = [drawn.over_frequency for drawn in cases if drawn.over_frequency is not None]
    labels = {panel.ylabel or panel.title for panel in over_frequency}
    if len(labels) > 1:
        over_frequency[0] = replace(over_frequency[0], ylabel="Spectra")
    drawn = replace(
        cases[0], panels=panels, over_frequency=over_frequency[0] if over_frequency else None,
        texts=tuple({text.path: text for case in cases for text in case.texts}.values()),
    )  # fmt: skip
    plots: dict[str, LoopPlot] = {}
    for case in cases:
        for plot in loop_plots(drawn_loops(case.runs, shared), shared, loop_widths(case)):
            before = plots.get(plot.path)
            plots[plot.path] = plot if before is None else replace(before, loops=(*before.loops, *plot.loops))
    # The view of a loop has one length of trail: the shortest that any case needs.
    ordered = [
        replace(plot, loops=tuple(sorted(plot.loops, key=lambda loop: -(loop[1].trail or float("inf")))))
        for plot in plots.values()
    ]
    return blueprint_of(drawn, ordered, factor, tab="Overview", scene=""), factor
