"""Vibration with regard to people: weighted acceleration and doses of ISO 2631-1, habitability of ships of ISO 6954."""

from wirerope_mj.assessment.comfort.people import Exposure as Exposure
from wirerope_mj.assessment.comfort.people import exposure as exposure
from wirerope_mj.assessment.comfort.ship import iso_6954_1984 as iso_6954_1984
from wirerope_mj.assessment.comfort.ship import iso_6954_2000 as iso_6954_2000
from wirerope_mj.assessment.comfort.ship import iso_6954_2000_of_history as iso_6954_2000_of_history
from wirerope_mj.assessment.comfort.ship import velocity_lines as velocity_lines
