"""A run against measurements: the same channels on one clock, and how well they agree."""

from wirerope_mj.assessment.correlation.correlate import ChannelCorrelation, Correlation, correlate
from wirerope_mj.assessment.correlation.iso18571 import Rating, iso_rating
from wirerope_mj.assessment.correlation.magnitude_phase import MagnitudePhase, russell, sprague_geers
