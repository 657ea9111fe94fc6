//! A mirror whose reflectance is the same at all angles, on both sides: no real one is, but its
//! pictures are known in closed form.

use super::interface::unit_again;
use super::{Event, Interface, Lanes, Material, Transport, Variates, Vec3};
use crate::declare::{Declaration, Quantity, Role};
use crate::math::lanes::Mask;
use crate::math::packet::each;

/// Reflects the same share of the light at all angles.
pub struct Mirror;

impl Material for Mirror {
    const DECLARATION: Declaration = Declaration {
        within: Some("ideal"),
        ..Declaration::new(
            "mirror",
            "reflectance",
            Quantity::Spectrum(Role::Reflectance),
        )
    };
    const WORDS: &'static str = "ideal mirror";
    const BRANCH: Option<&'static str> = Some("ideal mirrors");
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
        let (_, mirrored) = at.mirrored(l, wo);
        let reflectance = at.wavelengths.rows(l, at.spectra[0]);
        for i in each(at.lanes.bits()) {
            weigh(i, at.values(i, &reflectance));
        }
        Event::reflection(l, unit_again(l, mirrored))
    }
}
