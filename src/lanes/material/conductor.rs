//! A smooth metal, on both sides.

use super::interface::unit_again;
use super::{Event, Interface, Lanes, Material, Transport, Variates, Vec3, fresnel};
use crate::declare::{Declaration, Quantity};
use crate::math::lanes::Mask;
use crate::math::packet::{array, each};
use crate::planted::unpolarised;

/// Reflects by [`fresnel::conductor_polarised`].
pub struct Conductor;

impl Material for Conductor {
    const DECLARATION: Declaration = Declaration::new("mirror", "metal", Quantity::Metal);
    const WORDS: &'static str = "metal";
    const BRANCH: Option<&'static str> = Some("metals");
    const DELTA: bool = true;

    #[inline(always)]
    fn sample<L: Lanes, const C: usize>(
        l: L,
        at: &Interface<'_, L, C>,
        wo: Vec3<L::Real>,
        _: Transport,
        _: Variates<L>,
        mut weigh: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Event<L> {
        let (cosine, mirrored) = at.mirrored(l, wo);
        let indices = at.wavelengths.rows(l, at.spectra[0]);
        let extinctions = at.wavelengths.rows(l, at.spectra[1]);
        let outside = at.index_rows(l, at.outside);
        let cosines = array(l, cosine);
        for i in each(at.lanes.bits()) {
            let (n, k) = (at.values(i, &indices), at.values(i, &extinctions));
            let around = at.index(i, &outside);
            let mut reflectance = *n;
            for c in 0..C {
                let (n, k) = (n[c] / around[c], k[c] / around[c]);
                let polarised = fresnel::conductor_polarised(cosines[i], n, k);
                reflectance[c] = unpolarised(at.planted, polarised);
            }
            weigh(i, &reflectance);
        }
        Event::reflection(l, unit_again(l, mirrored))
    }
}
