"""What share of a command is done when which thing is said first, until a run is remembered: CPU time of the carried campaign."""

SHARES: dict[str, list[tuple[str, float]]] = {
    "trace": [
        ("fitting the declared model", 0.05),
        ("trying actuator_lag@command", 0.09),
        ("trying load_dependent_friction@axis", 0.24),
        ("trying transport_delay@command", 0.31),
        ("fitting the extended model", 0.43),
        ("weighing the evidence", 0.44),
        ("looking for where the residual lives", 0.68),
        ("closing the loop", 0.68),
        ("writing the page", 0.69),
    ]
}
