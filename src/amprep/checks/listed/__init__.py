"""Judge what a build file lists as unsupported: it must not list what could be supported."""
