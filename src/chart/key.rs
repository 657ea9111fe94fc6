//! The choices that a study goes over and a chart tells apart.

/// A choice that can be an axis of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(usize)]
pub enum Key {
    /// Camera paths a pixel.
    Spp,
    /// Which points the estimator uses.
    Sampler,
    /// Arithmetic of the path loop.
    Precision,
    /// Wavelengths a path.
    Wavelengths,
    /// Longest path in segments.
    MaxDepth,
    /// Finder of implicit surfaces.
    Finder,
    /// Independent scrambles within one render.
    Scrambles,
}

impl Key {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Spp,
        Self::Sampler,
        Self::Precision,
        Self::Wavelengths,
        Self::MaxDepth,
        Self::Finder,
        Self::Scrambles,
    ];

    /// Its name on the command line and its column in a table.
    pub fn column(self) -> &'static str {
        match self {
            Self::Spp => "spp",
            Self::Sampler => "sampler",
            Self::Precision => "precision",
            Self::Wavelengths => "wavelengths",
            Self::MaxDepth => "max_depth",
            Self::Finder => "finder",
            Self::Scrambles => "scrambles",
        }
    }

    /// The key of the scene's `[image]` table it stands for.
    pub fn image_key(self) -> &'static str {
        match self {
            Self::Scrambles => "replicates",
            other => other.column(),
        }
    }

    /// Whether its values are whole numbers.
    pub fn is_number(self) -> bool {
        match self {
            Self::Spp | Self::Wavelengths | Self::MaxDepth | Self::Scrambles => true,
            Self::Sampler | Self::Precision | Self::Finder => false,
        }
    }
}
