"""A response in the words and figures of its verdicts: peaks beside ratings, sentences, and plain values for a file."""

from wirerope_mj.assessment.verdicts.headline import headline as headline
from wirerope_mj.assessment.verdicts.peaks import BodyPeak as BodyPeak
from wirerope_mj.assessment.verdicts.peaks import MountPeak as MountPeak
from wirerope_mj.assessment.verdicts.peaks import body_peaks as body_peaks
from wirerope_mj.assessment.verdicts.peaks import mount_peaks as mount_peaks
from wirerope_mj.assessment.verdicts.sentences import contact_lines as contact_lines
from wirerope_mj.assessment.verdicts.sentences import verdict_lines as verdict_lines
from wirerope_mj.assessment.verdicts.summary import summary as summary
