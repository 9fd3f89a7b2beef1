"""What strangers install and cite: recipe, image, citation and paper say what the package says."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CONDA = {"mujoco": "mujoco-python", "matplotlib": "matplotlib-base", "lazy_loader": "lazy-loader"}
"""Names of the same packages in the conda channel."""


@pytest.fixture(scope="module")
def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_conda_recipe_asks_for_what_the_package_asks_for(project):
    lines = (ROOT / "packaging/recipe.yaml").read_text(encoding="utf-8").splitlines()
    host, run = ([line.partition(" #")[0].strip(" -") for line in part] for part in _lists(lines, "  host:", "  run:"))
    python = f"python {project['requires-python']}"
    wanted = {python}
    for requirement in project["dependencies"]:
        name, bounds = re.fullmatch(r"([\w-]+)(.*)", requirement).groups()
        wanted.add(f"{CONDA.get(name, name)} {bounds}")
    assert set(run) == wanted
    assert set(host) == wanted - {python} | {"python", "pip", "hatchling >=1.27"}
    assert f'  skip: match(python, "<{project["requires-python"].removeprefix(">=")}")' in lines
    assert f"  version: {project['version']}" in lines


def _lists(lines, *heads):
    for head in heads:
        first = lines.index(head) + 1
        last = next(n for n, line in enumerate([*lines[first:], ""], start=first) if not line.startswith("    - "))
        yield lines[first:last]


def test_citation_and_changelog_name_the_version(project):
    assert f"version: {project['version']}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    versions = re.findall(r"^## \[(.+?)\]", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert project["version"] == next(version for version in versions if version != "Unreleased")


def test_a_source_distribution_holds_every_folder_that_is_not_for_this_machine_alone(project):
    tool = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"]["targets"]
    for name in ("wirerope_mj", "models", "scenarios", "tests", "benchmarks", "verification", "examples", "docs",
                 "packaging", "paper", "hatch_build.py"):  # fmt: skip
        assert name in tool["sdist"]["include"] or name == "hatch_build.py", name
        assert (ROOT / name).exists(), name


def test_the_paper_is_of_the_length_and_the_parts_that_its_journal_asks_for():
    text = (ROOT / "paper/paper.md").read_text(encoding="utf-8")
    body = text.split("---\n", 2)[2]
    for heading in ("Summary", "Statement of need", "State of the field", "References"):
        assert f"# {heading}\n" in body, heading
    assert 750 <= len(body.split()) <= 1750
    cited = set(re.findall(r"@(\w+)", body))
    listed = set(re.findall(r"^@\w+\{(\w+),", (ROOT / "paper/paper.bib").read_text(encoding="utf-8"), flags=re.MULTILINE))
    assert cited == listed
    for picture in re.findall(r"!\[[^]]*\]\(([^)]+)\)", body):
        assert (ROOT / "paper" / picture).is_file(), picture


def test_workflows_name_actions_by_commit_and_say_the_release():
    workflows = sorted((ROOT / ".github/workflows").glob("*.yml"))
    if not workflows:
        pytest.skip("a source distribution brings no workflows")
    used = [line.strip(" -") for path in workflows for line in path.read_text(encoding="utf-8").splitlines() if "uses:" in line]
    assert used
    assert [line for line in used if not re.fullmatch(r"uses: [\w/.-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", line)] == []
