"""What gains are worth: baselines tuned alike, comparison on the same scenarios, and the physical bound beside them."""
