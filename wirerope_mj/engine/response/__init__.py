"""Responses: time histories and peaks, in memory or in a file, independent of the engine."""

from wirerope_mj.engine.response.histories import Numerics
from wirerope_mj.engine.response.peaks import ContactPeak, Peak
from wirerope_mj.engine.response.response import Response, load_response
from wirerope_mj.engine.response.scene import Scene
