//! What a material is and does.

use glam::DVec3;

use super::{Densities, Event, Interface, Lanes, NUMBERS, SPECTRA, Transport, Variates, Vec3};
use crate::declare::Declaration;

/// How a surface scatters light.
///
/// wo and wi are unit vectors away from the surface, wo towards where the path comes from. What is
/// said of lanes outside of [`Interface::lanes`] means nothing.
pub trait Material {
    /// Its keys in scene files; the values come in their order.
    const DECLARATION: Declaration;
    /// What `info` calls an object of it.
    const WORDS: &'static str;
    /// What `info` calls its branch of the loop, where it has one.
    const BRANCH: Option<&'static str> = None;
    /// The material whose spectra it chooses by the place, and that scatters in its stead.
    const TEXTURE_OF: Option<MaterialKind> = None;
    /// It has a delta part: directions that light sampling cannot find.
    const DELTA: bool = false;
    /// It has a part that is spread over directions, for which lights are sampled.
    const SPREAD: bool = false;
    /// It is Lambertian reflection by its first spectrum and nothing else: bsdf · cos/pdf is then
    /// the albedo, so that the loop need not evaluate it.
    const LAMBERTIAN: bool = false;
    /// Light passes through it; its first two spectra are n and k of what is inside.
    const REFRACTS: bool = false;
    /// Its events depend on [`Variates::choice`].
    const CHOOSES: bool = false;
    /// Its answers depend on [`Interface::numbers`].
    const NUMBERED: bool = false;

    /// Its numbers as lanes read them, from the parameters of scene files and the size of the object
    /// over its canonical shape.
    fn numbers(numbers: &[f64], _size: DVec3) -> [f64; NUMBERS] {
        let mut all = [0.0; NUMBERS];
        for (place, number) in all.iter_mut().zip(numbers) {
            *place = *number;
        }
        all
    }

    /// The spectra at a place in canonical coordinates.
    #[inline(always)]
    fn texture<L: Lanes>(
        _l: L,
        _numbers: [L::Real; NUMBERS],
        _local: Vec3<L::Real>,
        spectra: [L::Int; SPECTRA],
    ) -> [L::Int; SPECTRA] {
        spectra
    }

    /// Where the path goes on. `weigh` is called with each lane and its weights, one a wavelength:
    /// bsdf · |cos|/pdf, or what a delta event leaves of the light over its probability. Without a
    /// definition of its own, a material lets nothing go on.
    #[inline(always)]
    fn sample<L: Lanes, const C: usize>(
        l: L,
        _at: &Interface<'_, L, C>,
        wo: Vec3<L::Real>,
        _transport: Transport,
        _u: Variates<L>,
        _weigh: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Event<L> {
        Event {
            pdf: l.real(0.0),
            reverse: l.real(0.0),
            ..Event::reflection(l, wo)
        }
    }

    /// The part that is not delta, from wo to wi. `value` is called with each lane and the bsdf, sr⁻¹,
    /// without the cosine.
    #[inline(always)]
    fn evaluate<L: Lanes, const C: usize>(
        l: L,
        _at: &Interface<'_, L, C>,
        _directions: [Vec3<L::Real>; 2],
        _transport: Transport,
        _value: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Densities<L> {
        let zero = l.real(0.0);
        Densities {
            pdf: zero,
            reverse: zero,
        }
    }

    /// Does a job for this type.
    fn run<J: MaterialJob>(job: J) -> J::Output
    where
        Self: Sized,
    {
        job.run::<Self>()
    }
}

/// Something to do for the type of a material.
pub trait MaterialJob {
    type Output;
    fn run<M: Material>(self) -> Self::Output;
}

macro_rules! define {
    ($($(#[$attribute:meta])? $kind:ident in $module:ident,)*) => {
        kinds! {
            MaterialKind of Material {
                $($(#[$attribute])? $kind in $module,)*
            }
            fn declaration(self) -> Declaration = DECLARATION;
            fn words(self) -> &'static str = WORDS;
            fn branch(self) -> Option<&'static str> = BRANCH;
            fn texture_of(self) -> Option<Self> = TEXTURE_OF;
            fn is_delta(self) -> bool = DELTA;
            fn is_spread(self) -> bool = SPREAD;
            fn refracts(self) -> bool = REFRACTS;
        }

        $(
            $(#[$attribute])?
            const _: () = assert!(
                <super::$module::$kind as Material>::DECLARATION.spectra() <= SPECTRA
            );
        )*

        /// Does something for each material that scatters by itself; its type and its kind are called
        /// `$material` and `$own`.
        macro_rules! each_material {
            ($material:ident, $own:ident => $do:expr) => {
                $($(#[$attribute])? {
                    type $material = $crate::material::$module::$kind;
                    const $own: $crate::material::MaterialKind =
                        $crate::material::MaterialKind::$kind;
                    if <$material as $crate::material::Material>::TEXTURE_OF.is_none() {
                        $do
                    }
                })*
            };
        }
        pub(crate) use each_material;
    };
}

materials!(define);

impl MaterialKind {
    /// [`Material::run`].
    pub fn run<J: MaterialJob>(self, job: J) -> J::Output {
        of!(self, run(job))
    }

    /// [`Material::numbers`].
    pub fn numbers(self, numbers: &[f64], size: DVec3) -> [f64; NUMBERS] {
        of!(self, numbers(numbers, size))
    }

    /// [`Material::texture`].
    #[inline(always)]
    pub fn texture<L: Lanes>(
        self,
        l: L,
        numbers: [L::Real; NUMBERS],
        local: Vec3<L::Real>,
        spectra: [L::Int; SPECTRA],
    ) -> [L::Int; SPECTRA] {
        of!(self, texture(l, numbers, local, spectra))
    }
}

/// A set of materials.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MaterialKinds(u32);

impl MaterialKinds {
    /// Whether a material is in the set.
    #[inline(always)]
    pub fn contains(self, kind: MaterialKind) -> bool {
        self.0 >> kind as u32 & 1 == 1
    }
}

impl FromIterator<MaterialKind> for MaterialKinds {
    fn from_iter<I: IntoIterator<Item = MaterialKind>>(kinds: I) -> Self {
        let bits = kinds.into_iter().map(|kind| 1 << kind as u32);
        Self(bits.fold(0, |all, bit| all | bit))
    }
}
