//! Reflectance.

use crate::columns::columns;

columns! {
    /// Cosine of the refracted ray and reflectance, of the cosine of incidence and the ratio of
    /// indices.
    dielectric(l, [cosine, eta]: 2) -> 2 {
        let (transmitted, reflectance) = etalon_lanes::material::fresnel::dielectric(l, cosine, eta);
        [transmitted, reflectance]
    }
}
