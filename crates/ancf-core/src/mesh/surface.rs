//! Reference surfaces: smooth maps from two natural coordinates to space.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Vector3;

use crate::error::InputError;

use super::Grid;

/// A point of a reference surface: its position and the derivatives with respect to the natural coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position, m.
    pub r: [f64; 3],
    /// Derivative along x.
    pub r_x: [f64; 3],
    /// Derivative along y.
    pub r_y: [f64; 3],
    /// Mixed second derivative.
    pub r_xy: [f64; 3],
}

impl SurfacePoint {
    /// The unit normal along `r_x x r_y`.
    pub fn normal(&self) -> [f64; 3] {
        Vector3::from(self.r_x).cross(&Vector3::from(self.r_y)).normalize().into()
    }

    /// Whether all numbers are finite and `r_x`, `r_y` span a plane.
    fn is_regular(&self) -> bool {
        /// Tangents at a smaller angle (rad) than this have lost half of their digits.
        const ANGLE: f64 = 1e-8;
        let (x, y) = (Vector3::from(self.r_x), Vector3::from(self.r_y));
        let finite = [self.r, self.r_x, self.r_y, self.r_xy].iter().flatten().all(|number| number.is_finite());
        finite && x.cross(&y).norm() > ANGLE * x.norm() * y.norm()
    }

    /// Area per area of the natural coordinates.
    fn area(&self) -> f64 {
        Vector3::from(self.r_x).cross(&Vector3::from(self.r_y)).norm()
    }
}

/// Area, relative to the largest at a node, that is none: tangents from differences do not vanish exactly.
const NO_AREA: f64 = 1e-10;

/// The reference shape of a body as a function of its natural coordinates x and y.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    domain: [[f64; 2]; 2],
    map: Map,
}

#[derive(Clone, Debug, PartialEq)]
enum Map {
    Rectangle,
    Annulus,
    Cylinder { radius: f64 },
    Sphere { radius: f64 },
    Nodes { divisions: [usize; 2], points: Vec<SurfacePoint> },
}

/// What an angle may exceed its limit by: a full turn is rarely written with all digits.
const ROUNDED_ANGLE: f64 = 1e-9;

impl Surface {
    /// A flat rectangle in the X-Y plane, `x` in `[0, size[0]]`, `y` in `[0, size[1]]`, m.
    ///
    /// # Errors
    ///
    /// Both sides must be positive and finite.
    pub fn rectangle(size: [f64; 2]) -> Result<Self, InputError> {
        for (argument, side) in ["size.0", "size.1"].into_iter().zip(size) {
            InputError::check(argument, side, side > 0.0 && side.is_finite(), "a positive number, m")?;
        }
        Ok(Self { domain: [[0.0, size[0]], [0.0, size[1]]], map: Map::Rectangle })
    }

    /// A flat sector of an annulus in the X-Y plane: x is the radius in `[radii[0], radii[1]]`, m, y the angle in
    /// `[0, angle]`, rad. At the angle of a full turn it is slit along the X axis.
    ///
    /// # Errors
    ///
    /// Radii must be positive and increasing, the angle positive and at most a full turn.
    pub fn annulus(radii: [f64; 2], angle: f64) -> Result<Self, InputError> {
        let [inner, outer] = radii;
        let valid = 0.0 < inner && inner < outer && outer.is_finite();
        InputError::check("radii", show(radii), valid, "two increasing positive numbers, m")?;
        let valid = angle > 0.0 && angle <= TAU + ROUNDED_ANGLE;
        InputError::check("angle", angle, valid, "above 0, at most 2 pi, rad")?;
        Ok(Self { domain: [radii, [0.0, angle]], map: Map::Annulus })
    }

    /// A part of a circular cylinder about the Z axis, `(R cos x, R sin x, y)`: x is the angle, rad, y the coordinate
    /// along the axis, m. At a full turn it is slit.
    ///
    /// # Errors
    ///
    /// The radius must be positive, both ranges increasing, the angles at most a full turn apart.
    pub fn cylinder(radius: f64, angle: [f64; 2], length: [f64; 2]) -> Result<Self, InputError> {
        check_radius(radius)?;
        check_turn("angle", angle)?;
        InputError::check("length", show(length), is_range(length), "two increasing numbers, m")?;
        Ok(Self { domain: [angle, length], map: Map::Cylinder { radius } })
    }

    /// A part of a sphere about the origin, `R (cos y cos x, cos y sin x, sin y)`: x is the longitude, y the latitude
    /// above the X-Y plane, both rad. At a full turn it is slit.
    ///
    /// # Errors
    ///
    /// The radius must be positive, both ranges increasing, the longitudes at most a full turn apart, the latitudes
    /// between the poles: there the longitude has no direction.
    pub fn sphere(radius: f64, longitude: [f64; 2], latitude: [f64; 2]) -> Result<Self, InputError> {
        /// Distance from the poles, rad, at which a tangent has lost half of its digits.
        const POLE: f64 = 1e-8;
        check_radius(radius)?;
        check_turn("longitude", longitude)?;
        let between = is_range(latitude) && latitude.iter().all(|y| y.abs() < FRAC_PI_2 - POLE);
        let allowed = "two increasing numbers above -pi/2 and below pi/2, rad";
        InputError::check("latitude", show(latitude), between, allowed)?;
        Ok(Self { domain: [longitude, latitude], map: Map::Sphere { radius } })
    }

    /// Any smooth surface, given at the nodes of a grid with the given divisions: the points in the order of the
    /// nodes, along x first.
    ///
    /// # Errors
    ///
    /// The ranges must be increasing, there must be one point a node, and at each `r_x` and `r_y` must span a plane.
    pub fn from_nodes(
        domain: [[f64; 2]; 2],
        divisions: [usize; 2],
        points: Vec<SurfacePoint>,
    ) -> Result<Self, InputError> {
        for (argument, range) in ["domain.0", "domain.1"].into_iter().zip(domain) {
            InputError::check(argument, show(range), is_range(range), "two increasing numbers")?;
        }
        let grid = Grid::new(domain, divisions)?;
        let allowed = format!("{} points, one a node", grid.nodes());
        InputError::check("points", points.len(), points.len() == grid.nodes(), &allowed)?;
        let largest = points.iter().map(SurfacePoint::area).fold(0.0, f64::max);
        // Not `<=`, which would let a NaN pass.
        let regular = |point: &SurfacePoint| point.is_regular() && point.area() > NO_AREA * largest;
        if let Some(node) = points.iter().position(|point| !regular(point)) {
            let [x, y] = grid.parameters(node);
            let allowed = "finite numbers, r_x and r_y neither zero nor parallel";
            return Err(InputError::new(format!("points.{node}"), format!("at [{x}, {y}]"), allowed));
        }
        Ok(Self { domain, map: Map::Nodes { divisions, points } })
    }

    /// The ranges of the natural coordinates.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        self.domain
    }

    /// The points at the nodes of the grid with the given divisions.
    ///
    /// # Errors
    ///
    /// A surface given at nodes has the divisions that it was given with.
    pub(crate) fn at_nodes(&self, grid: &Grid) -> Result<Vec<SurfacePoint>, InputError> {
        if let Map::Nodes { divisions, points } = &self.map {
            let [nx, ny] = grid.divisions();
            let allowed = format!("[{}, {}], as the surface was given", divisions[0], divisions[1]);
            InputError::check("divisions", format!("[{nx}, {ny}]"), *divisions == grid.divisions(), &allowed)?;
            return Ok(points.clone());
        }
        Ok((0..grid.nodes()).map(|node| self.point(grid.parameters(node))).collect())
    }

    /// The point with the given natural coordinates, unless the surface is known at nodes only.
    fn point(&self, [x, y]: [f64; 2]) -> SurfacePoint {
        let (sin_x, cos_x) = x.sin_cos();
        let (sin_y, cos_y) = y.sin_cos();
        match &self.map {
            Map::Rectangle => {
                SurfacePoint { r: [x, y, 0.0], r_x: [1.0, 0.0, 0.0], r_y: [0.0, 1.0, 0.0], r_xy: [0.0; 3] }
            }
            Map::Annulus => SurfacePoint {
                r: [x * cos_y, x * sin_y, 0.0],
                r_x: [cos_y, sin_y, 0.0],
                r_y: [-x * sin_y, x * cos_y, 0.0],
                r_xy: [-sin_y, cos_y, 0.0],
            },
            Map::Cylinder { radius } => SurfacePoint {
                r: [radius * cos_x, radius * sin_x, y],
                r_x: [-radius * sin_x, radius * cos_x, 0.0],
                r_y: [0.0, 0.0, 1.0],
                r_xy: [0.0; 3],
            },
            Map::Sphere { radius } => SurfacePoint {
                r: [radius * cos_y * cos_x, radius * cos_y * sin_x, radius * sin_y],
                r_x: [-radius * cos_y * sin_x, radius * cos_y * cos_x, 0.0],
                r_y: [-radius * sin_y * cos_x, -radius * sin_y * sin_x, radius * cos_y],
                r_xy: [radius * sin_y * sin_x, -radius * sin_y * cos_x, 0.0],
            },
            Map::Nodes { .. } => unreachable!("known at nodes only"),
        }
    }
}

fn show([from, to]: [f64; 2]) -> String {
    format!("[{from}, {to}]")
}

fn is_range([from, to]: [f64; 2]) -> bool {
    from < to && from.is_finite() && to.is_finite()
}

fn check_radius(radius: f64) -> Result<(), InputError> {
    InputError::check("radius", radius, radius > 0.0 && radius.is_finite(), "a positive number, m")
}

fn check_turn(argument: &str, range: [f64; 2]) -> Result<(), InputError> {
    let valid = is_range(range) && range[1] - range[0] <= TAU + ROUNDED_ANGLE;
    InputError::check(argument, show(range), valid, "two increasing numbers, at most 2 pi apart, rad")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curved() -> [Surface; 3] {
        [
            Surface::annulus([0.5, 2.0], 4.0).unwrap(),
            Surface::cylinder(2.5, [-1.0, 2.0], [-3.0, 1.0]).unwrap(),
            Surface::sphere(1.5, [-1.0, 2.0], [-1.2, 1.0]).unwrap(),
        ]
    }

    /// Each derivative agrees with the difference quotient of the position (of `r_x` for the mixed one).
    #[test]
    fn derivatives_are_those_of_the_position() {
        let d = 1e-6;
        for surface in curved() {
            let [x, y] = [0.7, 0.6];
            let point = surface.point([x, y]);
            let along = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| (b[i] - a[i]) / (2.0 * d));
            let (left, right) = (surface.point([x - d, y]), surface.point([x + d, y]));
            let (below, above) = (surface.point([x, y - d]), surface.point([x, y + d]));
            for (exact, quotient) in [
                (point.r_x, along(left.r, right.r)),
                (point.r_y, along(below.r, above.r)),
                (point.r_xy, along(below.r_x, above.r_x)),
            ] {
                for i in 0..3 {
                    assert!((exact[i] - quotient[i]).abs() < 1e-9, "{surface:?}: {exact:?} {quotient:?}");
                }
            }
        }
    }

    /// Positions and outward normals by hand.
    #[test]
    fn points_are_where_they_should_be() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let [annulus, cylinder, sphere] = curved();
        for (surface, at, r, normal) in [
            (annulus, [2.0, quarter], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]),
            (cylinder, [quarter, -1.0], [0.0, 2.5, -1.0], [0.0, 1.0, 0.0]),
            (sphere, [0.0, quarter / 3.0], [1.5 * 0.75_f64.sqrt(), 0.0, 0.75], [0.75_f64.sqrt(), 0.0, 0.5]),
        ] {
            let point = surface.point(at);
            for i in 0..3 {
                assert!((point.r[i] - r[i]).abs() < 1e-15 && (point.normal()[i] - normal[i]).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn impossible_shapes_are_refused() {
        let argument = |result: Result<Surface, InputError>| result.unwrap_err().argument;
        assert_eq!(argument(Surface::rectangle([1.0, f64::NAN])), "size.1");
        assert_eq!(argument(Surface::annulus([2.0, 1.0], 1.0)), "radii");
        assert_eq!(argument(Surface::annulus([0.0, 1.0], 1.0)), "radii");
        assert_eq!(argument(Surface::annulus([1.0, 2.0], 6.3)), "angle");
        assert_eq!(argument(Surface::cylinder(0.0, [0.0, 1.0], [0.0, 1.0])), "radius");
        assert_eq!(argument(Surface::cylinder(1.0, [-4.0, 4.0], [0.0, 1.0])), "angle");
        assert_eq!(argument(Surface::cylinder(1.0, [0.0, 1.0], [0.0, 0.0])), "length");
        assert_eq!(argument(Surface::sphere(1.0, [1.0, 0.0], [0.0, 1.0])), "longitude");
        assert_eq!(argument(Surface::sphere(1.0, [0.0, 1.0], [0.0, FRAC_PI_2])), "latitude");
        assert!(Surface::annulus([1.0, 2.0], TAU + 1e-10).is_ok());
    }

    #[test]
    fn surfaces_from_nodes_are_checked() {
        let domain = [[0.0, 1.0], [0.0, 2.0]];
        let grid = Grid::new(domain, [2, 3]).unwrap();
        let rectangle = Surface::rectangle([1.0, 2.0]).unwrap();
        let points = rectangle.at_nodes(&grid).unwrap();
        let surface = Surface::from_nodes(domain, [2, 3], points.clone()).unwrap();
        assert_eq!(surface.at_nodes(&grid).unwrap(), points);
        assert_eq!(surface.at_nodes(&Grid::new(domain, [3, 2]).unwrap()).unwrap_err().argument, "divisions");
        assert_eq!(Surface::from_nodes(domain, [3, 3], points.clone()).unwrap_err().argument, "points");
        assert_eq!(Surface::from_nodes([[1.0, 1.0]; 2], [2, 3], points.clone()).unwrap_err().argument, "domain.0");
        let mut parallel = points;
        parallel[7].r_x = parallel[7].r_y;
        assert_eq!(Surface::from_nodes(domain, [2, 3], parallel).unwrap_err().argument, "points.7");
    }
}
