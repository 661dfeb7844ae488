# SPDX-License-Identifier: MIT
"""Failures with a message for the user and the exit code of the command."""

USAGE = 2  # wrong arguments, or a deck that cannot be read
NUMERICAL = 3  # the results hold values that are not finite
INPUT_OUTPUT = 4  # results missing, damaged or of another version


class PostError(Exception):
    """What went wrong, in one sentence with file and remedy, and the exit code."""

    def __init__(self, message: str, code: int = INPUT_OUTPUT):
        super().__init__(message)
        self.code = code


class DamagedError(PostError):
    """A dump that cannot be read: cut off, overwritten, or no HDF5 at all."""
