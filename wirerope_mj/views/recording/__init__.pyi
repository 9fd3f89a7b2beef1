from .record import read_state as read_state
from .record import record_overlay as record_overlay
from .record import record_rerun as record_rerun
from .viewer import show as show
