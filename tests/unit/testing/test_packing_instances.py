"""The named packing instances are the published ones."""

import hashlib

from amprep.testing.packing_instances import MPV_SIDE, mpv_instance

PUBLISHED = "0e6d9f5cd1e8d8f5b0897c27c654c1f3d976713423f5c756511f64ec22eb9419"


def sizes(class_, n, index):
    items = mpv_instance(class_, n, index).problem.items
    return [item.volume.enclosing()[1].astype(int).tolist() for item in items]


def test_the_first_boxes_of_class_1_are_as_published():
    assert sizes(1, 50, 1)[:3] == [[39, 85, 72], [11, 84, 96], [36, 10, 34]]


def test_the_320_instances_have_the_digest_of_the_published_set():
    # one text per instance: "n W H D", then "w h d" per box, as in OR-Datasets' Martello2000
    sha = hashlib.sha256()
    for class_, side in MPV_SIDE.items():
        for n in (50, 100, 150, 200):
            for index in range(1, 11):
                rows = [[n, side, side, side], *sizes(class_, n, index)]
                sha.update("".join(" ".join(map(str, row)) + "\n" for row in rows).encode())
    assert sha.hexdigest() == PUBLISHED
