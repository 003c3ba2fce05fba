"""From overhangs to support bodies."""
