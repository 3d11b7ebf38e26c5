"""The command line: `workbench VERB`. A verb imports what it needs when it runs, so that `--help` is instant."""

import argparse
from collections.abc import Sequence

from workbench import __version__


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    parser = argparse.ArgumentParser(prog="workbench", description="Controller design for servo axes by optimisation.")
    parser.add_argument("--version", action="version", version=f"workbench {__version__}")
    parser.parse_args(arguments)
    parser.print_help()
    return 0
