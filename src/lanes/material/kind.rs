//! What a material is and does, and the list of them.

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
    /// It wants [`Variates::choice`].
    const CHOOSES: bool = false;
    /// It reads [`Interface::numbers`].
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
    /// bsdf · |cos|/pdf, or what a delta event leaves of the light over its probability.
    fn sample<L: Lanes, const C: usize>(
        l: L,
        at: &Interface<'_, L, C>,
        wo: Vec3<L::Real>,
        transport: Transport,
        u: Variates<L>,
        weigh: impl FnMut(usize, &[L::Scalar; C]),
    ) -> Event<L>;

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
}

macro_rules! materials {
    ($($(#[$attribute:meta])? $kind:ident in $module:ident,)*) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[repr(u32)]
        pub enum MaterialKind {
            $(
                $(#[$attribute])?
                #[doc = concat!("See [`", stringify!($kind), "`](super::", stringify!($module), "::", stringify!($kind), ").")]
                $kind,
            )*
        }

        impl MaterialKind {
            /// All of them, in the order in which messages list them.
            pub const ALL: &'static [Self] = &[$($(#[$attribute])? Self::$kind,)*];

            /// Their keys in scene files; some have one in common.
            pub const KEYS: &'static [&'static str] =
                &[$(
                    $(#[$attribute])?
                    <super::$module::$kind as Material>::DECLARATION.main.key,
                )*];
        }

        $(
            $(#[$attribute])?
            const _: () = assert!(
                <super::$module::$kind as Material>::DECLARATION.spectra() <= SPECTRA
            );
        )*

        /// Evaluates an item of a kind's type.
        macro_rules! of {
            ($self:expr, $item:ident) => {
                match $self {
                    $(
                        $(#[$attribute])?
                        MaterialKind::$kind => <super::$module::$kind as Material>::$item,
                    )*
                }
            };
            ($self:expr, $item:ident $item_arguments:tt) => {
                match $self {
                    $(
                        $(#[$attribute])?
                        MaterialKind::$kind => {
                            <super::$module::$kind as Material>::$item $item_arguments
                        }
                    )*
                }
            };
        }

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

        /// Evaluates an expression for the type of a kind, called `$material`.
        macro_rules! with_material {
            ($of:expr, $material:ident => $do:expr) => {
                match $of {
                    $(
                        $(#[$attribute])?
                        $crate::material::MaterialKind::$kind => {
                            type $material = $crate::material::$module::$kind;
                            $do
                        }
                    )*
                }
            };
        }
        pub(crate) use with_material;
    };
}

materials! {
    Diffuse in diffuse,
    Conductor in conductor,
    Mirror in mirror,
    Glass in glass,
    Checkerboard in checkerboard,
    Black in black,
    #[cfg(feature = "planted")]
    Phong in phong,
}

impl MaterialKind {
    /// [`Material::DECLARATION`].
    pub fn declaration(self) -> Declaration {
        of!(self, DECLARATION)
    }

    /// [`Material::WORDS`].
    pub fn words(self) -> &'static str {
        of!(self, WORDS)
    }

    /// [`Material::BRANCH`].
    pub fn branch(self) -> Option<&'static str> {
        of!(self, BRANCH)
    }

    /// [`Material::TEXTURE_OF`].
    #[inline(always)]
    pub fn texture_of(self) -> Option<Self> {
        of!(self, TEXTURE_OF)
    }

    /// [`Material::DELTA`].
    pub fn is_delta(self) -> bool {
        of!(self, DELTA)
    }

    /// [`Material::SPREAD`].
    pub fn is_spread(self) -> bool {
        of!(self, SPREAD)
    }

    /// [`Material::REFRACTS`].
    pub fn refracts(self) -> bool {
        of!(self, REFRACTS)
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
    /// Whether a material is in it.
    #[inline(always)]
    pub fn contains(self, kind: MaterialKind) -> bool {
        self.0 >> kind as u32 & 1 == 1
    }
}

impl FromIterator<MaterialKind> for MaterialKinds {
    fn from_iter<I: IntoIterator<Item = MaterialKind>>(kinds: I) -> Self {
        Self(
            kinds
                .into_iter()
                .fold(0, |all, kind| all | 1 << kind as u32),
        )
    }
}
