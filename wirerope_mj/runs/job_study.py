"""A study of a job: the same variants of its system under every load case."""

from collections.abc import Mapping
from pathlib import Path

from wirerope_mj.content.blocks import Content
from wirerope_mj.content.job_study import job_study_content
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import write_json
from wirerope_mj.runs.from_scenario import limits_of, study_of
from wirerope_mj.runs.job_file import Job
from wirerope_mj.runs.page import write_page
from wirerope_mj.runs.study import CONTENT
from wirerope_mj.studies.inputs.distributions import Distribution
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.results.stated_limits import limit_of_text, write_stated
from wirerope_mj.studies.results.study_summary import StudySummary, summary_of
from wirerope_mj.views.json_content import plain_content


def study_job(job: Job, folder: str | Path, *, vary: Mapping[str, Distribution], how: Entries, drawn: Entries) -> Content:
    """Compute the same variants under every load case, write them and what they say into a folder, and return that.

    Each case is a study of its own in the folder of its name, judged by the job's limits on accelerations and on clearances
    of points; variant k is the same system in all of them, so that the probability that any limit of any case is exceeded
    can be told. `how` are other arguments of `Study.run`, `drawn` number of variants, sampling and seed as `study_of` takes
    them, and raises.
    """
    folder = Path(folder)
    cases: dict[str, StudySummary] = {}
    for case in job.cases:
        study = study_of(case.scenario, vary=vary, name=case.name, **drawn)
        limits = [limit_of_text(text, measure_names(study.base)) for text in limits_of(case.scenario)[0]]
        result = study.run(folder / case.folder, **how)
        write_stated(result, limits)
        cases[case.name] = summary_of(result)
    content = job_study_content(job.name, job.question, cases)
    write_json(folder / CONTENT, plain_content(content, "answer", "cases"))
    write_page(content, [folder / "report.html"])
    return content
