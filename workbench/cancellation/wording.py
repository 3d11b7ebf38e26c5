"""What is said of effects that are cancelled: that they are what holds the loop up."""

from collections.abc import Sequence

from workbench.finding import Finding


def not_stable_alone(effects: Sequence[str], controller: str) -> Finding:
    """Say that a controller does not stand on the plant that is left without these effects."""
    sentence = (
        f"Without {' and '.join(effects)} the controller “{controller}” does not follow a slow motion: what is to be "
        "cancelled is what holds the loop up."
    )
    return Finding(
        "not stable alone", "compensation", sentence, {}, "raise its gains first, or compensate from the reference"
    )
