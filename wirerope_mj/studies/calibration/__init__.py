"""Systems brought to measured tests, with the uncertainty that is left."""

from wirerope_mj.studies.calibration.calibrate import calibrate as calibrate
from wirerope_mj.studies.calibration.calibrate import calibrate_model as calibrate_model
from wirerope_mj.studies.calibration.frequency_test import FrequencyTest as FrequencyTest
from wirerope_mj.studies.calibration.loop_test import LoopTest as LoopTest
from wirerope_mj.studies.calibration.measured_test import MeasuredTest as MeasuredTest
from wirerope_mj.studies.calibration.noise import Series as Series
from wirerope_mj.studies.calibration.predict import Prediction as Prediction
from wirerope_mj.studies.calibration.predict import predict as predict
from wirerope_mj.studies.calibration.prior import Prior as Prior
from wirerope_mj.studies.calibration.result import Calibrated as Calibrated
from wirerope_mj.studies.calibration.result import Calibration as Calibration
