"""What makes a report a document that is filed and signed: its title block, revisions, and texts at stated places."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path

from wirerope_mj.content.numbers import paragraphs
from wirerope_mj.foundation.tables import Column, Table

# Texts of a document's author, and where they stand
TEXTS = {
    "scope": "below the answer", "assumptions": "with what is assumed", "validation": "with what was validated",
    "conclusion": "after the results",
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Revision:
    """A line of the history of a document."""

    revision: str
    date: str = ""
    author: str = ""
    change: str = ""


@dataclass(frozen=True, kw_only=True)
class Document:
    """Data of a document; what is empty is left open in its title block."""

    # project, number, revision, date: by which it is filed
    project: str = ""
    number: str = ""
    revision: str = ""
    date: str = ""
    # author, checker, approver: who signs
    author: str = ""
    checker: str = ""
    approver: str = ""
    classification: str = ""  # said on every page
    client: str = ""  # for whom it is written
    standard: str = ""  # by which the load cases and limits were chosen
    logo: Path | None = None  # PNG or JPEG file; None for none
    history: tuple[Revision, ...] = ()  # revisions, the first one first
    texts: Mapping[str, str] = field(default_factory=dict)  # paragraphs by the names of `TEXTS`

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        """Name and value of what stands in the title block."""
        named = {
            "Project": self.project, "Document": self.number, "Revision": self.revision, "Date": self.date,
            "Client": self.client, "Classification": self.classification, "Standard": self.standard,
        }  # fmt: skip
        return tuple((name, value) for name, value in named.items() if value)

    @property
    def reference(self) -> str:
        """Number and revision, as every page says them."""
        return " ".join(filter(None, (self.number, self.revision and f"revision {self.revision}")))

    def signatures(self) -> Table:
        """Tabulate who signs, with room for date and signature."""
        people = (("Author", self.author), ("Checked", self.checker), ("Approved", self.approver))
        columns = [Column(one, align="left") for one in ("", "name", "date", "signature")]
        rows = [(role, name, "", "") for role, name in people]
        return Table(id="signatures", title="Signatures", columns=columns, rows=rows)

    def revisions(self) -> Table | None:
        """Tabulate the history; None without one."""
        if not self.history:
            return None
        names = [one.name for one in fields(Revision)]
        columns = [Column(name, align="text" if name == "change" else "left") for name in names]
        rows = [[getattr(one, name) for name in names] for one in self.history]
        return Table(id="revisions", title="Revisions", columns=columns, rows=rows)

    def paragraphs(self, name: str) -> list[str]:
        """Return the paragraphs of one of the `TEXTS`."""
        return paragraphs(self.texts.get(name, ""))
