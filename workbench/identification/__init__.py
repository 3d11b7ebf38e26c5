"""Parameters with intervals from records: inverse dynamics, separable least squares, and what the data do not determine."""
