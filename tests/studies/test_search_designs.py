"""Searches for designs: a front that can be enumerated, the same table whatever computes it, and what must not be."""

import os
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
from small_search import PLACES, beam_search, beam_study, beam_text

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.studies.engines.compute import Chunk, compute
from wirerope_mj.studies.search import search as search_search
from wirerope_mj.studies.search.result import Evolution, feasible, front, nearest, violations

FITTED = [f"mount/{name}/fitted" for name in PLACES]


def design(row):
    return tuple(row[name] for name in FITTED)


def bits(row):
    """A row's numbers with every bit, without its number and generation; NaN is equal to NaN."""
    return {key: repr(value) for key, value in row.items() if key not in ("variant", "generation")}


def content(folder):
    """What a finished folder says, file by file."""
    return {name: (folder / name).read_bytes() for name in ("study.toml", "variants.parquet", "summary.json")}


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    """All 32 designs of the beam, as a study of a grid."""
    return beam_study(sampling="grid").run(tmp_path_factory.mktemp("grid") / "out", workers=1)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """A search left alone, in this process."""
    return beam_search().run(tmp_path_factory.mktemp("search") / "out", workers=1)


def test_the_front_is_the_one_of_all_designs(grid, found):
    rows = front(grid.table, ("acceleration", "travel"), {"travel": 1.0})
    best = {design(row) for row in grid.table.take(rows).to_pylist()}
    assert len(best) == 5  # of the 32; a front of one design or of all would show little
    assert {design(row) for row in found.front.to_pylist()} == best
    # The first of the front has the least acceleration, and every next one more of it and less travel.
    assert (np.diff(np.asarray(found.front["acceleration"])) > 0.0).all()
    assert (np.diff(np.asarray(found.front["travel"])) < 0.0).all()


def test_every_design_has_the_bits_of_the_same_variant_of_a_study(grid, found):
    """Which batch a design is computed in depends on the search; its row does not.

    Designs that have no rest say by how much in their message, which the numerics of the last trial decide: only that they
    failed is compared.
    """
    alone = {design(row): row for row in grid.table.to_pylist()}
    rows = found.table.to_pylist()
    assert len({design(row) for row in rows}) == len(rows)  # no design is computed twice
    for row in rows:
        other = alone[design(row)]
        assert row["status"] == other["status"]
        if row["status"] == "done":
            assert bits(row) == bits(other)


def test_a_design_simulated_alone_has_the_peaks_of_the_table(found):
    variant = found.chosen[0]
    row = found.table.slice(variant, 1).to_pylist()[0]
    response = found.response(variant)
    assert response.peaks.bodies["beam"].acceleration.value == row["acceleration"]


def test_designs_without_rest_are_infeasible_and_not_fatal(found):
    assert found.failed
    assert all("no equilibrium" in message for message in found.failed.values())
    assert not found.feasible[list(found.failed)].any()
    assert "failed" in found.message


def test_the_number_of_mounts_can_be_minimised(grid, tmp_path):
    found = beam_search(minimise=("mounts", "travel"), generations=7).run(tmp_path / "out", workers=1)
    rows = front(grid.table, ("mounts", "travel"), {"travel": 1.0})
    best = [(row["mounts"], row["travel"]) for row in grid.table.take(rows).to_pylist()]
    assert [(row["mounts"], row["travel"]) for row in found.front.to_pylist()] == best
    assert best[0][0] == 3.0  # two mounts travel too far wherever they stand
    assert len(best) == 2  # a fifth mount, far from the load, is no gain: four at the right places travel less


@pytest.mark.slow
def test_the_same_search_gives_the_same_bytes_with_other_workers(found, tmp_path):
    beam_search().run(tmp_path / "out", workers=2)
    assert content(tmp_path / "out") == content(found.folder)


def test_another_seed_is_another_search(found, tmp_path):
    other = beam_search(generations=2)
    other.study.seed = 4
    table = other.run(tmp_path / "out", workers=1).table
    assert table.num_rows > len(other.first)
    assert list(map(design, table.to_pylist())) != list(map(design, found.table.to_pylist()))[: table.num_rows]


def test_a_search_that_was_stopped_again_and_again_ends_with_the_same_bytes(found, tmp_path, monkeypatch):
    write, left = search_search.write_part, [0]

    def stopped(folder, part):
        if left[0] == 0:
            raise KeyboardInterrupt
        left[0] -= 1
        write(folder, part)

    monkeypatch.setattr(search_search, "write_part", stopped)
    for parts in (1, 3, 9, 12):  # in the first generation, at its end, and later
        left[0] = parts
        with pytest.raises(KeyboardInterrupt):
            beam_search().run(tmp_path / "out", workers=1, resume=True)
        begun = wr.load_study(tmp_path / "out")
        assert not begun.complete
        assert "--resume" in begun.message
    monkeypatch.undo()
    beam_search().run(tmp_path / "out", workers=1, resume=True)
    assert content(tmp_path / "out") == content(found.folder)


@pytest.mark.slow
def test_a_search_that_was_killed_ends_with_the_same_bytes(found, tmp_path):
    code = (
        "import os, signal, sys\n"
        "from small_search import beam_search\n"
        "from wirerope_mj.studies.search import search as search_search\n"
        "write, count = search_search.write_part, [0]\n"
        "def deadly(folder, part):\n"
        "    write(folder, part)\n"
        "    count[0] += 1\n"
        "    if count[0] == 7: os.kill(os.getpid(), signal.SIGKILL)\n"
        "search_search.write_part = deadly\n"
        "beam_search().run(sys.argv[1], workers=1)\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path])}
    killed = subprocess.run([sys.executable, "-c", code, str(tmp_path / "out")], env=environment, check=False)
    assert killed.returncode == -9
    beam_search().run(tmp_path / "out", workers=1, resume=True)
    assert content(tmp_path / "out") == content(found.folder)


def test_parts_of_other_designs_are_not_believed(found, tmp_path, monkeypatch):
    """As after a process's death, whose chunk fails at first and later does not: what follows may be other designs."""
    write = search_search.finish
    monkeypatch.setattr(search_search, "finish", lambda *_: None)
    beam_search().run(tmp_path / "out", workers=1)
    monkeypatch.setattr(search_search, "finish", write)
    parts = sorted((tmp_path / "out" / "parts").glob("*.parquet"))
    parts[-1].write_bytes(parts[0].read_bytes())
    beam_search().run(tmp_path / "out", workers=1, resume=True)
    assert content(tmp_path / "out") == content(found.folder)


@pytest.mark.slow
def test_dask_gives_the_same_rows(found, tmp_path):
    pytest.importorskip("distributed")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # sockets that Dask leaves to the collector
        other = beam_search(generations=1).run(tmp_path / "out", engine="dask", workers=1)
    first = found.table.slice(0, other.table.num_rows)
    assert [bits(row) for row in other.table.to_pylist()] == [bits(row) for row in first.to_pylist()]


def test_the_result_is_made_again_from_its_folder(found):
    again = wr.load_study(found.folder)
    assert isinstance(again, wr.SearchResult)
    assert list(map(bits, again.front.to_pylist())) == list(map(bits, found.front.to_pylist()))
    assert again.study.row(found.chosen[0]) == found.study.row(found.chosen[0])
    assert again.message == found.message
    assert (again.minimise, again.limits, again.start) == (("acceleration", "travel"), {"travel": 1.0}, 1)


@pytest.mark.quick
def test_a_place_that_is_not_fitted_is_as_if_the_model_had_no_mount_there(tmp_path):
    """What stands for no mount has 1e-12 N/m beside some 1e4 N/m: rounding is left, and where the search for rest ends."""
    vary = {"mount/m2,m4/fitted": wr.Choice(False), "motion/level": wr.Uniform(0.9, 1.1)}
    left_out = beam_study(vary=vary, variants=4, sampling="sobol").run(tmp_path / "a", workers=1).table
    text = beam_text({name: x for name, x in PLACES.items() if name not in ("m2", "m4")})
    study = beam_study(text=text, vary={"motion/level": vary["motion/level"]}, variants=4, sampling="random")
    rows = left_out.select(["variant", "motion/level"]).to_pylist()
    absent = compute(study.work, Chunk(number=0, rows=rows)).table
    for name in ("acceleration", "travel", "travel/m1", "force/m5", "displacement/end"):
        np.testing.assert_allclose(np.asarray(left_out[name]), np.asarray(absent[name]), rtol=1e-9)
    assert left_out["mounts"].to_pylist() == [3.0] * 4
    assert absent["mounts"].to_pylist() == [3.0] * 4
    assert np.isnan(np.asarray(left_out["travel/m2"])).all()  # nothing is there that could travel too far


@pytest.mark.quick
def test_failed_mounts_do_not_count_and_are_judged_still(tmp_path):
    study = beam_study(vary={"mount/*/failed": wr.Choice("", "m3")}, sampling="grid")
    table = study.run(tmp_path / "out", workers=1).table
    assert table["mounts"].to_pylist() == [5.0, 4.0]
    assert np.isfinite(np.asarray(table["travel/m3"])).all()


def test_mounts_that_are_joined_move_together_and_mirrored():
    study = beam_study(vary={"mount/m1,m2,-m4,-m5/position_shift/x": wr.Uniform(0.04, 0.06)}, variants=1)
    shift = study.row(0)["mount/m1,m2,-m4,-m5/position_shift/x"]
    assert 0.04 <= shift <= 0.06
    for name, way in {"m1": 1.0, "m2": 1.0, "m3": 0.0, "m4": -1.0, "m5": -1.0}.items():
        # Places are of the order of 1 m: their sums are right to a few units in the last place.
        assert study.system(0).mounts[name].position[0] == pytest.approx(PLACES[name] + way * shift, abs=1e-15)


def test_a_mount_cannot_move_both_ways_and_must_exist():
    with pytest.raises(ValueError, match="'m2' cannot move both ways"):
        beam_study(vary={"mount/m1,m2,-m2/position_shift/x": wr.Uniform(0.0, 0.1)}, variants=1)
    with pytest.raises(ModelError, match=r"no mount 'm9'. There is: m1, m2"):
        beam_study(vary={"mount/m1,-m9/position_shift/x": wr.Uniform(0.0, 0.1)}, variants=1)
    with pytest.raises(ValueError, match="must be a Choice of True and False"):
        beam_study(vary={"mount/m1/fitted": wr.Uniform(0.0, 1.0)}, variants=1)


def test_where_nothing_keeps_the_limits_the_nearest_is_named(tmp_path):
    found = beam_search(generations=2, travel=0.001).run(tmp_path / "out", workers=1)
    assert found.front.num_rows == 0
    travel = np.where(np.asarray(found.table["status"]) == "done", np.asarray(found.table["travel"]), np.inf)
    best = int(np.argmin(travel))
    words = "largest utilisation of a rated travel along one axis"
    assert f"The nearest is design {best}: {words} is {100.0 * travel[best]:.4g} %" in found.message
    assert "above its limit of 100 %" in found.message
    assert found.knee is None
    assert found.chosen == np.argsort(travel, kind="stable")[: np.isfinite(travel).sum()].tolist()  # the nearest first


@pytest.mark.quick
def test_where_nothing_is_judged_the_message_says_so(tmp_path):
    found = beam_search(generations=1, minimise="acceleration", limits={"fragility": 1.0}).run(tmp_path / "o", workers=1)
    assert "fragility" in str(found.limits)
    assert "None has values of all that is minimised or limited" in found.message


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"minimise": ("weight",)}, "`minimise`: there is no measure 'weight'; there are acceleration, travel"),
        ({"minimise": ()}, "`minimise` must name at least one measure"),
        ({"minimise": ("travel", "travel")}, "names a measure twice"),
        ({"limits": {"stress": 1.0}}, "`limits`: there is no measure 'stress'; there are acceleration"),
        ({"limits": {"travel": float("nan")}}, "must be a finite number"),
        ({"generations": 0}, "`generations` must be an integer >= 1, got 0"),
        ({"variants": 0}, "`variants` must be an integer >= 1, got 0"),
        ({"variants": 2}, "it must have at least 4"),
        ({"vary": {"mount/*/fitted": wr.Choice(True), "motion/level": wr.Normal(1.0, 0.1)}}, "a search chooses among"),
    ],
)
def test_what_cannot_be_is_said_before_anything_is_computed(given, message):
    with pytest.raises(ValueError, match=message):
        beam_search(**given)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({"mount/m1/fitted": True}, r"`start\[0\]` must say 'mount/m2/fitted', too"),
        ({"mount/*/fitted": 1}, r"must be one of \[False, True\], got 1"),
        ({"mount/*/fitted": True, "body/beam/mass": 1.0}, "nothing called 'body/beam/mass' varies"),
    ],
)
def test_a_given_design_must_be_one_that_may_be_chosen(start, message):
    with pytest.raises(ValueError, match=message):
        wr.Search(beam_study(variants=8), minimise="acceleration", start=[start])


def test_without_the_optimiser_one_message_says_how_to_install_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pymoo", None)
    with pytest.raises(ValueError, match=r"a search needs pymoo: pip install 'wirerope-mj\[optimise\]'"):
        beam_search().run(tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_folder_of_another_search_is_not_touched(found, tmp_path):
    before = content(found.folder)
    with pytest.raises(RecordError, match="there is a study already"):
        beam_search().run(found.folder)
    with pytest.raises(RecordError, match="search.generations"):
        beam_search(generations=9).run(found.folder, resume=True)
    assert content(found.folder) == before


def table_of(**columns):
    size = len(next(iter(columns.values())))
    return pa.table({"variant": range(size), "status": ["done"] * size, **columns})


def test_the_front_leaves_out_what_is_beaten_equalled_or_beyond_a_limit():
    table = table_of(a=[3.0, 1.0, 2.0, 2.0, 2.0, 0.0, 5.0], b=[1.0, 4.0, 2.0, 2.0, 3.0, 9.0, 0.5])
    assert front(table, ("a", "b"), {"b": 4.0}) == [1, 2, 0, 6]
    assert feasible(table, ("a", "b"), {"b": 4.0}).tolist() == [True] * 5 + [False, True]
    assert front(table, ("a",), {}) == [5]
    np.testing.assert_array_equal(violations(table, {"b": 4.0})[:2, 0], [-0.75, 0.0])
    assert nearest(table, ("a", "b"), {"b": 0.25}) == (6, "b", 1.0)


def test_what_failed_or_is_not_judged_is_on_no_front():
    table = table_of(a=[0.0, 1.0, 2.0], b=[1.0, float("nan"), 1.0])
    table = table.set_column(1, "status", pa.array(["failed", "done", "done"]))
    assert front(table, ("a",), {"b": 2.0}) == [2]
    assert front(table, ("a", "b"), {}) == [2]


@pytest.mark.quick
def test_the_optimiser_finds_a_known_front_in_numbers_choices_and_truth_values():
    """Schaffer's problem x^2, (x - 2)^2, of which a limit leaves x >= 0.5; a word and a boolean can only spoil it.

    So the front is x from 0.5 to 2 with the right word and boolean.
    """
    choices = {"x": wr.Uniform(-10.0, 10.0), "word": wr.Choice("a", "b", "c"), "flag": wr.Choice(True, False)}
    generator = np.random.default_rng(1)
    first = [
        {"x": float(x), "word": str(generator.choice(["a", "b", "c"])), "flag": bool(generator.integers(2))}
        for x in generator.uniform(-10.0, 10.0, 24)
    ]
    evolution, told = Evolution(choices, first, n_objectives=2, n_limits=1, seed=5), []
    for _ in range(30):
        designs = evolution.ask()
        assert {(type(one["x"]), type(one["word"]), type(one["flag"])) for one in designs} == {(float, str, bool)}
        x = np.array([one["x"] for one in designs])
        spoiled = np.array([10.0 * (one["word"] != "b") + 10.0 * one["flag"] for one in designs])
        aims = np.stack([x**2 + spoiled, (x - 2.0) ** 2 + spoiled], axis=1)
        evolution.tell(aims, (0.5 - x)[:, None])
        told += [{**one, "a": float(a), "b": float(b)} for one, (a, b) in zip(designs, aims, strict=True)]
    table = table_of(**{name: [one[name] for one in told] for name in ("x", "word", "flag", "a", "b")})
    kept = table.filter(pc.greater_equal(table["x"], 0.5))
    best = kept.take(front(kept, ("a", "b"), {})).to_pylist()
    assert {(one["word"], one["flag"]) for one in best} == {("b", False)}
    assert len(best) >= 24  # a whole generation
    found = [one["x"] for one in best]
    assert min(found) < 0.55  # the ends of the front are found to a thirtieth of its length
    assert 1.95 < max(found) <= 2.05  # beyond 2 both grow; a little beyond nothing better may have been tried
