"""Studies: many variants of one system, on all cores or on a cluster, in one table."""

from wirerope_mj.study.answers.indices import SobolIndex as SobolIndex
from wirerope_mj.study.answers.indices import SobolIndices as SobolIndices
from wirerope_mj.study.answers.indices import sobol_indices as sobol_indices
from wirerope_mj.study.from_scenario import study_of as study_of
from wirerope_mj.study.inputs.distributions import Choice as Choice
from wirerope_mj.study.inputs.distributions import Isotropic as Isotropic
from wirerope_mj.study.inputs.distributions import Normal as Normal
from wirerope_mj.study.inputs.distributions import Specimens as Specimens
from wirerope_mj.study.inputs.distributions import Uniform as Uniform
from wirerope_mj.study.inputs.specimens import redrawn as redrawn
from wirerope_mj.study.result import StudyResult as StudyResult
from wirerope_mj.study.result import load_study as load_study
from wirerope_mj.study.search.result import SearchResult as SearchResult
from wirerope_mj.study.search.search import Search as Search
from wirerope_mj.study.study import Study as Study
