"""Errors of commands with recordings."""

from __future__ import annotations

from fathom.errors import FathomError


class BagError(FathomError, ValueError):
    """Input that a command with recordings cannot use; ends it."""
