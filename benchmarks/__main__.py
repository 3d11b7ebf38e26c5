"""`make bench`: every benchmark in turn, or those named on the command line. Ratios are the result, not times."""

import importlib
import pkgutil
import sys

import benchmarks


def main(names: list[str]) -> int:
    known = [m.name for m in pkgutil.iter_modules(benchmarks.__path__) if not m.name.startswith("_")]
    for name in names or known:
        if name not in known:
            print(f"benchmarks: there is no '{name}'; known: {', '.join(known)}.", file=sys.stderr)
            return 2
        print(f"\n== {name}\n", flush=True)
        importlib.import_module(f"benchmarks.{name}").main()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
