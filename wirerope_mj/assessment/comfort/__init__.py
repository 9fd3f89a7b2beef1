"""Vibration with regard to people: weighted acceleration and doses of ISO 2631-1, habitability of ships of ISO 6954."""

from wirerope_mj.assessment.comfort.standards import (
    Exposure,
    exposure,
    iso_6954_1984,
    iso_6954_2000,
    iso_6954_2000_of_history,
    velocity_lines,
)
