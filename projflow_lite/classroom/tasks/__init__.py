"""The exercises by topic: what to do, hints, and the cases that decide."""
