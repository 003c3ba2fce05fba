"""The built-in plugins, one package per stage; each is loaded by name, like any other."""
