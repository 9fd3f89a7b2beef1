"""A file with one function that makes a study from options, and the studies that ship with the package."""

from pathlib import Path

from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.resources import scenarios_folder
from wirerope_mj.runs.scenario import OptionFile
from wirerope_mj.studies.search.search import Search
from wirerope_mj.studies.study import Study


class StudyFile(OptionFile):
    """A file with one function `study(*, ...) -> Study`, or `-> Search`, whose keyword arguments are the options."""

    def make(self, **options: object) -> Study | Search:
        """Return the study of some options; the others have their defaults.

        ModelError if an option is unknown, or the function does not return a Study, or fails; says in which line.
        """
        made, _ = self.made(options)
        if not isinstance(made, Study | Search):
            raise ModelError(f"{self.path}: `study` must return a wirerope_mj.Study or a wirerope_mj.Search, got {made!r}.")
        made.name = self.name if made.name == "study" else made.name
        made.question = made.question or (self.function.__doc__ or "").split("\nArgs:")[0].strip()
        return made


def shipped_studies() -> dict[str, Path]:
    """Return the studies that ship with the package, by name."""
    return {path.stem: path for path in sorted((scenarios_folder() / "studies").glob("*.py"))}


def load_study_file(name_or_path: str | Path) -> StudyFile:
    """Return the study file at a path, or the shipped one of that name.

    ModelError if there is no such study, or the file has no function `study` with keyword options only.
    """
    return StudyFile.load(name_or_path, shipped_studies(), "study")
