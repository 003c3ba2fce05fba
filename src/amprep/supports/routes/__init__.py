"""Route the support network: routers, sharing between parts, columns on parts."""
