"""A named effect, cancelled: compensation from the one definition of the effect."""
