"""OBB trees of triangle meshes and the queries on them (thesis 2.6), for use in compiled loops.

Bodies
------
`amprep.geometry.trees.collision_mesh.collision_mesh(vertices, triangles)` returns a record whose `tree` is an
`ObbTree`, a NamedTuple of arrays. Copies of a part share one tree. Meshes must be closed and outward oriented.

Poses
-----
A pose is an array of 12 floats: the rows of the ``(3, 4)`` matrix of a rigid motion. Directions and axes are tuples of
three floats, unit vectors in the coordinates of the poses. `amprep.geometry.trees.stacks.new_stack(depth, depth)` makes
the work arrays; one made with the greatest `tree.depth` of all bodies serves all queries of a thread.

Queries
-------
``surfaces_collide(a, pose_a, b, pose_b, margin, stack) -> bool`` (`collide`)
``directional_distance(a, pose_a, b, pose_b, direction, margin, limit, stack) -> mm`` (`directional`)
``rotational_distance(a, pose_a, b, pose_b, point, axis, margin, limit, stack) -> rad`` (`rotational`)
``solids_collide(a, pose_a, b, pose_b, margin, stack) -> bool`` (`containment`): also if one contains the other
``is_inside(a, pose_a, b, pose_b, stack) -> bool`` (`containment`)
``contains_point(a, point, stack) -> bool`` (`containment`): in part coordinates
``surface_distance(a, pose_a, b, pose_b, limit, stack) -> mm`` (`distance`)
``travel_inside(a.hull, pose, direction, walls, margin) -> (first, last) mm`` (`walls`)
``turn_inside(a.hull, pose, point, axis, walls, margin, limit) -> rad`` (`walls`)
``depth_outside(a.hull, pose, walls, margin) -> mm`` (`walls`)

Contact
-------
Lengths up to `TOUCH` = 1e-7 mm count as rounding. Surfaces that touch, at faces, edges or corners, do not collide;
solids that enter one another by more do. With a positive margin, bodies collide if their distance is below the margin
minus `TOUCH`. A directional distance ends where the distance is the margin; from there a body may slide and move away,
and its directional distance is 0 where it would come closer; the same applies to the rotational distance. So a sequence
of moves, each at most as long as these distances, neither gets stuck nor enters another body.
"""
