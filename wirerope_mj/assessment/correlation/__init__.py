"""A run against measurements: the same channels on one clock, and how well they agree."""

from wirerope_mj.assessment.correlation.correlate import ChannelCorrelation as ChannelCorrelation
from wirerope_mj.assessment.correlation.correlate import Correlation as Correlation
from wirerope_mj.assessment.correlation.correlate import correlate as correlate
from wirerope_mj.assessment.correlation.iso18571 import Rating as Rating
from wirerope_mj.assessment.correlation.iso18571 import iso_rating as iso_rating
from wirerope_mj.assessment.correlation.magnitude_phase import MagnitudePhase as MagnitudePhase
from wirerope_mj.assessment.correlation.magnitude_phase import russell as russell
from wirerope_mj.assessment.correlation.magnitude_phase import sprague_geers as sprague_geers
