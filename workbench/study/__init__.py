"""A study: a campaign, what is asked of it, and what it must reach; run, cached and written whole."""
