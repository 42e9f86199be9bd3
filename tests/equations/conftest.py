"""Property tests draw the same cases in every run and are never failed for being slow."""

from hypothesis import settings

settings.register_profile("equations", deadline=None, derandomize=True)
settings.load_profile("equations")
