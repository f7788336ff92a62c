"""Point clouds of any size: trees on disk, queries, filters, fits.

>>> import pcmlab
>>> answer = pcmlab.build(["scan.laz"], output="scan.pct")
>>> cloud = pcmlab.open("scan.pct")
>>> part = cloud.query(box=(500000, 4800000, 90, 500030, 4800030, 110), level=1)
>>> part["xyz"].dtype, part["xyz"].shape[1], part["intensity"].dtype
(dtype('float64'), 3, dtype('uint16'))

Every operation of the command `pcmlab` is a function here, with the same arguments and the same answer: `help(pcmlab.outliers)`.
Coordinates are the cloud's own, float64; lengths are in its unit. Values of attributes are the file's own, in their own
type. Errors are `pcmlab.Error` and `pcmlab.ArgumentError`.
"""

from . import operations
from ._pcmlab import ArgumentError, Error, version
from .cloud import Attribute, Cloud, Level, edit, from_arrays, open
from .operations import *  # noqa: F401,F403

__version__ = version()
__all__ = ["ArgumentError", "Attribute", "Cloud", "Error", "Level", "edit", "from_arrays", "open", *operations.__all__]
