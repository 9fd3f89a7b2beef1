"""The notebooks in docs/notebooks run from top to bottom, and their cells print little."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

BOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))


@pytest.mark.slow
@pytest.mark.parametrize("path", BOOKS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_notebook_runs_and_every_cell_prints_at_most_two_kilobytes(path, tmp_path):
    book = nbformat.read(path, as_version=4)
    NotebookClient(book, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    for cell in book.cells:
        texts = [
            "".join(output.get("text", "") or output.get("data", {}).get("text/plain", ""))
            for output in cell.get("outputs", [])
        ]
        assert sum(map(len, texts)) <= 2000, cell.source
    assert sum(bool(cell.get("outputs")) for cell in book.cells) >= 4


def test_notebooks_are_kept_without_outputs():
    assert len(BOOKS) == 3
    for path in BOOKS:
        book = nbformat.read(path, as_version=4)
        assert not any(cell.get("outputs") for cell in book.cells)
