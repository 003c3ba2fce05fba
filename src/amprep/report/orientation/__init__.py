"""The result of ``amprep orient``: record, terminal, JSON and page."""
