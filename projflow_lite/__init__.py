"""projflow_lite: exact motion control with generative flows, small enough to read."""
