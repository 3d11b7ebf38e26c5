"""How much a trace's search tries: an argument of `trace`, as the searches of gains have theirs."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Budget:
    """What a search among candidates may spend. Time goes with each; less of any may miss an effect, more finds what is there anyway.

    starts: of a candidate's shape parameters, at most; the grids of the catalogue have up to 36. refined: of those, that are searched
    on: the cheapest by their linear fit alone. Half misses waves beside their harmonics; twice costs half of a trace again. strokes:
    start values of a stroke, at most. resonances: peaks of a residual's power over acceleration that are tried. leading: candidates
    fitted again with everything free. families: that are asked for their free form, those of the best candidates. laws: others of
    a class that are fitted to whole records where validation does not carry one, the best first.
    """

    starts: int = 64
    refined: int = 2
    strokes: int = 6
    resonances: int = 3
    leading: int = 6
    families: int = 3
    laws: int = 3


BUDGET = Budget()
