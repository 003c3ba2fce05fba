"""Edit build files as other programs do: in the text of the model, without amprep."""

import re
import zipfile

import numpy as np

MODEL = "3D/3dmodel.model"


def shift(x=0.0, y=0.0, z=0.0):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def turn(angle_deg, x, y):
    """A rotation about the vertical through a point."""
    cosine, sine = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    matrix = np.eye(4)
    matrix[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return shift(x, y) @ matrix @ shift(-x, -y)


def edit(source, target, moved=None, *, deleted=(), copied=(), bare=False):
    """Write a build file with other items: moved ``{item: matrix}``, deleted, copied ``[(item, matrix)]``.

    With `bare`, everything that amprep recorded is removed, as slicers do.
    """
    with zipfile.ZipFile(source) as package:
        entries = {name: package.read(name) for name in package.namelist()}
    head, begin, tail = entries[MODEL].decode().partition("<build")
    items = re.findall(r"<item\b.*?(?:</item>|/>)", tail, re.DOTALL)
    kept = [
        _placed(item, (moved or {}).get(number, np.eye(4)))
        for number, item in enumerate(items)
        if number not in deleted
    ]
    kept += [re.sub(r'\s*p:UUID="[^"]*"', "", _placed(items[number], matrix)) for number, matrix in copied]
    text = head + begin + tail[: tail.index("<item")] + "".join(kept) + tail[tail.rindex("</build>") :]
    if bare:
        text = re.sub(r"<metadatagroup>.*?</metadatagroup>", "", text, flags=re.DOTALL)
        text = re.sub(r'<metadata name="amprep:.*?</metadata>', "", text, flags=re.DOTALL)
    entries[MODEL] = text.encode()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as package:
        for name, content in entries.items():
            package.writestr(name, content)
    return target


def _placed(item, matrix):
    _, tag, rest = re.split(r"^(<item\b[^>]*?)(?=/?>)", item, maxsplit=1)
    found = re.search(r'\s*transform="([^"]*)"', tag)
    before = np.eye(4)
    if found:
        before[:3] = np.array([float(each) for each in found[1].split()]).reshape(4, 3).T
        tag = tag.replace(found[0], "")
    numbers = " ".join(f"{value:.9g}" for value in (matrix @ before)[:3].T.ravel())
    return f'{tag} transform="{numbers}"{rest}'
