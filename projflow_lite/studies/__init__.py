"""Questions answered by measurement, each with one command: ``projflow-lite reproduce NAME``."""
