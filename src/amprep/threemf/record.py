"""What amprep writes about a build into its 3MF: namespace, names of the metadata, records as small JSON."""

NAMESPACE = "http://schemas.amprep.dev/3mf/2026/11"
"""Namespace of all metadata that amprep reads from jobs and writes into builds."""

FORMAT_VERSION = "1"
"""Version of the record; a file with another one is refused by name."""
