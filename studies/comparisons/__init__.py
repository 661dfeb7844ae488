# SPDX-License-Identifier: MIT
"""Brisance beside other codes: `make compare`, studies/notes/comparison.md."""
