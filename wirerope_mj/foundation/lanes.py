"""Numbers side by side: one source for one system and for several, each in a lane of the processor's vector registers.

A `Lanes` value is a vector of `WIDTH` floats that Numba lowers to LLVM's vectors; `Rows` is an array of them in memory, made
by `rows` from an array of the shape (n, WIDTH). Jitted functions use both as they would use a float and an array of
floats, so that one source serves scalars and lanes. Branches are what differs: a comparison of lanes gives a mask, and
`where` chooses with it. With JIT disabled lanes are NumPy's rows, and the same sources are the plain reference.

Every lane is computed by the same instructions whatever stands in the others, so that a system has the same bits alone, padded
by copies of itself, and in any company.
"""

from wirerope_mj.foundation.lane_choices import count as count
from wirerope_mj.foundation.lane_choices import lane as lane
from wirerope_mj.foundation.lane_choices import picked as picked
from wirerope_mj.foundation.lane_choices import ranked as ranked
from wirerope_mj.foundation.lane_choices import rows as rows
from wirerope_mj.foundation.lane_choices import some as some
from wirerope_mj.foundation.lane_choices import spread as spread
from wirerope_mj.foundation.lane_choices import table as table
from wirerope_mj.foundation.lane_choices import where as where
from wirerope_mj.foundation.lane_choices import with_lane as with_lane
from wirerope_mj.foundation.lane_math import power as power
from wirerope_mj.foundation.lane_math import raised as raised
from wirerope_mj.foundation.lane_types import LANES as LANES
from wirerope_mj.foundation.lane_types import MASK as MASK
from wirerope_mj.foundation.lane_types import ROWS as ROWS
from wirerope_mj.foundation.lane_types import WIDTH as WIDTH
