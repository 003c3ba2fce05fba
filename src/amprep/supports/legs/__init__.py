"""Find legs that are too long for their width on the routed edges, and make them short enough."""
