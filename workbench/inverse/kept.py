"""What results are kept in: by key, so many of them, those used last."""

from collections import OrderedDict
from collections.abc import Callable

# Columns kept a record: the declared model, and some trial shapes. With 40 or with 160 traces take as long; of two masses with 20 000 samples a
# record 160 take 1.3 GB, these 0.85
KEEP = 64


class Kept:
    """Results by key. It holds nothing of who makes them: what is kept of a record is free as soon as nobody looks at the record."""

    def __init__(self):
        self._results: OrderedDict[tuple, object] = OrderedDict()

    def __call__(self, key: tuple, make: Callable):
        """Return the result under a key; made where it is not there."""
        value = self._results.pop(key, self)
        if value is self:
            value = make()
        self._results[key] = value  # at the end, as the one used last
        if len(self._results) > KEEP:
            self._results.popitem(last=False)
        return value
