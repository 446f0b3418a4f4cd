//! Surfaces in closed form.

use arcfeed_plan::geometry::face::Jet;
use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::vector::{Point, Vector};

/// Surfaces of `feng_projection.csv`, with the length `a` of each.
#[derive(Clone, Copy, Debug)]
pub enum Plain {
    Plane,
    Cylinder(f64),
    Sphere(f64),
    Torus(f64),
}

/// Sheet of data/README.md.
#[derive(Clone, Copy, Debug)]
pub struct Sheet;

fn jet(point: Vector, [u, v]: [Vector; 2], [uu, uv, vv]: [Vector; 3]) -> Jet {
    Jet { point: Point::from(point), u, v, uu, uv, vv }
}

impl Surface for Plain {
    fn jet(&self, [u, v]: [f64; 2]) -> Jet {
        let zero = Vector::zeros();
        let ((su, cu), (sv, cv)) = (libm::sincos(u), libm::sincos(v));
        // Surface of revolution about z with radius R(v) and height Z(v).
        let revolved = |[radius, slope, bend]: [f64; 3], [height, rise, curve]: [f64; 3]| {
            jet(
                Vector::new(radius * cu, radius * su, height),
                [Vector::new(-radius * su, radius * cu, 0.0), Vector::new(slope * cu, slope * su, rise)],
                [
                    Vector::new(-radius * cu, -radius * su, 0.0),
                    Vector::new(-slope * su, slope * cu, 0.0),
                    Vector::new(bend * cu, bend * su, curve),
                ],
            )
        };
        match *self {
            Plain::Plane => {
                let (along, across) = (Vector::new(30.0, 0.0, 5.0), Vector::new(0.0, 20.0, 0.0));
                jet(along * u + across * v, [along, across], [zero; 3])
            }
            Plain::Cylinder(a) => revolved([a, 0.0, 0.0], [v, 1.0, 0.0]),
            Plain::Sphere(a) => revolved([a * cv, -a * sv, -a * cv], [a * sv, a * cv, -a * sv]),
            Plain::Torus(a) => revolved([1.5 * a + a * cv, -a * sv, -a * cv], [a * sv, a * cv, -a * sv]),
        }
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        [[-1.0, 1.0]; 2]
    }

    fn outward(&self) -> f64 {
        1.0
    }
}

impl Surface for Sheet {
    fn jet(&self, [u, v]: [f64; 2]) -> Jet {
        let (c, b, angle) = (40.0 - 8.0 * u, 4.0 - u, 0.5 + 0.35 * u);
        // In the turning frame: place and its derivatives; the frame itself turns by 0.35 rad per u.
        let place = Vector::new(c * (v - 0.5), 4.0 * b * v * (1.0 - v), 0.0);
        let by_u = Vector::new(-8.0 * (v - 0.5), -4.0 * v * (1.0 - v), 0.0);
        let by_v = Vector::new(c, 4.0 * b * (1.0 - 2.0 * v), 0.0);
        let by_uv = Vector::new(-8.0, -4.0 * (1.0 - 2.0 * v), 0.0);
        let by_vv = Vector::new(0.0, -8.0 * b, 0.0);
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector::z_axis(), angle);
        let quarter = |w: Vector| Vector::new(-w.y, w.x, 0.0) * 0.35;
        let up = Vector::new(0.0, 0.0, 70.0 + 40.0 * u);
        jet(
            turn * place + up,
            [turn * (by_u + quarter(place)) + Vector::new(0.0, 0.0, 40.0), turn * by_v],
            [turn * (quarter(by_u) * 2.0 + quarter(quarter(place))), turn * (by_uv + quarter(by_v)), turn * by_vv],
        )
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        [[0.0, 1.0]; 2]
    }

    fn outward(&self) -> f64 {
        -1.0
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    fn check(surface: impl Surface, at: [f64; 2]) {
        let h = 1e-5;
        let [u, v] = at;
        let jet = surface.jet(at);
        let (after, before) = (surface.jet([u + h, v]), surface.jet([u - h, v]));
        let (above, below) = (surface.jet([u, v + h]), surface.jet([u, v - h]));
        let pairs = [
            (jet.u, (after.point - before.point) / (2.0 * h)),
            (jet.v, (above.point - below.point) / (2.0 * h)),
            (jet.uu, (after.u - before.u) / (2.0 * h)),
            (jet.uv, (after.v - before.v) / (2.0 * h)),
            (jet.vv, (above.v - below.v) / (2.0 * h)),
        ];
        for (found, expected) in pairs {
            assert!((found - expected).norm() < 1e-6, "{found} {expected}");
        }
    }
    for plain in [Plain::Plane, Plain::Cylinder(7.0), Plain::Sphere(9.0), Plain::Torus(5.0)] {
        check(plain, [0.3, -0.4]);
    }
    check(Sheet, [0.35, 0.7]);
}
