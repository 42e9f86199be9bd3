"""Motion out of the notebook: pictures and films."""
