"""Overhangs of placed parts, with blockers and enforcers; contacts with supports; unsupported overhangs."""
