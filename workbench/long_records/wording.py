"""What is said of a fit of long records: elements of a bank that they do not tell apart."""

from collections.abc import Sequence

from workbench.definition import Effect
from workbench.finding import KNOWN_TOGETHER, Finding


def known_only_together(bank: Effect, names: Sequence[str], reach: float, displacement: str) -> Finding:
    """Say which elements never slip: to the records they are one spring, however many they are. reach: in `displacement`."""
    sentence = (
        f"{bank.named}: elements {', '.join(names)} never slip in these records, which reach {reach:.3g} "
        f"{displacement} from where they begin; only the sum of their stiffnesses is determined."
    )
    remedy = "record a longer stroke, or leave out all but one of them"
    return Finding(KNOWN_TOGETHER, f"{bank.key}.{names[0]}", sentence, {"reach": reach}, remedy)
