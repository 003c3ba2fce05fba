"""Find overhanging faces, knife edges and tips."""
