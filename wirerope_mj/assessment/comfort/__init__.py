"""Vibration with regard to people: weighted acceleration and doses of ISO 2631-1, habitability of ships of ISO 6954."""

from wirerope_mj.assessment.comfort.people import Exposure, exposure
from wirerope_mj.assessment.comfort.ship import iso_6954_1984, iso_6954_2000, iso_6954_2000_of_history, velocity_lines
