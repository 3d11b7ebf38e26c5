"""What share of a command is done when which thing is said first: of the main study, as measured, until a run is remembered."""

SHARES: dict[str, list[tuple[str, float]]] = {}
