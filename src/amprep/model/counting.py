"""Write numbers of things with the right form of the noun."""


def counted(number: int, noun: str, plural: str | None = None) -> str:
    """Return for example ``1 part`` or ``2 parts``; `noun` is the singular, and its plural ends with s by default."""
    return f"{number} {noun}" if number == 1 else f"{number} {plural or noun + 's'}"
