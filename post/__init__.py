# SPDX-License-Identifier: MIT
"""Read, measure, draw and report what a run of Brisance has written.

`reader` is the one place that opens files of a run; everything else asks it.
"""
