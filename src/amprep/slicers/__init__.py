"""Slicers: the G-code that they write, what they tell scripts, and the files of their profiles."""
