//! A surface that reflects nothing; where a path meets it, it ends.

use super::{Event, Interface, Lanes, Material, Transport, Variates, Vec3};

use crate::declare::{Declaration, Quantity};

/// Nothing is reflected.
pub struct Black;

impl Material for Black {
    const DECLARATION: Declaration = Declaration::new("black", "no reflection", Quantity::True);
    const WORDS: &'static str = "black";

    #[inline(always)]
    fn sample<L: Lanes, const C: usize>(
        l: L,
        _: &Interface<'_, L, C>,
        wo: Vec3<L::Real>,
        _: Transport,
        _: Variates<L>,
        _: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Event<L> {
        Event {
            pdf: l.real(0.0),
            reverse: l.real(0.0),
            ..Event::reflection(l, wo)
        }
    }
}
