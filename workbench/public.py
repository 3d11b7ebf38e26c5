"""Public names of a package, each imported where it is first asked for: a front costs no import and closes no circle."""

from collections.abc import Callable, Mapping
from importlib import import_module


def handed_on(package: str, held: Mapping[str, str]) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return __getattr__ and __dir__ of a package. held: name -> module of the package that defines it."""

    def get(name: str) -> object:
        if name not in held:
            raise AttributeError(f"module '{package}' has no attribute '{name}'; it hands on {', '.join(sorted(held))}")
        return getattr(import_module(f"{package}.{held[name]}"), name)

    return get, lambda: sorted(held)
