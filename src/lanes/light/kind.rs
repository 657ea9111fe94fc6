//! What a light is and does, and the list of them.

use glam::{DMat3, DVec3};

use super::Towards;
use crate::declare::{Declaration, Value};
use crate::math::affine::Affine;
use crate::math::lanes::{Lanes, Scalar};
use crate::math::vec3::Vec3;
use crate::shape::Emitter;
use crate::spectrum::Spectrum;

/// A placed shape that emits.
pub struct Emitting<'a> {
    pub form: Emitter,
    /// Canonical coordinates → world about the camera, and the inverse.
    pub to_world: &'a Affine,
    pub inverse: &'a Affine,
    /// Whether its front and its back emit.
    pub emits: [bool; 2],
}

impl Emitting<'_> {
    /// The linear part of the map to the world.
    pub fn linear(&self) -> DMat3 {
        let [a, b, c] = self.to_world.columns();
        DMat3::from_cols(a, b, c)
    }

    /// Unit normal of the canonical faces across an axis.
    pub fn normal(&self, axis: usize) -> DVec3 {
        DVec3::from_slice(&self.inverse.rows[axis][..3]).normalize()
    }
}

/// A light that can be sampled from a point.
pub trait Light<T: Scalar>: Sized {
    /// What `info` calls a light that is no object.
    const NAME: &'static str = "surface";
    /// How it is sampled, in the words of `info`.
    const STRATEGY: &'static str;
    /// Whether it cannot light itself, whatever rounding makes of a point on it: by a hair behind
    /// the plane, a rectangle would fill half of all directions.
    const FLAT: bool = false;

    /// The light that a shape makes, and its area; `None` for shapes of other lights.
    fn of_shape(_shape: &Emitting<'_>) -> Option<(Self, f64)> {
        None
    }

    /// A direction from points p, by two numbers in [0, 1).
    fn sample<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>, u: [L::Real; 2]) -> Towards<L>;

    /// Density in solid angle with which [`Self::sample`] from p would have chosen the unit
    /// direction `direction`, which meets the light where its normal is `normal`; 0 where scattered
    /// rays never meet it.
    ///
    /// It is a function of p and the direction alone, the same for both sampling strategies, bit
    /// for bit: the weights of a direction then sum to 1 however grazing it is. (The hit's own
    /// distance and normal would be as good, but rounded otherwise, and 1/cos enlarges that.) The
    /// normal only tells the faces of a cube or cylinder apart.
    #[inline(always)]
    fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        _p: Vec3<L::Real>,
        _direction: Vec3<L::Real>,
        _normal: Vec3<L::Real>,
    ) -> L::Real {
        l.real(0.0)
    }
}

/// A light without a surface, which scattered rays never meet.
pub trait WithoutSurface<T: Scalar>: Light<T> {
    /// Its keys in scene files: the main one is a point or a direction, the one beside it a spectrum.
    const DECLARATION: Declaration;

    /// About how much power it sends into the scene, over the strength of its spectrum; the argument
    /// is about the area, over π, that parallel light falls on.
    const POWER: fn(f64) -> f64;

    /// From its position about the camera, or the direction towards it.
    fn new(place: DVec3) -> Self;
}

macro_rules! lights {
    (
        surfaces { $($surface:ident($surface_type:ident) in $surface_module:ident,)* }
        without { $($source:ident($source_type:ident) in $source_module:ident,)* }
    ) => {
        /// The lights that can be sampled.
        #[derive(Debug, Clone)]
        pub enum LightShape<T> {
            $($surface(super::$surface_module::$surface_type<T>),)*
            $($source(super::$source_module::$source_type<T>),)*
        }

        /// The lights without a surface.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum SourceKind {
            $($source,)*
        }

        impl SourceKind {
            /// All of them, in the order in which messages list them.
            pub const ALL: &'static [Self] = &[$(Self::$source,)*];
        }

        impl<T: Scalar> LightShape<T> {
            /// The light that a placed shape makes, and its area; `None` where only scattered rays
            /// find it.
            pub fn of_shape(shape: &Emitting<'_>) -> Option<(Self, f64)> {
                $(
                    if let Some((light, area)) = Light::of_shape(shape) {
                        return Some((Self::$surface(light), area));
                    }
                )*
                None
            }

            /// A light without a surface, about the camera's position `camera`.
            pub fn of_source(source: &Source, camera: DVec3) -> Option<Self> {
                let place = match source.place(camera)? {
                    Place::At(place) | Place::Towards(place) => place,
                };
                Some(match source.kind {
                    $(SourceKind::$source => Self::$source(WithoutSurface::new(place)),)*
                })
            }

            /// Whether scattered rays can hit the light, so that the two strategies are to be
            /// weighted.
            pub fn has_extent(&self) -> bool {
                !matches!(self, $(Self::$source(_))|*)
            }
        }

        /// Evaluates an expression about a light, or a constant of its type.
        macro_rules! of {
            ($light:expr, $own:ident => $do:expr) => {
                match $light {
                    $(Self::$surface($own) => $do,)*
                    $(Self::$source($own) => $do,)*
                }
            };
            ($light:expr, $constant:ident) => {
                match $light {
                    $(Self::$surface(_) => super::$surface_module::$surface_type::<T>::$constant,)*
                    $(Self::$source(_) => super::$source_module::$source_type::<T>::$constant,)*
                }
            };
        }

        /// Evaluates an item of the type of a light without a surface.
        macro_rules! of_source {
            ($kind:expr, $item:ident) => {
                match $kind {
                    $(Self::$source => super::$source_module::$source_type::<f64>::$item,)*
                }
            };
        }
    };
}

// The first that can be made of a shape is made of it.
lights! {
    surfaces {
        Rectangle(RectangleLight) in rectangle,
        Planar(PlanarLight) in planar,
        Sphere(SphereLight) in sphere,
        Cube(CubeLight) in cube,
        Cylinder(CylinderLight) in cylinder,
        Mapped(MappedLight) in mapped,
    }
    without {
        Point(PointLight) in point,
        Directional(DirectionalLight) in directional,
    }
}

impl<T: Scalar> LightShape<T> {
    /// [`Light::NAME`].
    pub fn name(&self) -> &'static str {
        of!(self, NAME)
    }

    /// [`Light::STRATEGY`].
    pub fn strategy(&self) -> &'static str {
        of!(self, STRATEGY)
    }

    /// [`Light::FLAT`].
    pub fn is_flat(&self) -> bool {
        of!(self, FLAT)
    }

    /// [`Light::sample`].
    #[inline(always)]
    pub fn sample<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        u: [L::Real; 2],
    ) -> Towards<L> {
        of!(self, light => light.sample(l, p, u))
    }

    /// [`Light::pdf`].
    #[inline(always)]
    pub fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        normal: Vec3<L::Real>,
    ) -> L::Real {
        of!(self, light => light.pdf(l, p, direction, normal))
    }
}

impl SourceKind {
    /// [`Light::NAME`].
    pub fn name(self) -> &'static str {
        of_source!(self, NAME)
    }

    /// [`WithoutSurface::DECLARATION`].
    pub fn declaration(self) -> Declaration {
        of_source!(self, DECLARATION)
    }

    /// [`WithoutSurface::POWER`].
    pub fn power(self, area: f64) -> f64 {
        of_source!(self, POWER)(area)
    }
}

/// A light without a surface: its kind, and its parameters in the order of its [`Declaration`].
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    pub kind: SourceKind,
    pub values: Vec<Value>,
}

/// Where a light without a surface is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// At a point.
    At(DVec3),
    /// At infinity, in this direction (unit).
    Towards(DVec3),
}

impl Source {
    /// Where it is about the point `camera`; the direction of its declaration is the light's own.
    pub fn place(&self, camera: DVec3) -> Option<Place> {
        self.values.iter().find_map(|value| match value {
            Value::Point(at) => Some(Place::At(*at - camera)),
            Value::Direction(direction) => Some(Place::Towards(-*direction)),
            Value::Number(_) | Value::Spectrum(_) | Value::Index(_) => None,
        })
    }

    /// What it sends: radiant intensity, W·sr⁻¹·nm⁻¹, or irradiance, W·m⁻²·nm⁻¹.
    pub fn spectrum(&self) -> Option<&Spectrum> {
        self.values.iter().find_map(Value::spectrum)
    }
}
