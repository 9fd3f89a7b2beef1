"""Time that the process that asks for a study spends itself: drawing and checking variants, and the parts of its table.

    python benchmarks/study_asking.py                  # 100 000 variants drawn and checked; 1000 parts of 32 written and joined
    python benchmarks/study_asking.py --parts 200
    python benchmarks/study_asking.py --memory 1000000  # most memory of `wirerope study` with so many variants

All of it is done by one process, whatever computes the variants: it is what workers wait for when there are many. The floor of
`benchmarks/study.py` and the shipped `floor_tolerances`; of each, one part is computed, and written under many numbers.
"""

import argparse
import pickle
import resource
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import pyarrow as pa
from study import floor_study

import wirerope_mj as wr
from wirerope_mj.cli.study import compute_and_print
from wirerope_mj.runs.study import load_study_file
from wirerope_mj.studies import study as computing
from wirerope_mj.studies.engines.compute import Chunk, Part, compute
from wirerope_mj.studies.folder import finish, prepare, write_part
from wirerope_mj.studies.inputs_file import PEAKS
from wirerope_mj.studies.results.varied import summary
from wirerope_mj.studies.study import CHUNK, chunks, load_study
from wirerope_mj.studies.vary.variants import Work


def seconds(work: Callable[[], object]) -> float:
    began = time.process_time()
    work()
    return time.process_time() - began


def asking(name: str, make: Callable[[int], wr.Study], variants: int, parts: int) -> None:
    """Print what one study costs the process that asks for it."""
    drawn: list[wr.Study] = []
    draw = seconds(lambda: drawn.append(make(variants)))
    check = seconds(drawn[0].table)
    study = make(CHUNK * parts)
    whole, pickled = list(chunks(study, range(parts))), pickle.HIGHEST_PROTOCOL
    cut = seconds(lambda: [pickle.dumps(one, protocol=pickled) for one in chunks(study, range(parts))])
    part = compute(study.work, whole[0])
    answer = pickle.dumps(part, protocol=pickled)
    unpack = seconds(lambda: [pickle.loads(answer) for _ in range(parts)])
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "study"
        prepare(study, folder, keep=PEAKS, resume=False, force=False)
        write = seconds(lambda: [write_part(folder, replace(part, number=number)) for number in range(parts)])
        disk = sum(path.stat().st_size for path in (folder / "parts").iterdir()) / parts
        join = seconds(lambda: finish(folder, parts, lambda: summary(load_study(folder))))
    print(f"{name}")
    print(f"  of a variant: drawn {1e6 * draw / variants:.1f} us, checked {1e6 * check / variants:.1f} us")
    print(
        f"  of a chunk of {CHUNK}: cut and pickled {1e3 * cut / parts:.2f} ms, unpacked {1e3 * unpack / parts:.2f} ms, "
        f"written {1e3 * write / parts:.2f} ms, joined {1e3 * join / parts:.2f} ms"
    )
    print(
        f"  handed over {len(pickle.dumps(whole[0], protocol=pickled)) / 1e3:.1f} kB, back {len(answer) / 1e3:.1f} kB, part "
        f"{disk / 1e3:.1f} kB; shared by all {len(pickle.dumps(study.work, protocol=pickled)) / 1e3:.0f} kB"
    )


def memory(variants: int) -> None:
    """Print the most memory of the command, from drawing to the last picture; every chunk has the measures of the first."""

    def repeated(work: Work, chunks: Iterable[Chunk], **_: object) -> Iterator[Part]:
        first = None
        for chunk in chunks:
            first = first or compute(work, chunk).table
            table = first.slice(0, len(chunk.rows))
            for place, name in enumerate(["variant", *(column.name for column in work.columns)]):
                kind = table.schema.field(place)
                table = table.set_column(place, kind, pa.array([row[name] for row in chunk.rows], kind.type))
            yield Part(number=chunk.number, table=table)

    computing.run_local = repeated  # type: ignore[assignment]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "study"
        compute_and_print(lambda: floor_study(variants), "floor", resume=False, out=folder, by=None, open_worst=0)
    print(f"{variants} variants: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--variants", type=int, default=100_000)
    parser.add_argument("--parts", type=int, default=1000)
    parser.add_argument("--memory", type=int, help="variants")
    arguments = parser.parse_args()
    if arguments.memory:
        memory(arguments.memory)
        return
    tolerances = load_study_file("floor_tolerances").make
    studies: dict[str, Callable[[int], wr.Study]] = {
        "floor of the benchmarks, 8 mounts": floor_study,
        "floor_tolerances, 24 mounts": lambda number: tolerances(variants=number),  # type: ignore[dict-item, return-value]
    }
    for name, make in studies.items():
        asking(name, make, arguments.variants, arguments.parts)


if __name__ == "__main__":
    main()
