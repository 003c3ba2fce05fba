"""Judge supports beside other supports and parts, and whether they reach their own."""
