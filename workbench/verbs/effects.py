"""`workbench effects`: list the known effects."""

import argparse


def declare(verbs) -> None:
    effects = verbs.add_parser(
        "effects",
        help="list the known effects",
        description="List the known effects: names, formulas, units, causes.",
    )
    effects.add_argument("name", nargs="?", help="one effect only")
    effects.add_argument("--markdown", action="store_true", help="the whole catalogue as a page (docs/catalogue.md)")


def do(given: argparse.Namespace) -> int:
    from workbench.definition import catalogue, find

    if given.markdown:
        from workbench.catalogue_page import page

        print(page(), end="")
        return 0
    chosen = [find(given.name)] if given.name else list(catalogue().values())
    for e in chosen:
        print(f"{e.name}\n    {e.formula}\n    cause: {e.cause}")
        for name, p in e.outside.items():
            unit = p.unit.replace("F", "[N*m or N]").replace("x", "[rad or m]")
            print(f"    {name}: {p.meaning}, {'no unit' if p.unit == '1' else unit}")
        print(f"    acts at: {', '.join(e.places)}   source: {e.source}\n")
    return 0
