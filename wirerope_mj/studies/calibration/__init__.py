"""Systems brought to measured tests, with the uncertainty that is left."""

from wirerope_mj.studies.calibration.calibrate import Calibrated, Calibration, calibrate, calibrate_model
from wirerope_mj.studies.calibration.fit import Prior
from wirerope_mj.studies.calibration.measured_test import MeasuredTest
from wirerope_mj.studies.calibration.noise import Series
from wirerope_mj.studies.calibration.predict import Prediction, predict
from wirerope_mj.studies.calibration.rig_tests import FrequencyTest, LoopTest
