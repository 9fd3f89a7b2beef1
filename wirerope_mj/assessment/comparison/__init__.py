"""Two or more runs against the first of them: what they share by name, and where, when and by how much they differ."""

from wirerope_mj.assessment.comparison.compared import BASE as BASE
from wirerope_mj.assessment.comparison.compared import ComparedRun as ComparedRun
from wirerope_mj.assessment.comparison.compared import Component as Component
from wirerope_mj.assessment.comparison.compared import HistoryDifference as HistoryDifference
from wirerope_mj.assessment.comparison.compared import difference as difference
from wirerope_mj.assessment.comparison.compared import identical as identical
from wirerope_mj.assessment.comparison.runs import Align as Align
from wirerope_mj.assessment.comparison.runs import Comparison as Comparison
from wirerope_mj.assessment.comparison.runs import PeakRow as PeakRow
from wirerope_mj.assessment.comparison.runs import acceleration_rows as acceleration_rows
from wirerope_mj.assessment.comparison.runs import combined_rows as combined_rows
from wirerope_mj.assessment.comparison.runs import compare_runs as compare_runs
from wirerope_mj.assessment.comparison.runs import largest_of as largest_of
from wirerope_mj.assessment.comparison.runs import mount_rows as mount_rows
from wirerope_mj.assessment.comparison.runs import travel_rows as travel_rows
