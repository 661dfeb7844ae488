# SPDX-License-Identifier: MIT
"""Brisance beside other codes: `make compare`, docs/evidence/comparison.md."""
