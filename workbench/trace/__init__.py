"""What the declared model lacks: find the residual, name the effect, add it, and report the error before and after.

The package can be called: `workbench.trace(fit, passes)` traces what the model of a fit leaves on the records of `passes`
(`workbench.identify.fit.passes_of`), as the command does with a campaign.
"""

import sys
from types import ModuleType


class Callable(ModuleType):
    """The package itself, which reads as a verb."""

    def __call__(self, fit, passes, **options):
        """Return the Trace of a fit (or of a plant) over `passes`; options as workbench.trace.tracing.trace takes them."""
        from workbench.trace.tracing import trace

        return trace(getattr(fit, "plant", fit), passes, **options)


sys.modules[__name__].__class__ = Callable
