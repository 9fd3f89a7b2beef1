"""What a response is judged by: each criterion gives a value, its limit, the margin and a verdict."""

from wirerope_mj.criteria.verdict import EXCEEDED as EXCEEDED
from wirerope_mj.criteria.verdict import NOT_JUDGED as NOT_JUDGED
from wirerope_mj.criteria.verdict import WITHIN as WITHIN
from wirerope_mj.criteria.verdict import Verdict as Verdict
