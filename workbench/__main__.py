"""`python -m workbench` is the command."""

from workbench.cli import command

if __name__ == "__main__":
    command()
