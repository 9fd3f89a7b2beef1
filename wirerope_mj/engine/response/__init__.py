"""Responses: time histories and peaks, in memory or in a file, independent of the engine."""

from wirerope_mj.engine.response.histories import Numerics as Numerics
from wirerope_mj.engine.response.peaks import ContactPeak as ContactPeak
from wirerope_mj.engine.response.peaks import Peak as Peak
from wirerope_mj.engine.response.response import Response as Response
from wirerope_mj.engine.response.response import load_response as load_response
from wirerope_mj.engine.response.scene import Scene as Scene
