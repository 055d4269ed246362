"""Numbers, as the engine passes them about."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
