"""What the declared model lacks: find the residual, name the effect, add it, and report the error before and after."""
