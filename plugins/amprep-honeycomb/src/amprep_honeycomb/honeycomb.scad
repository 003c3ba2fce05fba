// A honeycomb in the unit cube: walls as lines in plan, windows in the walls across x.
wall = 0.12;

module line(a, b) {
  along = b - a;
  translate([a[0], a[1], 0]) rotate([0, 0, atan2(along[1], along[0])])
    translate([-wall / 2, -wall / 2, 0]) cube([norm(along) + wall, wall, 1]);
}

module window(x, y) {
  translate([x, y, 0.5]) rotate([90, 0, 90]) linear_extrude(2 * wall, center = true)
    polygon([[-0.1, 0], [0, -0.2], [0.1, 0], [0, 0.2]]);
}

intersection() {
  cube(1);
  difference() {
    union() {
      line([0.75, -0.17], [0.75, 0.17]);  line([0.75, 0.83], [0.75, 1.17]);
      line([0.25, 0.33], [0.25, 0.67]);
      line([0.75, 0.17], [0.25, 0.33]);   line([0.25, 0.67], [0.75, 0.83]);
      line([0.75, 0.17], [1.25, 0.33]);   line([-0.25, 0.17], [0.25, 0.33]);
      line([0.25, 0.67], [-0.25, 0.83]);  line([1.25, 0.67], [0.75, 0.83]);
    }
    window(0.25, 0.5);
    window(0.75, 0);
    window(0.75, 1);
  }
}
