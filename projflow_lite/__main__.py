"""``python -m projflow_lite`` is the same as ``projflow-lite``."""

import sys

from projflow_lite.cli import main

sys.exit(main())
