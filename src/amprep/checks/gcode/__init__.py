"""Judge whether the G-code that a slicer made prints what was prepared."""
