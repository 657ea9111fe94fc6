//! A surface that does everything at once, to test the contract by and for no picture: Lambertian
//! reflection, a modified Phong lobe (E. P. Lafortune and Y. D. Willems, "Using the modified Phong
//! reflectance model for physically based rendering", Report CW 197, KU Leuven 1994) and a mirror.
//! The loop has it only with the feature `planted`.

use std::f64::consts::{FRAC_1_PI, TAU};

use super::interface::unit_again;
use super::{Densities, Event, Interface, Lanes, Material, Transport, Variates, Vec3, diffuse};
use crate::declare::{Declaration, Parameter, Quantity, Range, Role, Usual};
use crate::math::functions::sin_cos_turns;
use crate::math::lanes::{Mask, Real, Scalar};
use crate::math::packet::{array, each};
use crate::sample::warp::cosine_hemisphere_pdf;

/// bsdf = diffuse/π + lobe (n + 2)/2π cosⁿ α, where α is the angle between wi and the mirrored wo;
/// and a share of the light that goes exactly there.
pub struct Phong;

/// Most halvings k, so that n is less than 2⁸.
const HALVINGS: u32 = 8;

struct Numbers<L: Lanes> {
    /// n + 1 = 2ᵏ, so that square roots and products are enough.
    k: L::Real,
    /// The share of the light that is mirrored, and the probability of that.
    mirror: L::Real,
    /// Of the rest, the probability of the lobe.
    lobe: L::Real,
}

/// The part that is not delta, for a pair of directions.
struct Spread<L: Lanes> {
    /// wi is on the side of wo.
    above: L::Mask,
    /// Cosine of wi.
    cosine: L::Real,
    /// (n + 2)/2π cosⁿ α.
    lobe: L::Real,
    densities: Densities<L>,
}

impl Material for Phong {
    const DECLARATION: Declaration = Declaration::new(
        "phong",
        "diffuse and lobe reflectance",
        Quantity::TwoSpectra(Role::Reflectance),
    )
    .beside(&[
        number("halvings", "k, where the exponent is 2^k - 1", 8.0, 3.0),
        number("mirror_share", "share of the light mirrored", 1.0, 0.0),
        number("lobe_share", "how often the lobe is chosen", 1.0, 0.5),
    ]);
    const WORDS: &'static str = "Phong";
    const BRANCH: Option<&'static str> = Some("Phong lobes");
    const DELTA: bool = true;
    const SPREAD: bool = true;
    const CHOOSES: bool = true;
    const NUMBERED: bool = true;

    #[inline(always)]
    fn sample<L: Lanes, const C: usize>(
        l: L,
        at: &Interface<'_, L, C>,
        wo: Vec3<L::Real>,
        _: Transport,
        u: Variates<L>,
        mut weigh: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Event<L> {
        let one = l.real(1.0);
        let numbers = Numbers::<L>::of(at);
        let (_, mirrored) = at.mirrored(l, wo);
        let mirror = u.choice.lt(numbers.mirror);
        let bound = (one - numbers.mirror).mul_add(numbers.lobe, numbers.mirror);
        let lobe = u.choice.lt(bound) & !mirror;
        let about_mirrored = numbers.direction(l, mirrored, u.direction);
        let about_normal = diffuse::reflected(l, at.shading, wo, u.direction).direction;
        let direction = Vec3::select(l, lobe, about_mirrored, about_normal);
        let direction = Vec3::select(l, mirror, unit_again(l, mirrored), direction);
        let spread = Spread::new(l, at, &numbers, [wo, direction]);
        let (mirrors, cosines) = (mirror.bits(), array(l, spread.cosine));
        let pdfs = array(l, spread.densities.pdf);
        spread.values(l, at, |i, value| {
            let scale = cosines[i] / pdfs[i];
            let weight = if mirrors >> i & 1 == 1 {
                [L::Scalar::from_f64(1.0); C]
            } else {
                value.map(|value| value * scale)
            };
            weigh(i, &weight);
        });
        let Densities { pdf, reverse } = spread.densities;
        Event {
            pdf: l.select(mirror, numbers.mirror, pdf),
            reverse: l.select(mirror, numbers.mirror, reverse),
            delta: mirror,
            ..Event::reflection(l, direction)
        }
    }

    #[inline(always)]
    fn evaluate<L: Lanes, const C: usize>(
        l: L,
        at: &Interface<'_, L, C>,
        directions: [Vec3<L::Real>; 2],
        _: Transport,
        value: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Densities<L> {
        let spread = Spread::new(l, at, &Numbers::of(at), directions);
        spread.values(l, at, value);
        spread.densities
    }
}

const fn number(key: &'static str, what: &'static str, most: f64, default: f64) -> Parameter {
    Parameter::new(key, what, Quantity::number("", Range::between(0.0, most)))
        .usually(Usual::Number(default))
}

impl<L: Lanes> Numbers<L> {
    #[inline(always)]
    fn of<const C: usize>(at: &Interface<'_, L, C>) -> Self {
        let [k, mirror, lobe] = at.numbers;
        Self {
            k: k.round(),
            mirror,
            lobe,
        }
    }

    /// A direction of the lobe, of density (n + 1)/2π cosⁿ α: cos α = u^(1/(n + 1)).
    #[inline(always)]
    fn direction(&self, l: L, axis: Vec3<L::Real>, [u, v]: [L::Real; 2]) -> Vec3<L::Real> {
        let one = l.real(1.0);
        // Not 0, whose density would be 0.
        let mut cosine = one - u;
        for j in 0..HALVINGS {
            let further = l.real(j.into()).lt(self.k);
            cosine = l.select(further, cosine.sqrt(), cosine);
        }
        let sine = (-cosine).mul_add(cosine, one).max(l.real(0.0)).sqrt();
        let (sine_of_turn, cosine_of_turn) = sin_cos_turns(l, v);
        let (s, t) = axis.frame(l);
        axis.scale(cosine)
            .along(s, sine * cosine_of_turn)
            .along(t, sine * sine_of_turn)
    }
}

impl<L: Lanes> Spread<L> {
    #[inline(always)]
    fn new<const C: usize>(
        l: L,
        at: &Interface<'_, L, C>,
        numbers: &Numbers<L>,
        [wo, wi]: [Vec3<L::Real>; 2],
    ) -> Self {
        let (zero, one) = (l.real(0.0), l.real(1.0));
        let (cosine_out, mirrored) = at.mirrored(l, wo);
        let cosine = wi.dot(at.shading);
        let (mut power, mut square) = (one, mirrored.dot(wi).max(zero));
        for j in 0..HALVINGS {
            let further = l.real(j.into()).lt(numbers.k);
            power = l.select(further, power * square, power);
            square = square * square;
        }
        let power = power * l.real(1.0 / TAU);
        let n_and_one = l.power_of_two(numbers.k);
        let lobe_pdf = n_and_one * power;
        let above = cosine.gt(zero);
        let spread = one - numbers.mirror;
        let density = |cosine| {
            let other = (one - numbers.lobe) * cosine_hemisphere_pdf(l, cosine);
            spread * numbers.lobe.mul_add(lobe_pdf, other)
        };
        Self {
            above,
            cosine,
            lobe: (n_and_one + one) * power,
            densities: Densities {
                // A lobe reaches below the surface, where it is chosen in vain.
                pdf: density(cosine.max(zero)),
                reverse: l.select(above, density(cosine_out), zero),
            },
        }
    }

    /// Calls `value` with each lane and its bsdf.
    #[inline(always)]
    fn values<const C: usize>(
        &self,
        l: L,
        at: &Interface<'_, L, C>,
        mut value: impl FnMut(usize, &[L::Scalar; C]),
    ) {
        let [diffuse, lobe] = at.spectra.map(|spectrum| at.wavelengths.rows(l, spectrum));
        let (above, shapes) = (self.above.bits(), array(l, self.lobe));
        for i in each(at.lanes.bits()) {
            let mut bsdf = [L::Scalar::default(); C];
            if above >> i & 1 == 1 {
                let (diffuse, lobe) = (at.values(i, &diffuse), at.values(i, &lobe));
                for (c, bsdf) in bsdf.iter_mut().enumerate() {
                    let even = diffuse[c] * L::Scalar::from_f64(FRAC_1_PI);
                    *bsdf = lobe[c].fused(shapes[i], even);
                }
            }
            value(i, &bsdf);
        }
    }
}
