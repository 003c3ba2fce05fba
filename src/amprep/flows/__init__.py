"""Maximum flow, minimum cuts and capacity escalation on the support graph."""
