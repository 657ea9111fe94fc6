//! Elementary functions, vectors and reflectance.

use etalon_lanes::material::fresnel;
use etalon_lanes::math::functions::{atan2_turns, ln, sin_cos_turns};
use etalon_lanes::math::lanes::Real;
use etalon_lanes::math::vec3::Vec3;

use crate::columns::columns;

columns! {
    /// sin 2πu and cos 2πu.
    sine_and_cosine(l, [u]: 1) -> 2 {
        let (sine, cosine) = sin_cos_turns(l, u);
        [sine, cosine]
    }

    logarithm(l, [x]: 1) -> 1 {
        [ln(l, x)]
    }

    /// The angle of (x, y), in turns; y is given first.
    angle(l, [y, x]: 2) -> 1 {
        [atan2_turns(l, y, x)]
    }

    /// The unit vector n of a vector, its tangents s and t, and s × t.
    frame(l, [x, y, z]: 3) -> 12 {
        let n = Vec3::new(x, y, z).normalized(l);
        let (s, t) = n.frame(l);
        let across = s.cross(t);
        [n.x, n.y, n.z, s.x, s.y, s.z, t.x, t.y, t.z, across.x, across.y, across.z]
    }

    /// The smaller and the larger of a and b, a rounded down and to nearest, a with the sign of b,
    /// a < b, a ≤ b and a = b as 0 or 1, and a · b + a.
    operations(l, [a, b]: 2) -> 9 {
        let truth = |m| l.select(m, l.real(1.0), l.real(0.0));
        [
            a.min(b),
            a.max(b),
            a.floor(),
            a.round(),
            a.copysign(b),
            truth(a.lt(b)),
            truth(a.le(b)),
            truth(a.same(b)),
            a.mul_add(b, a),
        ]
    }

    /// Cosine of the refracted ray and reflectance, of the cosine of incidence and the ratio of
    /// indices.
    dielectric(l, [cosine, eta]: 2) -> 2 {
        let (transmitted, reflectance) = fresnel::dielectric(l, cosine, eta);
        [transmitted, reflectance]
    }
}
