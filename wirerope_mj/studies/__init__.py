"""Studies: many variants of one system, on all cores or on a cluster, in one table."""

from wirerope_mj.studies.inputs.distributions import Choice as Choice
from wirerope_mj.studies.inputs.distributions import Isotropic as Isotropic
from wirerope_mj.studies.inputs.distributions import Normal as Normal
from wirerope_mj.studies.inputs.distributions import Specimens as Specimens
from wirerope_mj.studies.inputs.distributions import Uniform as Uniform
from wirerope_mj.studies.inputs.specimens import redrawn as redrawn
from wirerope_mj.studies.result import StudyResult as StudyResult
from wirerope_mj.studies.results.indices import SobolIndex as SobolIndex
from wirerope_mj.studies.results.indices import SobolIndices as SobolIndices
from wirerope_mj.studies.results.indices import sobol_indices as sobol_indices
from wirerope_mj.studies.search.result import SearchResult as SearchResult
from wirerope_mj.studies.search.search import Search as Search
from wirerope_mj.studies.study import Study as Study
from wirerope_mj.studies.study import load_study as load_study
