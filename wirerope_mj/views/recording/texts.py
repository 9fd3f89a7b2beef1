"""Texts of a recording, all of them content as Markdown: of a run alone, and of several over each other."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress

from wirerope_mj.assessment.comparison import Comparison
from wirerope_mj.assessment.correlation import Correlation
from wirerope_mj.content.blocks import Block
from wirerope_mj.content.comparison import Inputs, comparison_content
from wirerope_mj.content.correlation import agreement
from wirerope_mj.content.judged_run import JudgedRun, RunResult
from wirerope_mj.content.modes import run_modes_blocks
from wirerope_mj.content.mounts import contact_blocks, mount_blocks
from wirerope_mj.content.run import acceleration_blocks, numerics_statement
from wirerope_mj.content.verdicts import answer_blocks, full_table, headline, most_critical
from wirerope_mj.foundation.plain_text import markdown, plain_lines
from wirerope_mj.foundation.tables import Table
from wirerope_mj.views.markdown import markdown_blocks
from wirerope_mj.views.recording.drawn_runs import Text

BANNER, BELOW = "banner", "below"


def run_texts(run: RunResult, *, title: str, scenario_text: str) -> tuple[Text, ...]:
    """Write verdict, scenario, peaks, all verdicts and the modes of a run; `scenario_text` is Markdown, or TOML, set as such.

    Of a run whose system is not at hand there are no modes.
    """
    first = [headline(run.verdicts), most_critical(run.verdicts)]
    peaks: list[Block | None] = [*first[:1], *answer_blocks(run)]
    peaks += [*acceleration_blocks(run), *mount_blocks(run), *contact_blocks(run)]
    body = scenario_text.strip()
    with suppress(tomllib.TOMLDecodeError):
        if tomllib.loads(scenario_text):  # a block of code, whose fence is longer than any row of backticks in it
            fence = "`" * max(max(map(len, re.findall("`+", body)), default=0) + 1, 3)
            body = f"{fence}toml\n{plain_lines(body)}\n{fence}"
    numerics = markdown(numerics_statement(run.response.numerics).text)
    scenario = [f"### {markdown(title or run.response.scene.name)}", body, f"*{numerics}*"]
    critical = markdown_blocks(first[1:])
    banner = f"**{markdown(run.headline)}**  {critical}".strip()
    modes = markdown_blocks(run_modes_blocks(run)) if isinstance(run, JudgedRun) else ""
    return (
        Text(path=("verdict",), name="Verdict", place=BANNER, text=banner),
        Text(path=("scenario",), name="Scenario", place=BELOW, text="\n\n".join(filter(None, scenario))),
        Text(path=("peaks",), name="Peaks", place="Peaks", text=markdown_blocks(peaks)),
        Text(path=("verdicts",), name="Verdicts", place="Verdicts", text=markdown_blocks([full_table(run.verdicts)])),
        *([Text(path=("modes",), name="Modes", place="Modes", text=modes)] if modes else []),
    )


def test_texts(tests: Sequence[Correlation]) -> tuple[Text, ...]:
    return tuple(
        Text(
            path=("tests", test.name), name=test.name, place="Agreement",
            text=markdown_blocks([agreement(test), test.table, test.ratings]),
        )
        for test in tests
    )  # fmt: skip


def overlay_texts(
    comparison: Comparison, inputs: Inputs, tables: Sequence[Table], judged: Mapping[str, JudgedRun] | None = None
) -> tuple[Text, ...]:
    """Write which run is better, what differs, peaks side by side, and tables of the study."""
    content = comparison_content(comparison, inputs, judged)
    sections = {section.id: markdown_blocks(section.blocks) for section in content.sections}

    def of(*names: str) -> str:
        return "\n\n".join(filter(None, (sections[name] for name in names)))

    study = [Text(path=("study",), name="Study", place="Study", text=markdown_blocks(tables))] if tables else []
    return (
        Text(path=("verdict",), name="Which is better", place=BANNER, text=f"**{markdown(content.verdict.text)}**"),
        Text(
            path=("differences",),
            name="What differs",
            place=BELOW,
            text=of("differences", "headlines", "findings", "credibility"),
        ),
        Text(
            path=("peaks", "accelerations"), name="Accelerations", place="Peaks", text=of("accelerations", "components")
        ),
        Text(
            path=("peaks", "mounts"), name="Mounts", place="Peaks", text=of("travel", "mounts") or "There are no mounts.",
        ),
        Text(path=("peaks", "apart"), name="Farthest apart", place="Peaks", text=of("apart")), *study,
    )  # fmt: skip
