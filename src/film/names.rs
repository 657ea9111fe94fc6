//! The names of the standard channels.
//!
//! R, G, B and Z are OpenEXR's own (linear light, depth); a dot follows the name of a layer.

/// Components of a colour: linear, Rec. ITU-R BT.709 primaries, white D65.
pub const RGB: [&str; 3] = ["R", "G", "B"];
/// Components of a vector in world coordinates.
pub const XYZ: [&str; 3] = ["X", "Y", "Z"];
/// The layer of the picture itself, whose channels have no prefix.
pub const BEAUTY: &str = "";
/// Layer: standard error of the pixel's mean, in the unit of the channel it belongs to.
pub const STANDARD_ERROR: &str = "standard_error";
/// Layer: variance of the pixel's mean, which references keep in place of standard errors.
pub const VARIANCE: &str = "variance";
/// Layer: unit normal of the first visible surface, world coordinates.
pub const NORMAL: &str = "N";
/// Depth of the first visible surface, scene units.
pub const DEPTH: &str = "Z";
/// Camera paths that went into the pixel (whole numbers).
pub const SAMPLES: &str = "samples";
/// Index of the first visible object in the scene file's order (whole numbers).
pub const OBJECT_ID: &str = "object_id";
/// Index of its material in the scene file's order (whole numbers).
pub const MATERIAL_ID: &str = "material_id";
/// The value of [`OBJECT_ID`] and [`MATERIAL_ID`] where nothing is visible.
pub const NOTHING: u32 = u32::MAX;

/// The name of a channel: `layer.component`, or `component` alone in the unnamed layer.
pub fn in_layer(layer: &str, component: &str) -> String {
    if layer.is_empty() {
        component.to_owned()
    } else {
        format!("{layer}.{component}")
    }
}
