"""The material profiles: limits of overhangs and supports, density, layer height, and the speed of the machine."""
