//! Shapes of obstacles: how far a point is from one, in which direction, and how the surface bends there.

use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query::PointQueryWithLocation;
use parry3d::shape::{Cuboid, Segment, SegmentPointLocation, Triangle, TrianglePointLocation};

/// A shape at rest.
#[derive(Debug, Clone)]
pub enum Shape {
    /// All with normal · x < offset is solid.
    Plane {
        /// A unit vector.
        normal: [f64; 3],
        /// m.
        offset: f64,
    },
    /// All within a radius of a core is solid.
    Round { core: Core, radius: f64 },
    /// A box.
    Block { half: Cuboid, pose: Pose },
    /// A surface without an inside.
    Triangle(Triangle),
}

/// What a round shape is around.
#[derive(Debug, Clone)]
pub enum Core {
    Point(Vector),
    Segment(Segment),
}

/// The place of a shape that is nearest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// The distance of the point from the surface, m; negative inside.
    pub distance: f64,
    /// From the shape to the point, a unit vector.
    pub normal: [f64; 3],
    /// How the surfaces at a distance from the shape bend.
    pub bend: Bend,
}

/// How surfaces at a constant distance from a shape bend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bend {
    /// They are flat.
    Flat,
    /// They are cylinders about a line in this direction, of this radius in metres.
    Line([f64; 3], f64),
    /// They are spheres of this radius in metres.
    Point(f64),
}

impl Bend {
    /// The largest curvature, 1/m; 0 of what is flat.
    pub fn curvature(&self) -> f64 {
        match *self {
            Self::Flat => 0.0,
            Self::Line(_, radius) | Self::Point(radius) => 1.0 / radius,
        }
    }

    /// The normal acceleration, m/s², of a motion at velocity `u`, m/s, along such a surface with this normal: -u²/r on a
    /// sphere.
    pub fn turning(&self, normal: [f64; 3], u: [f64; 3]) -> f64 {
        let (n, u) = (Vector::from(normal), Vector::from(u));
        let across = u - n * n.dot(u);
        match *self {
            Self::Flat => 0.0,
            Self::Line(along, radius) => {
                let along = Vector::from(along);
                -(across - along * along.dot(across)).length_squared() / radius
            }
            Self::Point(radius) => -across.length_squared() / radius,
        }
    }
}

impl Shape {
    /// The word for it in a scene.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Plane { .. } => "plane",
            Self::Round { core, .. } => match core {
                Core::Point(_) => "ball",
                Core::Segment(_) => "capsule",
            },
            Self::Block { .. } => "box",
            Self::Triangle(_) => "mesh",
        }
    }

    /// A box of these half extents about a centre, m, turned by a rotation vector, rad.
    pub fn block(center: [f64; 3], half: [f64; 3], rotation: [f64; 3]) -> Self {
        let rotation = Rotation::from_scaled_axis(Vector::from(rotation));
        Self::Block {
            half: Cuboid::new(Vector::from(half)),
            pose: Pose::from_parts(Vector::from(center), rotation),
        }
    }

    /// The directions of a box's sides under a rotation: an axis of the length of the angle, rad.
    pub fn sides(rotation: [f64; 3]) -> [[f64; 3]; 3] {
        let rotation = Rotation::from_scaled_axis(Vector::from(rotation));
        [Vector::X, Vector::Y, Vector::Z].map(|side| (rotation * side).into())
    }

    /// A triangle between three corners, m.
    pub fn triangle(corners: [[f64; 3]; 3]) -> Self {
        let [a, b, c] = corners.map(Vector::from);
        Self::Triangle(Triangle::new(a, b, c))
    }

    /// The box around it; None of a plane, which has none.
    pub fn bounds(&self) -> Option<Aabb> {
        Some(match self {
            Self::Plane { .. } => return None,
            Self::Round { core, radius } => {
                let ends = match core {
                    Core::Point(center) => [*center; 2],
                    Core::Segment(segment) => [segment.a, segment.b],
                };
                Aabb::from_points(ends).loosened(*radius)
            }
            Self::Block { half, pose } => half.aabb(pose),
            Self::Triangle(triangle) => triangle.local_aabb(),
        })
    }

    /// The place that is nearest to a point.
    pub fn nearest(&self, at: [f64; 3]) -> Nearest {
        let at = Vector::from(at);
        match self {
            Self::Plane { normal, offset } => Nearest {
                distance: Vector::from(*normal).dot(at) - offset,
                normal: *normal,
                bend: Bend::Flat,
            },
            Self::Round { core, radius } => {
                let (on, along) = match core {
                    Core::Point(center) => (*center, None),
                    Core::Segment(segment) => {
                        let (on, place) = segment.project_local_point_and_get_location(at, false);
                        let inside = matches!(place, SegmentPointLocation::OnEdge(_));
                        (on.point, inside.then(|| segment.b - segment.a))
                    }
                };
                let beside = along.map_or(Vector::X, |along| along.any_orthogonal_vector());
                around(at - on, along, beside, *radius)
            }
            Self::Block { half, pose } => {
                let local = pose.inverse_transform_point(at);
                let found = beside_box(half.half_extents, local);
                let out = |v: [f64; 3]| (pose.rotation * Vector::from(v)).into();
                Nearest {
                    normal: out(found.normal),
                    bend: match found.bend {
                        Bend::Line(along, radius) => Bend::Line(out(along), radius),
                        bend => bend,
                    },
                    ..found
                }
            }
            Self::Triangle(triangle) => {
                let (on, place) = triangle.project_local_point_and_get_location(at, false);
                let [a, b, c] = [triangle.a, triangle.b, triangle.c];
                let face = (b - a).cross(c - a).normalize_or(Vector::Z);
                let along = match place {
                    TrianglePointLocation::OnEdge(0, _) => Some(b - a),
                    TrianglePointLocation::OnEdge(1, _) => Some(c - b),
                    TrianglePointLocation::OnEdge(..) => Some(a - c),
                    TrianglePointLocation::OnVertex(_) => None,
                    _ => {
                        let away = at - on.point;
                        let side = if face.dot(away) < 0.0 { -face } else { face };
                        return Nearest {
                            distance: side.dot(away),
                            normal: side.into(),
                            bend: Bend::Flat,
                        };
                    }
                };
                around(at - on.point, along, face, 0.0)
            }
        }
    }
}

/// Beside a line, or a point where there is none, which is `away` from it; `beside` stands for a direction where it is in
/// the line.
fn around(away: Vector, along: Option<Vector>, beside: Vector, radius: f64) -> Nearest {
    let distance = away.length();
    let normal = away
        .try_normalize()
        .unwrap_or_else(|| beside.normalize_or(Vector::Z));
    Nearest {
        distance: distance - radius,
        normal: normal.into(),
        bend: match along.and_then(Vector::try_normalize) {
            Some(along) => Bend::Line(along.into(), distance),
            None => Bend::Point(distance),
        },
    }
}

/// Beside, on or in a box about the origin.
fn beside_box(half: Vector, at: Vector) -> Nearest {
    let on = at.clamp(-half, half);
    let away = at - on;
    let outside: Vec<usize> = (0..3).filter(|axis| away[*axis] != 0.0).collect();
    match outside[..] {
        [] => {
            // Out by the nearest side.
            let depth = half - at.abs();
            let least = |best, axis| {
                if depth[axis] < depth[best] {
                    axis
                } else {
                    best
                }
            };
            let axis = (0..3).fold(0, least);
            let mut normal = [0.0; 3];
            normal[axis] = 1.0_f64.copysign(at[axis]);
            Nearest {
                distance: -depth[axis],
                normal,
                bend: Bend::Flat,
            }
        }
        [axis] => {
            let mut normal = [0.0; 3];
            normal[axis] = 1.0_f64.copysign(away[axis]);
            Nearest {
                distance: away[axis].abs(),
                normal,
                bend: Bend::Flat,
            }
        }
        [one, other] => {
            let mut along = Vector::ZERO;
            along[3 - one - other] = 1.0;
            around(away, Some(along), Vector::X, 0.0)
        }
        _ => around(away, None, Vector::X, 0.0),
    }
}
