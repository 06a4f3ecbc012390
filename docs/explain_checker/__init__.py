"""Modules of docs/check_explanation, which have no code in common with the library."""
