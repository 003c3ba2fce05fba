"""Reports of a run: records, JSON, HTML page with a 3D view, pictures, summary for the terminal."""
