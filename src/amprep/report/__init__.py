"""Reports of a run: records, JSON, HTML with a 3D view, pictures, the closing table."""
