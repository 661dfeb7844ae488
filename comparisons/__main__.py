# SPDX-License-Identifier: MIT
"""`python -m comparisons`: see `make compare ARGS=--help`."""

import sys

from comparisons.compare import main

sys.exit(main())
