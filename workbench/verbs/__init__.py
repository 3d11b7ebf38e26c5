"""The verbs of the command line, a module each: `declare` says its words, `do` does it and returns the exit code.

A verb imports what it needs inside `do`, so that `--help` is instant.
"""

NOT_MET = 1
NO_DATA = 3
