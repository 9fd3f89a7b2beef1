"""A run against measurements: the same channels on one clock, and how well they agree."""

from wirerope_mj.assessment.correlation.correlate import ChannelCorrelation, Correlation, correlate
from wirerope_mj.assessment.correlation.ratings import MagnitudePhase, Rating, iso_rating, russell, sprague_geers
