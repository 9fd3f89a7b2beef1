"""Measured records as base motions: files, channels, sampling, baseline, and checks of what was recorded."""
