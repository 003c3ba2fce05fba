"""Rules of the build: chapter 3.4.3 of the core specification, with references from one model part to another."""

from collections.abc import Mapping, Sequence

from amprep.threemf.rules.broken import BrokenRules
from amprep.threemf.rules.resources import Component, ObjectFacts

Objects = Mapping[str, Mapping[str, ObjectFacts]]
"""Name of a model part -> id -> facts of its objects."""


def check_build(
    objects: Objects, items: Mapping[str, Sequence[Component]], start: str, found: BrokenRules
) -> None:
    """Check the references of components to other model parts, and those of the items of the start part.

    Parameters
    ----------
    objects
        The objects of every model part.
    items
        Name of a model part -> what the items of its build refer to.
    start
        Name of the start part.
    found
        Collects what is broken.
    """
    lower = {name.lower(): name for name in objects}
    for part, its_objects in objects.items():
        for identifier, facts in its_objects.items():
            for each in facts.components:
                if each.part and _find(each, part, objects, lower) is None:
                    expected = "a component must name an object that exists"
                    place = f"{part}, object {identifier[:12]}, {each.part}, objectid {each.object_id[:12]}"
                    found.add("3MF core 4.2.1", expected, place, touches_parts=True)
    for number, item in enumerate(items.get(start, ())):
        place = f"{start}, item {number + 1}, objectid {item.object_id[:12]}"
        home = lower.get(item.part.lower(), "") if item.part else start
        if _find(item, start, objects, lower) is None:
            expected = "an item must name an object that exists"
            found.add("3MF core 3.4.3.1", expected, place, touches_parts=True)
        elif _reaches_other(Component(home, item.object_id), objects, lower):
            expected = "an item may not name an object of type other, neither directly nor by components"
            found.add("3MF core 3.4.3.1", expected, place, touches_parts=True)


def _find(reference: Component, part: str, objects: Objects, lower: Mapping[str, str]) -> ObjectFacts | None:
    home = lower.get(reference.part.lower(), "") if reference.part else part
    return objects.get(home, {}).get(reference.object_id)


def _reaches_other(start: Component, objects: Objects, lower: Mapping[str, str]) -> bool:
    """Tell whether an object of type other without components is among an object and all that it is made of."""
    stack, seen = [start], {start}
    while stack:
        here = stack.pop()
        facts = objects.get(here.part, {}).get(here.object_id)
        if facts is None:
            continue
        if facts.object_type == "other" and not facts.components:
            return True
        for each in facts.components:
            home = lower.get(each.part.lower(), "") if each.part else here.part
            target = Component(home, each.object_id)
            if target not in seen:
                seen.add(target)
                stack.append(target)
    return False
