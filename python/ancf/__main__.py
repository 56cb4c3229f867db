"""``python -m ancf`` is ``ancf``."""

import sys

from ancf.cli import main

sys.exit(main())
