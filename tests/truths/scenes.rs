//! Scene files as text, put together from their parts.

use std::fmt::Write as _;

use glam::DVec3;

use super::harness::replicates;

/// A scene file without its sample counts.
#[derive(Debug, Clone)]
pub struct Text {
    camera: String,
    pub size: [u32; 2],
    depth: Option<u32>,
    extra: String,
    materials: String,
    objects: String,
    environment: String,
}

/// A number as TOML reads it.
pub fn n(x: f64) -> String {
    format!("{x:?}")
}

fn v(p: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z)
}

/// A unit vector perpendicular to `d`.
pub fn across(d: DVec3) -> DVec3 {
    d.any_orthogonal_vector().normalize()
}

impl Text {
    fn new(from: DVec3, towards: DVec3, up: DVec3, rest: &str) -> Self {
        Self {
            camera: format!(
                "[camera]\nfrom = {}\nto = {}\nup = {}\n{rest}\n",
                v(from),
                v(from + towards),
                v(up)
            ),
            size: [8, 8],
            depth: None,
            extra: String::new(),
            materials: String::new(),
            objects: String::new(),
            environment: String::new(),
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
        let rest = format!("fov = {fov:?}\nlens = {{ radius = {radius:?}, focus = {focus:?} }}");
        Self::new(from, towards, up, &rest)
    }

    pub fn size(mut self, size: [u32; 2]) -> Self {
        self.size = size;
        self
    }

    /// Longest path in segments.
    pub fn depth(mut self, depth: u32) -> Self {
        self.depth = Some(depth);
        self
    }

    /// A further line of `[image]`.
    pub fn image(mut self, line: &str) -> Self {
        writeln!(self.extra, "{line}").unwrap();
        self
    }

    pub fn double(self) -> Self {
        self.image("precision = \"f64\"")
    }

    pub fn material(mut self, name: &str, text: &str) -> Self {
        writeln!(self.materials, "{name} = {{ {text} }}").unwrap();
        self
    }

    /// An object where its shape's own numbers put it.
    pub fn object(mut self, shape: &str, material: &str) -> Self {
        writeln!(
            self.objects,
            "[[object]]\nshape = {{ {shape} }}\nmaterial = \"{material}\""
        )
        .unwrap();
        self
    }

    /// An object under the affine map with these columns.
    pub fn placed(self, shape: &str, material: &str, columns: [DVec3; 3], at: DVec3) -> Self {
        let mut text = self.object(shape, material);
        let [a, b, c] = columns;
        let row = |i: usize| format!("[{:?}, {:?}, {:?}, {:?}]", a[i], b[i], c[i], at[i]);
        writeln!(
            text.objects,
            "transform = [{{ matrix = [{}, {}, {}] }}]",
            row(0),
            row(1),
            row(2)
        )
        .unwrap();
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
        writeln!(
            self.objects,
            "[[light]]\npoint = {}\nintensity = {intensity:?}",
            v(at)
        )
        .unwrap();
        self
    }

    pub fn directional(mut self, direction: DVec3, irradiance: f64) -> Self {
        writeln!(
            self.objects,
            "[[light]]\ndirection = {}\nirradiance = {irradiance:?}",
            v(direction)
        )
        .unwrap();
        self
    }

    pub fn environment(mut self, radiance: f64) -> Self {
        self.environment = format!("environment = {radiance:?}\n");
        self
    }

    /// The whole file.
    pub fn file(&self, spp: u32, seed: u64) -> String {
        let [width, height] = self.size;
        let depth = match self.depth {
            Some(depth) => format!("max_depth = {depth}\n"),
            None => String::new(),
        };
        let replicates = replicates(spp);
        format!(
            "{}{}[image]\nsize = [{width}, {height}]\nspp = {spp}\nseed = {seed}\n\
             replicates = {replicates}\n{depth}{}[materials]\n{}{}",
            self.environment, self.camera, self.extra, self.materials, self.objects
        )
    }
}
