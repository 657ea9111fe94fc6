//! A smooth boundary between two dielectrics.

use super::interface::unit_again;
use super::{Event, Interface, Lanes, Material, Transport, Variates, Vec3, fresnel};
use crate::declare::{Declaration, Quantity};
use crate::math::lanes::{Mask, Real, Scalar, WIDEST};
use crate::math::packet::{array, each};

/// Reflects or refracts by [`fresnel::dielectric`], chosen by the mean reflectance over the
/// wavelengths still carried; refraction that disperses ends all but the hero.
pub struct Glass;

impl Material for Glass {
    const DECLARATION: Declaration = Declaration::new("glass", "index inside", Quantity::Glass);
    const WORDS: &'static str = "glass";
    const BRANCH: Option<&'static str> = Some("glass");
    const DELTA: bool = true;
    const REFRACTS: bool = true;
    const CHOOSES: bool = true;

    #[inline(always)]
    fn sample<L: Lanes, const C: usize>(
        l: L,
        at: &Interface<'_, L, C>,
        wo: Vec3<L::Real>,
        transport: Transport,
        u: Variates<L>,
        mut weigh: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Event<L> {
        let (cosine, mirrored) = at.mirrored(l, wo);
        let disperses = at.disperses & !at.wavelengths.ended;
        let (spreads, front) = (disperses.bits(), at.front.bits());
        let (outside, inside) = (at.index_rows(l, at.outside), at.index_rows(l, at.inside));
        let (cosines, variates) = (array(l, cosine), array(l, u.choice));
        let mut etas = [L::Scalar::from_f64(1.0); WIDEST];
        let (mut pdfs, mut reverses) = (etas, etas);
        let mut refracts = 0;
        for i in each(at.lanes.bits()) {
            let hero = at.wavelengths.hero(i);
            let entering = front >> i & 1 == 1;
            let eta = relative(at.index(i, &outside), at.index(i, &inside), entering);
            etas[i] = eta[hero];
            let choice = Choice {
                cosine: cosines[i],
                eta,
                hero,
                disperses: spreads >> i & 1 == 1,
            };
            let (chosen, factors) = choice.made(variates[i], transport);
            refracts |= u32::from(chosen.refracts) << i;
            (pdfs[i], reverses[i]) = (chosen.probability, chosen.reverse);
            weigh(i, &factors);
        }
        let refracts = l.mask_from_bits(refracts);
        let eta = l.load(&etas);
        let (transmitted, _) = fresnel::dielectric(l, cosine, eta);
        let inverse = l.real(1.0) / eta;
        let refracted = (-wo)
            .scale(inverse)
            .along(at.shading, inverse.mul_add(cosine, -transmitted));
        let direction = Vec3::select(l, refracts, refracted, mirrored);
        Event {
            pdf: l.load(&pdfs),
            reverse: l.load(&reverses),
            transmitted: refracts,
            ends: refracts & disperses,
            ..Event::reflection(l, unit_again(l, direction))
        }
    }
}

/// n on the far side over n on the near one, at each wavelength.
#[inline(always)]
fn relative<T: Scalar, const C: usize>(outside: [T; C], inside: [T; C], entering: bool) -> [T; C] {
    let mut eta = inside;
    for c in 0..C {
        eta[c] = if entering {
            inside[c] / outside[c]
        } else {
            outside[c] / inside[c]
        };
    }
    eta
}

/// What a path chooses by: reflection or refraction.
struct Choice<T, const C: usize> {
    cosine: T,
    eta: [T; C],
    hero: usize,
    /// Refraction parts its wavelengths.
    disperses: bool,
}

/// What a path has chosen.
struct Chosen<T> {
    refracts: bool,
    probability: T,
    /// With which probability the way back would be chosen, by those wavelengths that go on.
    reverse: T,
}

impl<T: Scalar, const C: usize> Choice<T, C> {
    /// Chooses by a number in [0, 1): what, and the weight of each wavelength.
    #[inline(always)]
    fn made(&self, variate: T, transport: Transport) -> (Chosen<T>, [T; C]) {
        let one = T::from_f64(1.0);
        let hero = self.hero;
        let (mean, mut factors) = self.reflectances();
        let mut chosen = Chosen {
            refracts: false,
            probability: mean,
            reverse: mean,
        };
        if variate < mean {
            for factor in &mut factors {
                *factor = *factor / mean;
            }
            return (chosen, factors);
        }
        chosen = Chosen {
            refracts: true,
            probability: one - mean,
            reverse: one - factors[hero],
        };
        // Radiance changes by 1/η² (Veach 1997, section 5.2), importance does not.
        let scale = match transport {
            Transport::Radiance => one / ((one - mean) * self.eta[hero] * self.eta[hero]),
            Transport::Importance => one / (one - mean),
        };
        for factor in &mut factors {
            *factor = (one - *factor) * scale;
        }
        if self.disperses {
            // Secondary pdfs become 0, the hero's is divided by C.
            let carried = factors[hero] * T::from_f64(C as f64);
            factors = [T::default(); C];
            factors[hero] = carried;
        }
        (chosen, factors)
    }

    /// The mean reflectance and that of each wavelength, where they part; else all have the hero's.
    #[inline(always)]
    fn reflectances(&self) -> (T, [T; C]) {
        let own = fresnel::dielectric_reflectance(self.cosine, self.eta[self.hero]);
        let mut reflectances = [own; C];
        if !self.disperses {
            return (own, reflectances);
        }
        let mut sum = T::default();
        for (reflectance, eta) in reflectances.iter_mut().zip(self.eta) {
            *reflectance = fresnel::dielectric_reflectance(self.cosine, eta);
            sum = sum + *reflectance;
        }
        (sum * T::from_f64(1.0 / C as f64), reflectances)
    }
}
