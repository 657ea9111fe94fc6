//! Materials asked one question after the other, in lone lanes of either precision.

use glam::DVec3;

use etalon_lanes::integrate::direct;
use etalon_lanes::light::Towards;
use etalon_lanes::material::diffuse::Diffuse;
use etalon_lanes::material::phong::Phong;
use etalon_lanes::material::{
    Densities, Event, Interface, Material, MaterialJob, MaterialKind, Medium, Transport, Variates,
    Wavelengths,
};
use etalon_lanes::math::instructions::Precision;
use etalon_lanes::math::lanes::{Lanes, Mask, Scalar, WIDEST};
use etalon_lanes::math::vec3::Vec3;

pub const C: usize = 4;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// A material of the list.
    Listed(MaterialKind),
    /// [`Phong`], with which the tests are tested.
    Phong,
}

/// A point of a surface, and how a path comes there.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    pub precision: Precision,
    pub transport: Transport,
    /// Unit normal on the side of wo.
    pub normal: DVec3,
    /// That is the outward side.
    pub front: bool,
    /// Unit direction towards where the path comes from.
    pub wo: DVec3,
    pub spectra: [[f64; C]; 2],
    pub numbers: [f64; 3],
    /// Refractive index on the outward side.
    pub outside: [f64; C],
    /// Refraction disperses.
    pub disperses: bool,
    /// All wavelengths but the hero have ended.
    pub ended: bool,
    /// Number of the hero among the wavelengths.
    pub hero: usize,
}

/// [`Event`] of one lane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// wi: unit direction in which the path goes on.
    pub direction: DVec3,
    /// Forward density, or probability of a delta event.
    pub pdf: f64,
    /// The same of the way back.
    pub reverse: f64,
    /// No other direction was possible.
    pub delta: bool,
    /// wi is on the other side.
    pub transmitted: bool,
    /// All wavelengths but the hero end.
    pub ends: bool,
    /// Weight at each wavelength; 0 where the material gave none.
    pub weight: [f64; C],
}

/// The part that is not delta, for a pair of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evaluation {
    /// The bsdf, sr⁻¹, at each wavelength; 0 where the material gave none.
    pub value: [f64; C],
    /// Density of wi.
    pub pdf: f64,
    /// Density of wo on the way back.
    pub reverse: f64,
}

/// Where the material's own spectra and the outside's index stand in the bank of a setting.
const ROWS: [u32; 3] = [0, 2, 4];

impl Setting {
    /// Each spectrum twice: nodes are interpolated between a row and the next.
    fn bank<T: Scalar>(&self) -> Vec<[T; C]> {
        let [first, second] = self.spectra;
        [first, first, second, second, self.outside, self.outside]
            .map(|spectrum| spectrum.map(T::from_f64))
            .to_vec()
    }

    fn asked<T: Scalar, R>(&self, ask: impl FnOnce(T::One, &Interface<'_, T::One, C>) -> R) -> R {
        let l = T::ONE;
        let [first, second, outside] = ROWS.map(|row| l.int(row));
        let bank = self.bank::<T>();
        let normal = Vec3::splat(l, self.normal);
        let interface = Interface {
            lanes: l.mask(true),
            geometric: normal,
            shading: normal,
            front: l.mask(self.front),
            outside: Medium::Index([outside, outside]),
            inside: Medium::Index([first, second]),
            disperses: l.mask(self.disperses),
            spectra: [first, second],
            numbers: self.numbers.map(|number| l.real(number)),
            wavelengths: Wavelengths {
                bank: &bank,
                row: l.int(0),
                slots: &[0; WIDEST],
                hero: &[self.hero as u32],
                fraction: &[T::from_f64(0.25)],
                ended: l.mask(self.ended),
            },
            planted: None,
        };
        ask(l, &interface)
    }

    fn sampled<T: Scalar, M: Material>(&self, u: &[[f64; 3]]) -> Vec<Sample> {
        self.asked::<T, _>(|l, at| {
            let wo = Vec3::splat(l, self.wo);
            let one = |&[choice, x, y]: &[f64; 3]| {
                let mut weight = [0.0; C];
                let variates = Variates {
                    choice: l.real(choice),
                    direction: [l.real(x), l.real(y)],
                };
                let event = M::sample(l, at, wo, self.transport, variates, |_, own| {
                    weight = own.map(Scalar::to_f64);
                });
                sample::<T>(&event, weight)
            };
            u.iter().map(one).collect()
        })
    }

    fn evaluated<T: Scalar, M: Material>(&self, wi: &[DVec3]) -> Vec<Evaluation> {
        self.asked::<T, _>(|l, at| {
            let wo = Vec3::splat(l, self.wo);
            let one = |wi: &DVec3| {
                let mut value = [0.0; C];
                let directions = [wo, Vec3::splat(l, *wi)];
                let Densities { pdf, reverse } =
                    M::evaluate(l, at, directions, self.transport, |_, own| {
                        value = own.map(Scalar::to_f64);
                    });
                Evaluation {
                    value,
                    pdf: l.lane(pdf, 0).to_f64(),
                    reverse: l.lane(reverse, 0).to_f64(),
                }
            };
            wi.iter().map(one).collect()
        })
    }
}

fn sample<T: Scalar>(event: &Event<T::One>, weight: [f64; C]) -> Sample {
    let l = T::ONE;
    let number = |x| l.lane(x, 0).to_f64();
    let truth = |m: <T::One as Lanes>::Mask| m.any();
    let Vec3 { x, y, z } = event.direction;
    Sample {
        direction: DVec3::new(number(x), number(y), number(z)),
        pdf: number(event.pdf),
        reverse: number(event.reverse),
        delta: truth(event.delta),
        transmitted: truth(event.transmitted),
        ends: truth(event.ends),
        weight,
    }
}

struct Sampled<'a>(&'a Setting, &'a [[f64; 3]]);

impl MaterialJob for Sampled<'_> {
    type Output = Vec<Sample>;

    fn run<M: Material>(self) -> Vec<Sample> {
        let Self(setting, u) = self;
        match setting.precision {
            Precision::Single => setting.sampled::<f32, M>(u),
            Precision::Double => setting.sampled::<f64, M>(u),
        }
    }
}

struct Evaluated<'a>(&'a Setting, &'a [DVec3]);

impl MaterialJob for Evaluated<'_> {
    type Output = Vec<Evaluation>;

    fn run<M: Material>(self) -> Vec<Evaluation> {
        let Self(setting, wi) = self;
        match setting.precision {
            Precision::Single => setting.evaluated::<f32, M>(wi),
            Precision::Double => setting.evaluated::<f64, M>(wi),
        }
    }
}

/// Does something for the material of a subject that scatters.
fn run<J: MaterialJob>(subject: Subject, job: J) -> J::Output {
    match subject {
        Subject::Listed(kind) => kind.texture_of().unwrap_or(kind).run(job),
        Subject::Phong => job.run::<Phong>(),
    }
}

/// [`Material::sample`] for each triple of random numbers: choice, and two for the direction.
pub fn sample_each(subject: Subject, setting: &Setting, u: &[[f64; 3]]) -> Vec<Sample> {
    run(subject, Sampled(setting, u))
}

/// [`Material::evaluate`] for each direction wi.
pub fn evaluate_each(subject: Subject, setting: &Setting, wi: &[DVec3]) -> Vec<Evaluation> {
    run(subject, Evaluated(setting, wi))
}

/// What light from wi is multiplied with on a [`Diffuse`] surface, cosine and all: as the loop has it,
/// and by [`Material::evaluate`]. The light is sampled with this density; `extended` says whether
/// scattered rays can hit it.
pub fn lambertian_and_general(
    setting: &Setting,
    wi: DVec3,
    light_pdf: f64,
    extended: bool,
) -> [[f64; C]; 2] {
    match setting.precision {
        Precision::Single => both_ways::<f32>(setting, wi, light_pdf, extended),
        Precision::Double => both_ways::<f64>(setting, wi, light_pdf, extended),
    }
}

fn both_ways<T: Scalar>(
    setting: &Setting,
    wi: DVec3,
    light_pdf: f64,
    extended: bool,
) -> [[f64; C]; 2] {
    let l = T::ONE;
    let direction = Vec3::splat(l, wi);
    let light = direct::Sampled::<T::One> {
        towards: Towards {
            direction,
            distance: l.real(1.0),
            pdf: l.real(light_pdf),
            valid: l.mask(true),
        },
        spectrum: l.int(0),
        object: l.int(0),
        extended: l.mask(extended),
    };
    setting.asked::<T, _>(|l, at| {
        let cosine = direction.dot(at.shading);
        let mut value = [T::default(); C];
        let directions = [Vec3::splat(l, setting.wo), direction];
        let densities = Diffuse::evaluate(l, at, directions, setting.transport, |_, own| {
            value = *own;
        });
        let special = l.lane(light.lambertian_weight(l, cosine), 0);
        let general = l.lane(light.weight(l, cosine, densities.pdf), 0);
        let albedo = setting.spectra[0].map(T::from_f64);
        [
            albedo.map(|albedo| (albedo * special).to_f64()),
            value.map(|value| (value * general).to_f64()),
        ]
    })
}
