"""Runs: a scenario simulated into one folder that is complete in itself, and run again from it.

```text
scenario.toml      every resolved input, and the versions that computed it
model/             the MJCF, and every file that it refers to
inputs/            the records that the base motion was read from, if any
response.parquet   the response, float64
summary.json       peaks, limits, verdicts, how it was computed
run.rrd            the view
histories.png, loops.png
report.html        everything of these that an engineer hands over, on one page
checksums.txt      SHA-256 of every other file, as sha256sum writes them: what says later which were altered
```
"""

from wirerope_mj.runs.job import JobRun, run_job
from wirerope_mj.runs.job_file import Job, load_job
from wirerope_mj.runs.repeat import Replay, replay
from wirerope_mj.runs.write import run_scenario, write_run
