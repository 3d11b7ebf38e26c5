"""NumPy files: .npy with one array, .npz with several by name.

A column of an .npy file is "column 3" of its matrix, or a field of its records; of an .npz file an array, or "log(:,3)".
"""

import io
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.readers.arrays import addressed, listed, taken
from workbench.readers.held import Held, Whole
from workbench.readers.limits import unzippable


class Npy(Whole):
    """See workbench.readers.Reader."""

    name = "npy"
    suffixes = (".npy", ".npz")

    def held(self, content: bytes, path: Path) -> Mapping[str, Held]:
        try:
            if content.startswith(b"PK"):
                unzippable(content, path)
            found = np.load(io.BytesIO(content), allow_pickle=False)
            arrays = {"": found} if isinstance(found, np.ndarray) else {n: found[n] for n in found.files}
        except WorkbenchError:
            raise
        except Exception as e:  # NumPy raises whatever broken bytes lead to
            reason = " ".join(str(e).split())[:120] or type(e).__name__
            raise WorkbenchError(f"{path}: is no whole NumPy file of numbers ({reason}); save or copy it again.") from e
        return {n: Held(v) for name, array in arrays.items() for n, v in _vectors(name, array, path)}


def _vectors(name: str, array: np.ndarray, path: Path) -> Iterator[tuple[str, np.ndarray]]:
    if array.dtype.names:
        yield from ((f"{name}.{n}" if name else n, array[n]) for n in array.dtype.names)
        return
    for k, one in enumerate(listed(name, array.shape), 1):
        values = taken(array, addressed(one)[1], one, path)
        yield one if name else f"column {k}", values
