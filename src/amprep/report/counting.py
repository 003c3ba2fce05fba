"""Write numbers of things with the right form of the noun."""


def counted(number: int, noun: str) -> str:
    """Return for example ``1 part`` or ``2 parts``; `noun` is the singular, its plural ends with s."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
