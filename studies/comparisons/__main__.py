# SPDX-License-Identifier: MIT
"""`python -m studies.comparisons`: see `make compare ARGS=--help`."""

import sys

from studies.comparisons.compare import main

sys.exit(main())
