"""Options that are mistyped, or cannot go together, are named with what is known before anything is searched for."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.mounts.identification import compare_laws, compare_methods, identify_specimens
from wirerope_mj.mounts.test_rig import cyclic_test, measured

pytestmark = pytest.mark.quick

LAW = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.0, k=5e4)
LOOPS = measured(cyclic_test(LAW, [1e-3, 4e-3]), points_per_cycle=40, seed=1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "3stage"}, "`method` must be one of 'three-stage', 'time', 'frequency', got '3stage'"),
        ({"data": "skelton"}, "`data` must be one of 'loops', 'skeleton', got 'skelton'"),
        ({"constraint": "beta>gama"}, "`constraint` must be one of 'beta>gamma', .*, got 'beta>gama'"),
        ({"weights": "eq"}, "`weights` must be one of 'range', 'equal', got 'eq'"),
        ({"noise": -1}, "`noise` must be > 0, got -1"),
        ({"noise": 0}, "`noise` must be > 0, got 0"),
        ({"noise": "1"}, "`noise` must be a finite number, got '1'"),
        ({"noise": np.nan}, "`noise` must be a finite number, got nan"),
        ({"grid": False}, "`grid` is False and there is no `start`"),
        ({"method": "frequency"}, "`method='frequency'` needs a law to `start` at"),
        ({"method": "frequency", "start": LAW, "data": "skeleton"}, "`method='frequency'` needs .*`data='loops'`"),
        ({"fixed": {"n": "1"}}, r"`fixed\['n'\]` must be a finite number, got '1'"),
        ({"fixed": {"n": np.inf}}, r"`fixed\['n'\]` must be a finite number, got inf"),
        ({"fixed": "n"}, "`fixed` must be a mapping of names to values, got 'n'"),
        ({"law": "bouc-wen"}, "`law` must be a class of laws such as BoucWen, got 'bouc-wen'"),
        ({"extra_residuals": len}, "`extra_residuals` must be a sequence of functions of a law"),
        (
            {"extra_residuals": [lambda law: [0.0], lambda law: [np.nan]]},
            r"`extra_residuals\[1\]` gives numbers that are not",
        ),
    ],
)
def test_unknown_options_are_named_with_the_known_ones(options, message):
    with pytest.raises(ValueError, match=message):
        wr.identify(LOOPS, **{"law": wr.BoucWen, **options})


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: wr.identify("t.csv"),
            r"`loops` must be loops, got the path 't.csv'; load_cycles\('t.csv'\) reads them",
        ),
        (lambda: wr.identify(LOOPS[0]), "`loops` must be a sequence of loops, got a single one"),
        (lambda: wr.identify([LOOPS]), "`loops` must hold loops, got a list at index 0"),
        (lambda: wr.identify([]), "`loops` must hold at least one closed loop"),
        (
            lambda: compare_laws(LOOPS, laws=["bouc-wen"]),
            r"`laws\[0\]` must be a class of laws such as BoucWen, got 'bouc",
        ),
        (lambda: compare_laws(LOOPS, laws=wr.BoucWen), "`laws` must name at least one law, as a sequence of classes"),
        (lambda: compare_laws(LOOPS[0]), "`loops` must be a sequence of loops, got a single one"),
        (lambda: compare_methods(LOOPS, starts=[LAW]), "`starts` must hold at least one law by a name"),
        (lambda: compare_methods(LOOPS, starts={"a": wr.BoucWen}), "`starts` must hold at least one law by a name"),
        (lambda: identify_specimens(LOOPS), r"`specimens` must be a sequence of loops for each specimen, got loops"),
        (lambda: identify_specimens([LOOPS, "t.csv"]), r"`specimens\[1\]` must be loops, got the path"),
        (
            lambda: identify_specimens([LOOPS, LOOPS], shared="n"),
            "`shared` must be a sequence of names, got the string 'n'",
        ),
        (lambda: identify_specimens([LOOPS, LOOPS], law=wr.BoucWen), "`specimens` do not differ.*given several times"),
    ],
)
def test_what_is_no_set_of_loops_or_laws_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
