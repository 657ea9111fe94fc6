//! Lambertian reflection on both sides: albedo/π in all directions (J. H. Lambert, "Photometria",
//! 1760).

use std::f64::consts::FRAC_1_PI;

use super::{Densities, Event, Interface, Lanes, Material, Transport, Variates, Vec3};
use crate::declare::{Declaration, Quantity, Role};
use crate::math::lanes::{Mask, Real, Scalar};
use crate::math::packet::each;
use crate::sample::warp::{cosine_hemisphere, cosine_hemisphere_pdf};

/// bsdf = albedo/π.
pub struct Diffuse;

impl Material for Diffuse {
    const DECLARATION: Declaration =
        Declaration::new("diffuse", "albedo", Quantity::Spectrum(Role::Reflectance));
    const WORDS: &'static str = "diffuse";
    const BRANCH: Option<&'static str> = Some("diffuse reflection");
    const SPREAD: bool = true;
    const LAMBERTIAN: bool = true;

    #[inline(always)]
    fn sample<L: Lanes, const C: usize>(
        l: L,
        at: &Interface<'_, L, C>,
        wo: Vec3<L::Real>,
        _: Transport,
        u: Variates<L>,
        mut weigh: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Event<L> {
        let albedo = at.wavelengths.rows(l, at.spectra[0]);
        for i in each(at.lanes.bits()) {
            weigh(i, at.values(i, &albedo));
        }
        reflected(l, at.shading, wo, u.direction)
    }

    #[inline(always)]
    fn evaluate<L: Lanes, const C: usize>(
        l: L,
        at: &Interface<'_, L, C>,
        [wo, wi]: [Vec3<L::Real>; 2],
        _: Transport,
        mut value: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Densities<L> {
        let zero = l.real(0.0);
        let cosine = wi.dot(at.shading);
        let same_side = cosine.gt(zero);
        let albedo = at.wavelengths.rows(l, at.spectra[0]);
        for i in each((at.lanes & same_side).bits()) {
            let albedo = at.values(i, &albedo);
            value(
                i,
                &albedo.map(|albedo| albedo * L::Scalar::from_f64(FRAC_1_PI)),
            );
        }
        let density = |cosine| l.select(same_side, cosine_hemisphere_pdf(l, cosine), zero);
        Densities {
            pdf: density(cosine),
            reverse: density(wo.dot(at.shading)),
        }
    }
}

/// A direction about a normal, with density cos/π.
#[inline(always)]
pub fn reflected<L: Lanes>(
    l: L,
    normal: Vec3<L::Real>,
    wo: Vec3<L::Real>,
    [u, v]: [L::Real; 2],
) -> Event<L> {
    let local = cosine_hemisphere(l, u, v);
    let (s, t) = normal.frame(l);
    Event {
        direction: normal.scale(local.z).along(s, local.x).along(t, local.y),
        pdf: cosine_hemisphere_pdf(l, local.z),
        reverse: cosine_hemisphere_pdf(l, wo.dot(normal)),
        delta: l.mask(false),
        transmitted: l.mask(false),
        ends: l.mask(false),
    }
}
