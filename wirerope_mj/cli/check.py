"""`wirerope check`: what is wrong or implausible in files, before anything is computed."""

from pathlib import Path

IMPLAUSIBLE, REFUSED = 1, 2  # Exit codes: commands take the files and warn; they refuse one


def check(*files: Path, json: Path | None = None) -> int:
    """Say what is wrong or implausible in files and folders, all of it at once, by file, line and element.

    Models, tables of models, isolators, records, cyclic tests, densities and spectra, levels, jobs, studies, scenarios, service
    lives, runs: each is read as the commands read it. "refused" is what they refuse, "implausible" what they warn of. Exits 0
    where there is nothing, 1 where something is implausible, 2 where something is refused.

    wirerope check genset job.toml records/*.csv

    Args:
        files: files, folders with such files in them, or names of shipped models. Python files are executed.
        json: file for the same findings.
    """
    from collections import Counter

    from rich.text import Text

    from wirerope_mj.foundation.atomic_files import check_writable, write_json
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.runs.check import Finding, checked_files
    from wirerope_mj.views.terminal import print_lines

    if not files:
        raise ValueError("name the files: wirerope check genset job.toml records/*.csv")
    if json is not None:
        check_writable(json)
    kinds: Counter[str] = Counter()
    findings: list[Finding] = []
    for checked in checked_files(files):
        kinds[checked.kind or "unreadable"] += 1
        new = [finding for finding in checked.findings if finding not in findings]
        for one in new:
            word, style = ("refused", "red") if one.refused else ("implausible", "yellow")
            print_lines([Text(plain(f"{word}: {one}"), style=style)], indent="")
        findings += new
    refused = sum(finding.refused for finding in findings)
    counted = ", ".join(f"{kind} {count}" for kind, count in kinds.items())
    print_lines([f"{refused} refused, {len(findings) - refused} implausible; checked: {counted or 'nothing'}"], indent="")
    if json is not None:
        write_json(json, {"refused": refused, "implausible": len(findings) - refused, "findings": [vars(f) for f in findings]})
    return REFUSED if refused else IMPLAUSIBLE if findings else 0
