//! Scene files as text, put together from their parts.

use glam::DVec3;

use super::harness::replicates;

/// A scene file without its sample counts.
#[derive(Debug, Clone, Default)]
pub struct Text {
    camera: String,
    pub size: [u32; 2],
    /// Further keys of the image.
    extra: String,
    materials: String,
    objects: String,
    environment: String,
}

fn v(p: DVec3) -> String {
    format!("{:?}", p.to_array())
}

/// A unit vector perpendicular to `d`.
pub fn across(d: DVec3) -> DVec3 {
    d.any_orthogonal_vector().normalize()
}

impl Text {
    fn new(from: DVec3, towards: DVec3, up: DVec3, rest: &str) -> Self {
        let [at, to, up] = [from, from + towards, up].map(v);
        Self {
            camera: format!("camera = {{ from = {at}, to = {to}, up = {up}, {rest} }}\n"),
            size: [8, 8],
            ..Self::default()
        }
    }

    /// Parallel rays in direction `towards` through a square of edge `height` about `from`.
    pub fn orthographic(from: DVec3, towards: DVec3, height: f64) -> Self {
        let up = across(towards);
        Self::new(from, towards, up, &format!("orthographic = {height:?}"))
    }

    /// The same, with the picture's upward direction.
    pub fn upright(from: DVec3, towards: DVec3, up: DVec3, height: f64) -> Self {
        Self::new(from, towards, up, &format!("orthographic = {height:?}"))
    }

    /// A pinhole.
    pub fn perspective(from: DVec3, towards: DVec3, fov: f64) -> Self {
        Self::new(from, towards, across(towards), &format!("fov = {fov:?}"))
    }

    /// A thin lens.
    pub fn lens(from: DVec3, towards: DVec3, up: DVec3, fov: f64, lens: [f64; 2]) -> Self {
        let [radius, focus] = lens;
        let rest = format!("fov = {fov:?}, lens = {{ radius = {radius:?}, focus = {focus:?} }}");
        Self::new(from, towards, up, &rest)
    }

    pub fn size(mut self, size: [u32; 2]) -> Self {
        self.size = size;
        self
    }

    /// Longest path in segments.
    pub fn depth(self, depth: u32) -> Self {
        self.image(&format!("max_depth = {depth}"))
    }

    /// A further key of the image.
    pub fn image(mut self, key: &str) -> Self {
        self.extra += &format!(", {key}");
        self
    }

    pub fn double(self) -> Self {
        self.image("precision = \"f64\"")
    }

    pub fn material(mut self, name: &str, text: &str) -> Self {
        self.materials += &format!("materials.{name} = {{ {text} }}\n");
        self
    }

    /// An object where its shape's own numbers put it.
    pub fn object(mut self, shape: &str, material: &str) -> Self {
        self.objects += &format!("[[object]]\nshape = {{ {shape} }}\nmaterial = \"{material}\"\n");
        self
    }

    /// A slab of glass or the like: a cube of these half axes.
    pub fn block(self, material: &str, columns: [DVec3; 3], at: DVec3) -> Self {
        self.placed("cube = {}", material, columns, at)
    }

    /// An object under the affine map with these columns.
    pub fn placed(self, shape: &str, material: &str, columns: [DVec3; 3], at: DVec3) -> Self {
        let mut text = self.object(shape, material);
        let [a, b, c] = columns;
        let rows = [0, 1, 2].map(|i| [a[i], b[i], c[i], at[i]]);
        text.objects += &format!("transform = [{{ matrix = {rows:?} }}]\n");
        text
    }

    pub fn sphere(self, material: &str, radius: f64, centre: DVec3) -> Self {
        let shape = format!("sphere = {{ radius = {radius:?}, center = {} }}", v(centre));
        self.object(&shape, material)
    }

    /// The parallelogram `at` ± a ± b; its front is the side of a × b.
    pub fn rectangle(self, material: &str, a: DVec3, b: DVec3, at: DVec3) -> Self {
        let normal = a.cross(b).normalize();
        self.placed("rectangle = {}", material, [a, b, normal], at)
    }

    /// A disk with its front towards `normal`.
    pub fn disk(self, material: &str, radius: f64, normal: DVec3, at: DVec3) -> Self {
        let normal = normal.normalize();
        let a = across(normal);
        let b = normal.cross(a);
        let shape = format!("disk = {{ radius = {radius:?} }}");
        self.placed(&shape, material, [a, b, normal], at)
    }

    pub fn point_light(mut self, at: DVec3, intensity: f64) -> Self {
        let at = v(at);
        self.objects += &format!("[[light]]\npoint = {at}\nintensity = {intensity:?}\n");
        self
    }

    pub fn directional(mut self, direction: DVec3, irradiance: f64) -> Self {
        let direction = v(direction);
        self.objects +=
            &format!("[[light]]\ndirection = {direction}\nirradiance = {irradiance:?}\n");
        self
    }

    pub fn environment(mut self, radiance: f64) -> Self {
        self.environment = format!("environment = {radiance:?}\n");
        self
    }

    /// The whole file.
    pub fn file(&self, spp: u32, seed: u64) -> String {
        let (size, replicates) = (self.size, replicates(spp));
        format!(
            "{}{}image = {{ size = {size:?}, spp = {spp}, seed = {seed}, replicates = {replicates}{} }}\n{}{}",
            self.environment, self.camera, self.extra, self.materials, self.objects
        )
    }
}
