"""What varies in a study, as `--vary` says it, with the number of variants and the sampling."""

import numpy as np
from campaign import Case
from hostile import pick
from words import NUMBERS, ignored, muddled

import wirerope_mj as wr
from wirerope_mj.studies.vary.distributions import distribution_to_dict
from wirerope_mj.studies.vary.vary_option import read_vary

EXAMPLES = (
    "mount/m*/axial/alpha = Normal( 1 , 0.1 , relative, each)",
    "body/block/mass = Uniform( 0.8 , 1.2 , relative)",
    "motion/level = Uniform( 0.5 , 1.5 )",
    "motion/level = Choice( 1 , 2 , 3 )",
    "body/block/mass = Choice( 0.9 , 1.1 , relative)",
    "motion/level = Normal( 1 , 0.2 , low= 0.5 , high= 2 )",
    "motion/level = Uniform( 0.5 , 1.5 , points= 3 )",
    "body/block/mass = Normal( 1 , 0.05 , relative, group=ropes)",
    "motion/azimuth = Uniform( 0 , 90 )",
    "motion/elevation = Isotropic( -90 , 90 )",
)
COUNTS = (1, 3, 8, 16, 0, -1, 10**9, 10**12, 10**400, 2.0, True, None, "8", float("nan"))
SAMPLINGS = ("sobol", "latin-hypercube", "random", "grid", "list", "sobol-indices", "", None)
_PULSE = wr.HalfSine(peak=10.0, duration=0.01, direction="x")


def mutate(rng: np.random.Generator, folder) -> Case:
    """Muddle distributions, numbers of variants, samplings and seeds."""
    texts = [muddled(rng, pick(rng, EXAMPLES)) for _ in range(int(rng.integers(1, 3)))]
    if rng.random() < 0.3:  # values behind the right words
        texts = [pick(rng, EXAMPLES)]
        words = texts[0].split(" ")
        places = [i for i, word in enumerate(words) if word[:1].isdigit()]
        for _ in range(int(rng.integers(1, 3))):
            words[pick(rng, places)] = pick(rng, NUMBERS)
        texts = [" ".join(words)]
    arguments = {"variants": 8, "sampling": "sobol", "seed": 1}
    if rng.random() < 0.3:
        arguments["variants"] = pick(rng, COUNTS)
    if rng.random() < 0.3:
        arguments["sampling"] = pick(rng, SAMPLINGS)
        arguments["variants"] = pick(rng, (*COUNTS[:4], None, 24, 32))
    if rng.random() < 0.1:
        arguments["seed"] = pick(rng, COUNTS)
    return Case(f"{texts!r:.150} {arguments!r:.80}", {"texts": texts, "arguments": arguments})


def use(case: Case) -> str | None:
    """Make the study and the inputs of its variants."""
    texts, arguments = case.inputs["texts"], case.inputs["arguments"]
    vary = read_vary(texts)
    study = wr.Study(model="shock_table", motion=_PULSE, duration=0.01, timestep=1e-3, vary=vary, **arguments)
    table = study.table()
    for name in table.column_names:
        column = table[name].to_numpy()
        if column.dtype.kind == "f" and not np.isfinite(column).all():
            return f"{name} is not finite"
    study.system(0), study.motion(0)
    for text in texts:
        complaint = ignored(text, lambda other: [(k, distribution_to_dict(v)) for k, v in read_vary([other]).items()])
        if complaint:
            return complaint
    return None
