"""Types of arrays, for annotations only."""

from typing import Any

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[Any]
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]
Indices = npt.NDArray[np.uint32]
