"""Studies: many variants of one system, on all cores or on a cluster, in one table."""

from wirerope_mj.studies.result import StudyResult
from wirerope_mj.studies.results.effects import SobolIndex, SobolIndices, sobol_indices
from wirerope_mj.studies.search.result import SearchResult
from wirerope_mj.studies.search.search import Search
from wirerope_mj.studies.study import Study, load_study
from wirerope_mj.studies.vary.distributions import Choice, Isotropic, Normal, Specimens, Uniform
from wirerope_mj.studies.vary.sampling import redrawn
