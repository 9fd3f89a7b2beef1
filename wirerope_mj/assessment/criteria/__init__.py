"""What a response is judged by: each criterion gives a value, its limit, the margin and a verdict."""

from wirerope_mj.assessment.criteria.acceleration import acceleration_verdicts as acceleration_verdicts
from wirerope_mj.assessment.criteria.bottoming import bottoming_verdicts as bottoming_verdicts
from wirerope_mj.assessment.criteria.contact import STOP as STOP
from wirerope_mj.assessment.criteria.contact import closing_words as closing_words
from wirerope_mj.assessment.criteria.contact import contact_verdicts as contact_verdicts
from wirerope_mj.assessment.criteria.judge import judge as judge
from wirerope_mj.assessment.criteria.mount_load import peak_force_verdicts as peak_force_verdicts
from wirerope_mj.assessment.criteria.mount_load import starting_load_verdicts as starting_load_verdicts
from wirerope_mj.assessment.criteria.random import judge_random as judge_random
from wirerope_mj.assessment.criteria.random import random_verdicts as random_verdicts
from wirerope_mj.assessment.criteria.rattle import rattle_verdicts as rattle_verdicts
from wirerope_mj.assessment.criteria.ship import iso_6954_1984 as iso_6954_1984
from wirerope_mj.assessment.criteria.ship import iso_6954_2000 as iso_6954_2000
from wirerope_mj.assessment.criteria.ship import iso_6954_2000_of_history as iso_6954_2000_of_history
from wirerope_mj.assessment.criteria.ship import velocity_lines as velocity_lines
from wirerope_mj.assessment.criteria.srs import spectrum_verdict as spectrum_verdict
from wirerope_mj.assessment.criteria.transmissibility import transmissibility_verdict as transmissibility_verdict
from wirerope_mj.assessment.criteria.travel import travel_verdicts as travel_verdicts
from wirerope_mj.assessment.criteria.verdict import CLEAR as CLEAR
from wirerope_mj.assessment.criteria.verdict import EXCEEDED as EXCEEDED
from wirerope_mj.assessment.criteria.verdict import NOT_JUDGED as NOT_JUDGED
from wirerope_mj.assessment.criteria.verdict import STRUCK as STRUCK
from wirerope_mj.assessment.criteria.verdict import TOUCHING as TOUCHING
from wirerope_mj.assessment.criteria.verdict import WITHIN as WITHIN
from wirerope_mj.assessment.criteria.verdict import Verdict as Verdict
